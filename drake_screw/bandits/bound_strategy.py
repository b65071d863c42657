"""The round shared by strategies that differ only in which regions they sample next."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from drake_screw.bandits.conclusion import conclude, worst_gap
from drake_screw.bandits.mixture import confidence_interval, coverage_bound
from drake_screw.bandits.spending import attempt_delta
from drake_screw.bandits.tally import FIRST, STEP, Tally
from drake_screw.bandits.verdict import Goal, Pull, Verdict
from drake_screw.typing import Array


@lru_cache(maxsize=1024)
def least_passing(tau: float, c: float) -> int:
    """The least n whose upper bound is at most tau, without any failure."""
    n = 1
    while confidence_interval(n, 0, c)[1] > tau:
        n += 1
    return n


@dataclass(frozen=True)
class BoundStrategy(ABC):
    """Rounds on confidence bounds that hold for all regions and at all looks at once.

    The bounds are the mixture confidence intervals at ln(K / delta), each the best so far. The
    round certifies once every upper bound is at most 1 - beta, and asks for the region a with the
    largest estimate once its lower bound is over 1 - beta - epsilon and no other region's upper
    bound is over that lower bound by more than epsilon.

    Args:
        goal: what to certify.
        spend: share delta out over the attempts of a run.
    """

    goal: Goal
    spend: bool = True

    @abstractmethod
    def choose(self, tally: Tally, lower: Array, upper: Array) -> Array:
        """The regions to sample next, as an index or mask array, given bounds (K,)."""

    def decide(self, pull: Pull, K: int, *, attempt: int) -> Verdict:
        """Runs one round; see `Strategy.decide`."""
        goal = self.goal
        delta = attempt_delta(goal.delta, attempt, spend=self.spend)
        tally = Tally(pull, K)
        c = float(np.log(K / delta))
        tally.draw(FIRST)
        lower, upper = confidence_interval(tally.n, tally.s, c)
        while True:
            region = int(np.argmax(tally.estimates))
            certified = bool(upper.max() <= goal.tau)
            if certified:
                reason = "all upper bounds at most 1 - beta"
                break
            gap = worst_gap(lower, upper, region)
            if lower[region] > goal.q and gap <= goal.epsilon:
                reason = "an epsilon-worst region found"
                break
            chosen = self.choose(tally, lower, upper)
            tally.draw_from(chosen, STEP)
            low, up = confidence_interval(tally.n[chosen], tally.s[chosen], c)
            lower[chosen] = np.maximum(lower[chosen], low)
            upper[chosen] = np.minimum(upper[chosen], up)
        return conclude(
            tally,
            goal,
            certified=certified,
            region=region,
            reason=reason,
            lower=lower,
            upper=upper,
            level=1.0 - delta,
            coverage=coverage_bound(tally.n, tally.s, delta),
            attempted=bool(tally.n.max() >= least_passing(goal.tau, c)),
            spend=self.spend,
        )
