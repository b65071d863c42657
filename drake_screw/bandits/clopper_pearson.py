"""Exact binomial tests at a few looks, each with its share of the chance of error."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy
from numpy.typing import ArrayLike

from drake_screw.bandits.conclusion import conclude
from drake_screw.bandits.spending import attempt_delta, look_delta
from drake_screw.bandits.tally import FIRST, Tally
from drake_screw.bandits.verdict import Goal, Pull, Verdict
from drake_screw.typing import Array


def at_most(n: Array, s: Array, p: float) -> Array:
    """P(Binomial(n, p) <= s)."""
    return np.where(s >= n, 1.0, scipy.special.betaincc(s + 1.0, np.maximum(n - s, 0.5), p))


def at_least(n: Array, s: Array, p: float) -> Array:
    """P(Binomial(n, p) >= s)."""
    return np.where(s <= 0, 1.0, scipy.special.betainc(np.maximum(s, 0.5), n - s + 1.0, p))


def upper_bound(n: Array, s: Array, alpha: ArrayLike) -> Array:
    """The p with P(Binomial(n, p) <= s) = alpha (Clopper and Pearson, Biometrika 1934)."""
    return np.where(s >= n, 1.0, scipy.special.betainccinv(s + 1.0, np.maximum(n - s, 0.5), alpha))


def lower_bound(n: Array, s: Array, alpha: ArrayLike) -> Array:
    """The p with P(Binomial(n, p) >= s) = alpha."""
    return np.where(s <= 0, 0.0, scipy.special.betaincinv(np.maximum(s, 0.5), n - s + 1.0, alpha))


@dataclass(frozen=True)
class ClopperPearson:
    """Group sequential exact tests with geometric spending.

    Look i may err with the share 2^-i of delta. The first look is at 16 samples a region, the
    second at the least number at which a region without failures is cleared, and every further one
    at twice the samples of the one before, in the regions not yet cleared. A region is cleared when
    so few failures have, at 1 - beta, at most the probability delta 2^-i; it is flagged when so
    many have, at 1 - beta - epsilon, at most the probability delta 2^-i / K. Of flagged regions the
    one with the largest estimate is named. Needs no special theory, but more samples than
    `eprocess`, whose looks cost nothing.

    Args:
        goal: what to certify.
        spend: share delta out over the attempts of a run.
    """

    name: ClassVar[str] = "clopper_pearson"
    guarantee: ClassVar[str] = (
        "A certificate is false with probability at most delta in the whole run (in each round if "
        "delta is not spent); a round flags a region although none fails over 1 - beta - epsilon "
        "of the time with probability at most delta."
    )

    goal: Goal
    spend: bool = True

    def decide(self, pull: Pull, K: int, *, attempt: int) -> Verdict:
        """Runs one round; see `Strategy.decide`."""
        goal = self.goal
        delta = attempt_delta(goal.delta, attempt, spend=self.spend)
        tally = Tally(pull, K)
        cleared = np.zeros(K, dtype=bool)
        look = np.zeros(K, dtype=np.int64)
        target = FIRST
        passing = math.ceil(math.log(look_delta(delta, 2)) / math.log1p(-goal.tau))
        while True:
            tally.draw(np.where(cleared, 0, target - tally.n))
            look[~cleared] = tally.looks
            cleared |= at_most(tally.n, tally.s, goal.tau) <= look_delta(delta, look)
            flag_level = look_delta(goal.delta, look) / K
            flagged = ~cleared & (at_least(tally.n, tally.s, goal.q) <= flag_level)
            if cleared.all():
                region, reason = int(np.argmax(tally.estimates)), "all regions cleared"
                break
            if flagged.any():
                region = int(np.argmax(np.where(flagged, tally.estimates, -1.0)))
                reason = "region flagged"
                break
            target = max(passing, 2 * target) if tally.looks > 1 else max(passing, FIRST + 1)
        side = look_delta(goal.delta, look) / (2 * K)
        upper = upper_bound(tally.n, tally.s, look_delta(delta, look))
        return conclude(
            tally,
            goal,
            certified=bool(cleared.all()),
            region=region,
            reason=reason,
            lower=lower_bound(tally.n, tally.s, side),
            upper=upper_bound(tally.n, tally.s, side),
            level=1.0 - goal.delta,
            coverage=1.0 - float(upper.max()),
            attempted=bool(
                (at_most(tally.n, np.zeros(K), goal.tau) <= look_delta(delta, look)).any()
            ),
            spend=self.spend,
        )
