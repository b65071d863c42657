"""One round: draw task instances, plan them, and let a strategy decide what the failures show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.acquisition.events import Evaluation, InstancesExecuted, RegionsEvaluated
from drake_screw.acquisition.tries import Executed, Executing, Try, begin_tries, joined
from drake_screw.bandits import OfFixedSize, Strategy, Verdict
from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Outcomes, Planner, concatenate
from drake_screw.tasks import GridRegions, chance, draw_in_all
from drake_screw.typing import Array

BATCH = 16_384

Progress = Callable[[RegionsEvaluated | InstancesExecuted], None]


@dataclass(frozen=True)
class Evaluator:
    """Evaluates demonstrations on instances that depend only on (seed, round, region, number).

    Attributes:
        planner: plans the instances.
        regions: the bandit's arms.
        q_start: (n,) rad, start configuration of every plan.
        strategy: decides when enough is known.
        seed: of the run.
        progress: called after every batch. Within a round the strategy is in control, so this is a
            callback where all else about a run is an event of `acquire`.
        executing: executes the plans, which then have to go as they should to succeed; a plan is
            a success if None.
    """

    planner: Planner
    regions: GridRegions
    q_start: Array
    strategy: Strategy
    seed: int
    progress: Progress | None = None
    executing: Executing | None = None

    def evaluate(
        self, round: int, demonstrations: tuple[Demonstration, ...], attempt: int
    ) -> tuple[Evaluation, Verdict]:
        """Run one round.

        Args:
            round: from 0; another round has fresh instances.
            demonstrations: in hand.
            attempt: as in `Strategy.decide`.
        """
        area, start = self.regions.area, self.q_start
        with begin_tries(self.planner, self.executing, area, start, round, demonstrations) as tries:
            sized = self.strategy if isinstance(self.strategy, OfFixedSize) else None
            total = None if sized is None else sized.total(self.regions.K, attempt=attempt)
            pulls = _Pulls(self, round, tries, total)
            verdict = self.strategy.decide(pulls, self.regions.K, attempt=attempt)
            return pulls.evaluation(), verdict


class _Pulls:
    """The strategy's source of samples, which remembers all it drew."""

    def __init__(
        self, evaluator: Evaluator, round: int, tries: Try, total: int | None = None
    ) -> None:
        self._by = evaluator
        self._round, self._total = round, total
        self._try = tries
        self._width = 0 if evaluator.executing is None else evaluator.executing.width
        K = evaluator.regions.K
        self._samples, self._failures = np.zeros(K, dtype=np.int64), np.zeros(K, dtype=np.int64)
        none = np.empty((0, *evaluator.regions.area.lower.shape))
        self._coordinates: list[Array] = [none]
        self._region: list[NDArray[np.int64]] = [np.empty(0, dtype=np.int64)]
        outcomes, executed = tries(none, np.empty((0, self._width)))
        self._outcomes: list[Outcomes] = [outcomes]
        self._executed: list[Executed | None] = [executed]

    def __call__(self, counts: NDArray[np.int64]) -> NDArray[np.int64]:
        before = self._failures.copy()
        if not counts.any():
            return np.zeros_like(counts)
        coordinates, region = draw_in_all(
            self._by.regions,
            counts,
            seed=self._by.seed,
            round=self._round,
            starts=self._samples,
        )
        numbers = self._numbers(counts)
        for first in range(0, len(region), BATCH):
            some = slice(first, first + BATCH)
            self._batch(coordinates[some], region[some], numbers[some])
        return self._failures - before

    def evaluation(self) -> Evaluation:
        return Evaluation(
            np.concatenate(self._coordinates),
            np.concatenate(self._region),
            concatenate(self._outcomes),
            executed=joined(self._executed),
        )

    def _numbers(self, counts: NDArray[np.int64]) -> Array:
        """(N, width) for the instances that `draw_in_all` draws."""
        drawn = [
            chance(
                self._width,
                seed=self._by.seed,
                round=self._round,
                region=j,
                start=int(self._samples[j]),
                count=int(counts[j]),
            )
            for j in np.flatnonzero(counts).tolist()
        ]
        return np.concatenate(drawn)

    def _batch(self, coordinates: Array, region: NDArray[np.int64], numbers: Array) -> None:
        outcomes, executed = self._try(coordinates, numbers)
        K = len(self._samples)
        self._samples += np.bincount(region, minlength=K)
        self._failures += np.bincount(region[~outcomes.any_success], minlength=K)
        self._coordinates.append(coordinates)
        self._region.append(region)
        self._outcomes.append(outcomes)
        self._executed.append(executed)
        if self._by.progress is not None:
            self._by.progress(
                RegionsEvaluated(
                    self._round, self._samples.copy(), self._failures.copy(), self._total
                )
            )
