"""The paper's Algorithm 2: sample every region equally often, then compare the estimates."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from drake_screw.bandits.conclusion import certificate
from drake_screw.bandits.spending import attempt_delta
from drake_screw.bandits.tally import Tally
from drake_screw.bandits.verdict import Goal, Pull, Verdict
from drake_screw.errors import confidence

PARTS = 8  # A round is drawn in so many parts, so that its progress can be shown.


def sample_size(K: int, epsilon: float, delta: float) -> int:
    """Samples per region that put all K estimates within epsilon / 2 with probability 1 - delta.

    ceil((2 / epsilon^2) ln(2 K / delta)): Hoeffding's inequality and a union over K regions and two
    sides, as in the naive algorithm of Even-Dar, Mannor and Mansour (COLT 2002).

    >>> sample_size(16, epsilon=0.02, delta=0.05)
    32308
    """
    return math.ceil(2.0 / epsilon**2 * math.log(2.0 * K / delta))


def most_failures(n: int, goal: Goal) -> int:
    """The largest number of failures among n with estimate <= 1 - epsilon - beta.

    Decided on integers: in floating point 1 - 0.02 - 0.95 is not 0.03.

    >>> most_failures(1000, Goal(beta=0.95, epsilon=0.02, delta=0.05))
    30
    """
    return math.floor(n * goal.q + 1e-9)


@dataclass(frozen=True)
class NaivePac:
    """Equal sampling with Hoeffding's bound (Das et al., arXiv 2410.18275, Algorithms 1 and 2).

    Every region gets `sample_size` samples; the weakest is the one with the largest estimate (the
    first of them on a tie); the round certifies if that estimate is at most 1 - epsilon - beta.

    Args:
        goal: what to certify.
        spend: share delta out over the attempts of a run. False is the paper's reading: every round
            by itself holds with probability 1 - delta, a run of several rounds holds with less.
    """

    name: ClassVar[str] = "naive_pac"
    guarantee: ClassVar[str] = (
        "With probability 1 - delta in each round (in the whole run if delta is spent) every "
        "estimate is within epsilon/2, the region named is epsilon-worst and a certificate is true."
    )

    goal: Goal
    spend: bool = False

    def total(self, K: int, *, attempt: int) -> int:
        """How many samples a round takes, of all regions together."""
        delta = attempt_delta(self.goal.delta, attempt, spend=self.spend)
        return K * sample_size(K, self.goal.epsilon, delta)

    def decide(self, pull: Pull, K: int, *, attempt: int) -> Verdict:
        """Runs one round; see `Strategy.decide`."""
        goal = self.goal
        delta = attempt_delta(goal.delta, attempt, spend=self.spend)
        tally = Tally(pull, K)
        n = sample_size(K, goal.epsilon, delta)
        for part in np.diff(np.arange(PARTS + 1) * n // PARTS):
            tally.draw(part)
        region = int(np.argmax(tally.s))
        certified = bool(tally.s[region] <= most_failures(n, goal))
        half = goal.epsilon / 2.0
        worst = tally.estimates[region]
        comparison = "<=" if certified else ">"
        ask = (
            f"no region fails more often than this one by over {goal.epsilon:g} "
            f"(confidence {confidence(1.0 - delta)} for this round)"
        )
        return Verdict(
            certified=certified,
            region=region,
            reason=f"largest estimate {worst:.4f} {comparison} 1 - epsilon - beta = {goal.q:.4g}",
            claim=certificate(goal, spend=self.spend) if certified else ask,
            samples=tally.n,
            failures=tally.s,
            lower=np.maximum(tally.estimates - half, 0.0),
            upper=np.minimum(tally.estimates + half, 1.0),
            level=1.0 - delta,
            simultaneous=True,
            gap=goal.epsilon,
            coverage=max(0.0, 1.0 - goal.epsilon - float(worst)),
            attempted=True,
            looks=1,
        )
