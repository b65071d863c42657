"""Each region is tested on both sides by e-processes, and sampled only while undecided."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from drake_screw.bandits.conclusion import conclude
from drake_screw.bandits.decision_boundary import clear_boundary, deciding_size
from drake_screw.bandits.mixture import confidence_interval, coverage_bound, ln_e_flag
from drake_screw.bandits.spending import attempt_delta
from drake_screw.bandits.tally import FIRST, STEP, Tally
from drake_screw.bandits.verdict import BanditError, Goal, Pull, Verdict
from drake_screw.typing import Array


@dataclass(frozen=True)
class EProcess:
    """Truncated Jeffreys mixtures (see `mixture`), with sample sizes chosen on the way.

    A region is cleared when its evidence against "fails 1 - beta or more" reaches 1/delta, and
    flagged when, before that, its evidence against "fails 1 - beta - epsilon or less" reaches
    K/delta. A certificate needs every region cleared, so it is false only if the test of one
    particular region errs, and delta is not divided by K there (the intersection-union test of
    Berger, Technometrics 1982); to ask falsely, any of K tests may err. An uncleared region without
    failures is sampled up to where it would clear; one with failures at most doubles. Once a region
    is flagged, the flagged region with the largest estimate is compared with its strongest rival.

    Args:
        goal: what to certify.
        spend: share delta out over the attempts of a run.
        rank_budget: samples to spend on comparing a flagged region with others, None for as many as
            show the region named to be epsilon-worst.
        cap: samples per region after which a round ends undecided; None for the number at which
            every region is cleared or flagged.
    """

    name: ClassVar[str] = "eprocess"
    guarantee: ClassVar[str] = (
        "A certificate is false with probability at most delta in the whole run (in each round if "
        "delta is not spent), however often one looks; a round flags a region although none fails "
        "over 1 - beta - epsilon of the time with probability at most delta."
    )

    goal: Goal
    spend: bool = True
    rank_budget: int | None = 4096
    cap: int | None = None

    def __post_init__(self) -> None:
        if self.cap is not None and self.cap < 1:
            raise BanditError(f"cap is {self.cap}", remedy="Give a cap of at least 1, or none.")
        if self.rank_budget is not None and self.rank_budget < 0:
            raise BanditError(
                f"rank_budget is {self.rank_budget}", remedy="Give 0 or more, or none."
            )

    def decide(self, pull: Pull, K: int, *, attempt: int) -> Verdict:
        """Runs one round; see `Strategy.decide`."""
        goal = self.goal
        delta = attempt_delta(goal.delta, attempt, spend=self.spend)
        tally = Tally(pull, K)
        c_clear, c_flag = float(np.log(1.0 / delta)), float(np.log(K / goal.delta))
        least = clear_boundary(goal.tau, c_clear)
        cap = self.cap or deciding_size(goal.tau, c_clear, goal.q, c_flag)
        tally.draw(min(FIRST, cap))
        attempted = False
        while True:
            cleared = tally.n >= least(tally.s)
            attempted |= bool((tally.n >= least(0)).any())
            flagged = ~cleared & (ln_e_flag(tally.n, tally.s, goal.q) >= c_flag)
            if cleared.all():
                region, reason = int(np.argmax(tally.estimates)), "all regions cleared"
                break
            if flagged.any():
                region, reason = self._rank(tally, flagged, c_flag), "region flagged"
                break
            if (tally.n[~cleared] >= cap).any():
                region = int(np.argmax(np.where(cleared, -1.0, tally.estimates)))
                reason = f"cap of {cap} samples a region reached: undecided"
                break
            more = least(tally.s) - tally.n
            more = np.where(tally.s > 0, np.maximum(FIRST, np.minimum(more, tally.n)), more)
            tally.draw(np.where(cleared, 0, np.minimum(more, cap - tally.n)))
        lower, upper = confidence_interval(tally.n, tally.s, c_flag)
        return conclude(
            tally,
            goal,
            certified=bool(cleared.all()),
            region=region,
            reason=reason,
            lower=lower,
            upper=upper,
            level=1.0 - goal.delta,
            coverage=coverage_bound(tally.n, tally.s, delta),
            attempted=attempted,
            spend=self.spend,
        )

    def _rank(self, tally: Tally, flagged: Array, c: float) -> int:
        """The flagged region to ask about, after sampling it against its strongest rivals."""
        lower, upper = confidence_interval(tally.n, tally.s, c)
        spent = 0
        while True:
            region = int(np.argmax(np.where(flagged, tally.estimates, -1.0)))
            others = upper.copy()
            others[region] = -1.0
            rival = int(np.argmax(others))
            enough = self.rank_budget is not None and spent >= self.rank_budget
            if others[rival] <= lower[region] + self.goal.epsilon or enough:
                return region
            pair = np.array([region, rival])
            tally.draw_from(pair, STEP)
            spent += 2 * STEP
            n, s = tally.n[pair], tally.s[pair]
            lower[pair], upper[pair] = confidence_interval(n, s, c)
            flagged[pair] |= ln_e_flag(n, s, self.goal.q) >= c
