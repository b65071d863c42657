"""One round: draw task instances, plan them, and let a strategy decide what the failures show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.acquisition.events import Evaluation, RegionsEvaluated
from drake_screw.bandits import Strategy, Verdict
from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Outcomes, Planner, concatenate
from drake_screw.tasks import GridRegions, draw_in_all
from drake_screw.typing import Array

BATCH = 16_384

Progress = Callable[[RegionsEvaluated], None]


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
    """

    planner: Planner
    regions: GridRegions
    q_start: Array
    strategy: Strategy
    seed: int
    progress: Progress | None = None

    def evaluate(
        self, round: int, demonstrations: tuple[Demonstration, ...], attempt: int
    ) -> tuple[Evaluation, Verdict]:
        """Run one round.

        Args:
            round: from 0; another round has fresh instances.
            demonstrations: in hand.
            attempt: as in `Strategy.decide`.
        """
        pulls = _Pulls(self, round, demonstrations)
        verdict = self.strategy.decide(pulls, self.regions.K, attempt=attempt)
        return pulls.evaluation(), verdict


class _Pulls:
    """The strategy's source of samples, which remembers all it drew."""

    def __init__(
        self, evaluator: Evaluator, round: int, demonstrations: tuple[Demonstration, ...]
    ) -> None:
        self._by = evaluator
        self._round = round
        self._demonstrations = demonstrations
        K = evaluator.regions.K
        self._samples, self._failures = np.zeros(K, dtype=np.int64), np.zeros(K, dtype=np.int64)
        none = np.empty((0, *evaluator.regions.area.lower.shape))
        self._coordinates: list[Array] = [none]
        self._region: list[NDArray[np.int64]] = [np.empty(0, dtype=np.int64)]
        self._outcomes: list[Outcomes] = [self._plan(self._coordinates[0])]

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
        for first in range(0, len(region), BATCH):
            self._batch(coordinates[first : first + BATCH], region[first : first + BATCH])
        return self._failures - before

    def evaluation(self) -> Evaluation:
        return Evaluation(
            np.concatenate(self._coordinates),
            np.concatenate(self._region),
            concatenate(self._outcomes),
        )

    def _batch(self, coordinates: Array, region: NDArray[np.int64]) -> None:
        outcomes = self._plan(coordinates)
        K = len(self._samples)
        self._samples += np.bincount(region, minlength=K)
        self._failures += np.bincount(region[~outcomes.any_success], minlength=K)
        self._coordinates.append(coordinates)
        self._region.append(region)
        self._outcomes.append(outcomes)
        if self._by.progress is not None:
            self._by.progress(
                RegionsEvaluated(self._round, self._samples.copy(), self._failures.copy())
            )

    def _plan(self, coordinates: Array) -> Outcomes:
        return self._by.planner.any_success(
            self._demonstrations, self._by.regions.area.X_WO(coordinates), self._by.q_start
        )
