"""Which of several arms a recording is of: the one whose joints it names, and that moves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drake_screw.errors import RecordingError
from drake_screw.typing import Array

MOVES = 0.05
"""rad or m, that some joint moves of an arm that shows something, at least."""


def travel(q: Array) -> float:
    """How far the joint that moves most moves along q (m, n), rad or m; 0 without joints."""
    return float(np.ptp(q, axis=0).max()) if q.size else 0.0


def moving_arm(travels: Sequence[float | RecordingError], names: Sequence[str]) -> int:
    """The arm that a recording is of.

    Args:
        travels: of each arm `travel`, or why the recording cannot be one of it.
        names: of the arms.

    Returns:
        The one that moves most, of several alike the first.

    Raises:
        RecordingError: it can be of none; or of none but one that hardly moves, while something is
            wrong with another.
    """
    possible = {i: t for i, t in enumerate(travels) if not isinstance(t, RecordingError)}
    best = max(possible, key=possible.__getitem__, default=None)
    errors = [t for t in travels if isinstance(t, RecordingError)]
    if best is None:
        others = " and ".join(f"'{name}'" for name in names[1:])
        remedy = f"{errors[0].remedy or ''} Joints of arm {others} will do, too.".strip()
        error = errors[0]
        raise RecordingError(error.message, remedy=remedy, file=error.file, line=error.line)
    if errors and 0.0 < possible[best] < MOVES:
        raise errors[0]
    return best


def said_of_choice(travels: Sequence[float | RecordingError], names: Sequence[str]) -> str | None:
    """What is to be said of the choice of `moving_arm`; None where there was none."""
    possible = [t for t in travels if not isinstance(t, RecordingError)]
    if len(possible) < 2 or max(possible) == 0.0:
        return None
    chosen = names[moving_arm(travels, names)]
    return f"joints of several arms are recorded; it is taken to be of '{chosen}', which moves most"
