"""Which of several arms a recording is of: the one whose joints it names, and that moves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drake_screw.demonstrations.recording import ArmAtRest
from drake_screw.errors import RecordingError
from drake_screw.typing import Array

MOVES = 0.05
"""rad or m, that some joint moves of an arm that shows something, at least."""


Tried = float | RecordingError
"""How far an arm moves, or why a recording cannot be one of it."""


def travel(q: Array) -> float:
    """How far the joint that moves most moves along q (m, n), rad or m; 0 without joints."""
    return float(np.ptp(q, axis=0).max()) if q.size else 0.0


def moving_arm(tried: Sequence[Tried], names: Sequence[str]) -> int:
    """The arm that a recording is of.

    Args:
        tried: for each arm its `travel`, or why the recording cannot be one of it.
        names: of the arms.

    Returns:
        The one that moves most, of several alike the first.

    Raises:
        RecordingError: it can be of none; or of none but one that hardly moves, while something is
            wrong with another.
    """
    moving = {i: t for i, t in enumerate(tried) if isinstance(t, float)}
    wrong = [t for t in tried if isinstance(t, RecordingError) and not isinstance(t, ArmAtRest)]
    best = max(moving, key=moving.__getitem__, default=None)
    if best is not None and not (wrong and 0.0 < moving[best] < MOVES):
        return best
    still = [t for t in tried if isinstance(t, ArmAtRest)]
    inside = [error for error in wrong if error.line not in (None, 1)]
    error = (inside or still or wrong)[0]
    others = " or ".join(f"'{name}'" for name in names)
    remedy = f"{error.remedy or ''} The joints of one arm are needed, {others}.".strip()
    raise RecordingError(error.message, remedy=remedy, file=error.file, line=error.line)


def said_of_choice(tried: Sequence[Tried], names: Sequence[str]) -> str | None:
    """What is to be said of the choice of `moving_arm`; None where there was none."""
    there = [t for t in tried if isinstance(t, float | ArmAtRest)]
    if len(there) < 2 or not any(t for t in there if isinstance(t, float)):
        return None
    chosen = names[moving_arm(tried, names)]
    return f"joints of several arms are recorded; it is taken to be of '{chosen}', which moves most"
