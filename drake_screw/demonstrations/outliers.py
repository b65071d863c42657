"""Samples that cannot be true: an arm does not move that fast."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from drake_screw.errors import RecordingError
from drake_screw.typing import Array

FACTOR = 2.0
"""On the model's velocity limits; an arm that is led by hand may exceed them."""
NOISE = 0.05
"""rad or m between two samples, that encoders and unsteady stamps may add."""
SHARE = 500
"""At most one sample in as many may be dropped (and one in any case)."""


def plausible(
    t: Array,
    q: Array,
    velocity_limits: Array,
    names: Sequence[str],
    units: Sequence[str],
    fail: Callable[[int, str, str], RecordingError],
    lines: NDArray[np.int64],
) -> tuple[NDArray[np.bool_], str | None]:
    """Which samples to keep: all but single ones at which the arm cannot have been.

    Such a one is reached, and left again, faster than a joint can move, while the samples around it
    agree with each other; at either end it is enough to be too far from its neighbour.

    Args:
        t: (m,) s, increasing.
        q: (m, n) rad or m, finite.
        velocity_limits: (n,) rad/s or m/s.
        names, units: of the n joints.
        fail: makes the error for a row.
        lines: (m,) line of each sample.

    Returns:
        (m,) bool, and what was dropped, in words; None if nothing.

    Raises:
        RecordingError: a joint is too fast otherwise.
    """
    keep = np.ones(len(t), dtype=bool)
    usual = float(np.median(np.diff(t))) if len(t) > 1 else 0.0

    def too_fast(a: int, b: int) -> bool:
        reach = FACTOR * velocity_limits * max(t[b] - t[a], usual) + NOISE
        return bool((np.abs(q[b] - q[a]) > reach).any())

    steps = np.maximum(np.diff(t), usual)
    fast = np.zeros(len(steps), dtype=bool)
    for j, limit in enumerate(velocity_limits.tolist()):  # one at a time, for long recordings
        fast |= np.abs(np.diff(q[:, j])) > FACTOR * limit * steps + NOISE
    m, most = len(t), max(len(t) // SHARE, 1)
    for i in np.flatnonzero(fast).tolist():
        if not (keep[i] and keep[i + 1]):
            continue
        first, last = i == 0, i + 2 == m
        if first and m > 2 and not fast[1]:
            keep[0] = False
        elif last or (fast[i + 1] and not too_fast(i, i + 2)):
            keep[i + 1] = False
        else:
            raise _too_fast(i, t, q, velocity_limits, names, units, fail)
        if np.count_nonzero(~keep) > most:
            raise _too_fast(i, t, q, velocity_limits, names, units, fail)
    dropped = np.flatnonzero(~keep)
    if not len(dropped):
        return keep, None
    where = ", ".join(str(lines[i]) for i in dropped.tolist())
    j = _worst(q, int(dropped[0]), velocity_limits)
    one = len(dropped) == 1
    return keep, (
        f"dropped {len(dropped)} sample{'' if one else 's'} that cannot be true, "
        f"line{'' if one else 's'} {where}: {names[j]} would jump to {q[dropped[0], j]:.3g} "
        f"{units[j]} and back"
    )


def _worst(q: Array, i: int, limits: Array) -> int:
    step = i - 1 if i else 0
    return int(np.argmax(np.abs(q[step + 1] - q[step]) / limits))


def _too_fast(
    i: int,
    t: Array,
    q: Array,
    limits: Array,
    names: Sequence[str],
    units: Sequence[str],
    fail: Callable[[int, str, str], RecordingError],
) -> RecordingError:
    change = q[i + 1] - q[i]
    j = int(np.argmax(np.abs(change) / limits))
    return fail(
        i + 1,
        f"{names[j]} moves by {abs(change[j]):.2f} {units[j]} in {t[i + 1] - t[i]:.4f} s, and its "
        f"limit is {limits[j]:.3g} {units[j]}/s",
        "Check the unit of time and of the angles; delete rows that cannot be true, or record "
        "again.",
    )
