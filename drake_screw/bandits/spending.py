"""How the chance of error is shared out over the rounds of a run, and over the looks of a round."""

from __future__ import annotations

from drake_screw.bandits.verdict import BanditError
from drake_screw.typing import Array


def attempt_delta(delta: float, attempt: int, *, spend: bool) -> float:
    """The chance of a false certificate allowed in one attempt.

    Spending gives attempt k the share delta / (k (k + 1)); the shares of all attempts sum to delta,
    so that the whole run certifies falsely with probability at most delta. Not spending gives every
    attempt all of delta: the guarantee then holds for one round, not for the run.

    Raises:
        BanditError: attempts are counted from 1.

    >>> [round(attempt_delta(0.05, k, spend=True), 6) for k in (1, 2, 3)]
    [0.025, 0.008333, 0.004167]
    """
    if attempt < 1:
        raise BanditError(f"attempt {attempt}", remedy="Attempts are counted from 1.")
    return delta / (attempt * (attempt + 1)) if spend else delta


def look_delta(delta: float, look: int | Array) -> float | Array:
    """The share delta 2^-look of look 1, 2, ... within a round; all shares sum to delta."""
    return delta * 0.5**look
