"""Angles that are a whole turn off: from some sample on, or all along."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from drake_screw.screws.endless import TURN, is_endless
from drake_screw.typing import Array

MOST = 2
"""Turns that angles may be off."""
NEAR = 0.5
"""rad. A step that is as near to whole turns is one by whole turns."""


def whole_turns(
    q: Array, lower: Array, upper: Array, units: Sequence[str], slack: float
) -> NDArray[np.int8]:
    """By how many turns (m, n) the angles of limited joints are off; 0 where they are not.

    A joint's angles are counted on where they jump by whole turns, and then moved by those that
    bring all of them within the limits. Where that cannot be, nothing is said of the joint.

    Args:
        q: (m, n) rad or m, finite.
        lower, upper: (n,) limits.
        units: n of "rad" or "m".
        slack: rad, that a limit may be exceeded by.
    """
    turns = np.zeros(q.shape, dtype=np.int8)
    for j in np.flatnonzero(~is_endless(lower, upper)).tolist():
        low, high = lower[j] - slack, upper[j] + slack
        if units[j] != "rad" or ((q[:, j] >= low) & (q[:, j] <= high)).all():
            continue
        steps = np.diff(q[:, j])
        jumps = np.round(steps / TURN)
        jumps[np.abs(steps - jumps * TURN) > NEAR] = 0.0
        off = np.append(0.0, np.cumsum(jumps))
        smooth = q[:, j] - off * TURN
        fitting = [
            off + k
            for k in range(-2 * MOST, 2 * MOST + 1)
            if (smooth - k * TURN >= low).all() and (smooth - k * TURN <= high).all()
        ]
        fitting = [each for each in fitting if np.abs(each).max() <= MOST]
        if fitting:
            turns[:, j] = min(fitting, key=lambda each: np.count_nonzero(each))
    return turns


def turns_in_words(turns: NDArray[np.int8], names: Sequence[str], first: NDArray[np.int64]) -> str:
    """What was done about angles a whole turn off.

    Args:
        turns: (m, n), some not 0.
        names: n joints.
        first: (m,) line of each sample.
    """
    said = []
    for j in np.flatnonzero(turns.any(axis=0)).tolist():
        rows = np.flatnonzero(turns[:, j])
        where = "" if len(rows) == len(turns) else f" in {len(rows)} of {len(turns)} samples"
        since = (
            f", from line {first[int(rows[0])]} on" if where and rows[-1] + 1 == len(turns) else ""
        )
        count = int(np.abs(turns[:, j]).max())
        said.append(f"{names[j]} by {count} whole turn{'s' if count > 1 else ''}{where}{since}")
    return f"shifted {', '.join(said)}"
