"""The batch planner: many instances, many demonstrations, on the compiled kernel."""

from __future__ import annotations

from collections.abc import Sequence

import numba as nb
import numpy as np
from numpy.typing import ArrayLike

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import kernel
from drake_screw.planning.contract import RATE_LIMIT
from drake_screw.planning.outcomes import Cause, Outcomes
from drake_screw.robot import ScrewChain
from drake_screw.screws import translation_distance
from drake_screw.screws.rotations import Array

TOLERANCE = 1e-5


class BatchPlanner:
    """Answers `ReferencePlanner`'s question for whole batches, on all processors.

    Args:
        chain: the arm.
        tolerance: rad (or m), error allowed in one step of the joint path.
    """

    def __init__(self, chain: ScrewChain, *, tolerance: float = TOLERANCE) -> None:
        self.chain = chain
        self.tolerance = tolerance
        self.evaluations = 0

    def all_outcomes(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance with every demonstration.

        Args:
            demonstrations: D of them.
            X_WO: (N, k, 4, 4) object poses of the instances.
            q_start: (n,) rad or m.

        Returns:
            Outcomes (N, D).
        """
        X_WO = np.asarray(X_WO, dtype=float)
        order = np.broadcast_to(np.arange(len(demonstrations)), (len(X_WO), len(demonstrations)))
        return self._plan(demonstrations, X_WO, q_start, order, stop_early=False)

    def any_success(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance until one demonstration succeeds, the nearest demonstrations first.

        Takes and returns what `all_outcomes` does; demonstrations left over are NOT_TRIED.
        """
        X_WO = np.asarray(X_WO, dtype=float)
        away = np.stack(
            [translation_distance(X_WO, d.X_WO).sum(axis=-1) for d in demonstrations]
            or [np.empty(len(X_WO))],
            axis=-1,
        )[:, : len(demonstrations)]
        order = np.argsort(away, axis=1, kind="stable")
        return self._plan(demonstrations, X_WO, q_start, order, stop_early=True)

    def _plan(
        self,
        demonstrations: Sequence[Demonstration],
        X_WO: Array,
        q_start: ArrayLike,
        order: Array,
        *,
        stop_early: bool,
    ) -> Outcomes:
        N, D = order.shape
        outcomes = Outcomes(
            np.full((N, D), Cause.NOT_TRIED, dtype=np.uint8),
            np.full((N, D), -1, dtype=np.int16),
            np.full((N, D), -1, dtype=np.int8),
            np.zeros((N, D), dtype=np.float32),
        )
        if N == 0 or D == 0:
            return outcomes
        counts = np.array([len(d.X_OE) for d in demonstrations])
        X_OE = np.zeros((D, counts.max(), 4, 4))
        owner = np.zeros((D, counts.max()), dtype=np.int64)
        for i, demonstration in enumerate(demonstrations):
            X_OE[i, : counts[i]], owner[i, : counts[i]] = demonstration.X_OE, demonstration.objects
        evaluations = np.zeros((N, D), dtype=np.int32)
        chain = self.chain
        kernel.plan_all(
            chain.screws, chain.home, chain.lower, chain.upper, X_OE, owner, counts,
            np.ascontiguousarray(X_WO), np.array(q_start, dtype=float), self.tolerance, RATE_LIMIT,
            np.ascontiguousarray(order, dtype=np.int64), stop_early, outcomes.cause,
            outcomes.segment, outcomes.joint, outcomes.fraction, evaluations,
        )  # fmt: skip
        self.evaluations += int(evaluations.sum())
        return outcomes


def threads() -> int:
    """How many threads the batch planner uses."""
    return int(nb.get_num_threads())
