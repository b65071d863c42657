"""From the counts of a round to its verdict, in words and numbers."""

from __future__ import annotations

import numpy as np

from drake_screw.bandits.tally import Tally
from drake_screw.bandits.verdict import Goal, Verdict
from drake_screw.errors import confidence
from drake_screw.typing import Array


def certificate(goal: Goal, *, spend: bool) -> str:
    """What a certificate states."""
    scope = "the whole run" if spend else "this round"
    return (
        f"every region succeeds at least {confidence(goal.beta)} of the time "
        f"(confidence {confidence(1.0 - goal.delta)} for {scope})"
    )


def worst_gap(lower: Array, upper: Array, region: int) -> float:
    """Bound on max_j mu_j - mu_region, given bounds (K,) that hold at once; 0 or more."""
    return max(0.0, float(np.delete(upper, region).max(initial=0.0) - lower[region]))


def conclude(
    tally: Tally,
    goal: Goal,
    *,
    certified: bool,
    region: int,
    reason: str,
    lower: Array,
    upper: Array,
    level: float,
    coverage: float,
    attempted: bool,
    spend: bool,
) -> Verdict:
    """The verdict of a round whose bounds hold for all regions at once.

    The gap follows from the bounds; every argument not named here is a field of `Verdict`.

    Args:
        tally: the counts of the round.
        goal: what was to be certified.
        spend: whether delta is shared out over the attempts of a run.
    """
    gap = worst_gap(lower, upper, region)
    others = "no other fails more often" + (f" by over {gap:.4f}" if gap > 0.0 else "")
    ask = (
        f"this region fails at least {lower[region]:.4f} of the time, and {others} "
        f"(confidence {confidence(level)} for this round)"
    )
    return Verdict(
        certified=certified,
        region=region,
        reason=reason,
        claim=certificate(goal, spend=spend) if certified else ask,
        samples=tally.n,
        failures=tally.s,
        lower=lower,
        upper=upper,
        level=level,
        simultaneous=True,
        gap=None if certified else gap,
        coverage=coverage,
        attempted=attempted,
        looks=tally.looks,
    )
