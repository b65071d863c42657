"""The batch planner: many instances, many demonstrations, on code compiled for the arm."""

from __future__ import annotations

import logging
import os
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.demonstrations import Demonstration
from drake_screw.planning.compiled import Answers, Kernel, Order, Settings
from drake_screw.planning.outcomes import Cause, Outcomes, Plan
from drake_screw.planning.paths import joint_paths
from drake_screw.robot import ScrewChain
from drake_screw.screws import translation_distance
from drake_screw.typing import Array

EVALUATIONS_PER_STEP = 6

_LOG = logging.getLogger(__name__)


class BatchPlanner:
    """Answers `ReferencePlanner`'s question for whole batches, on all processors.

    The first planner of an arm on a machine has its code compiled at its first use, which takes
    a few seconds and is logged (INFO); later ones load it from a cache in the user's cache folder.

    Args:
        chain: the arm.
        tolerance: rad (or m), error allowed in one step of the joint path.
        threads: to use; all processors if None.

    Attributes:
        evaluations: of dq/ds = J^+ V so far, for benchmarks.
    """

    def __init__(
        self, chain: ScrewChain, *, tolerance: float | None = None, threads: int | None = None
    ) -> None:
        self.chain = chain
        self.threads = threads or os.cpu_count() or 1
        self.evaluations = 0
        settings = Settings() if tolerance is None else Settings(tolerance=tolerance)
        self._kernel = Kernel(chain.screws, chain.home, chain.lower, chain.upper, settings)

    @property
    def compiled(self) -> bool:
        """Whether the arm's code is compiled already, so that the first use will not wait."""
        return self._kernel.compiled

    def all_outcomes(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance with every demonstration.

        Args:
            demonstrations: D of them.
            X_WO: (N, k, 4, 4) object poses of the instances.
            q_start: (n,) rad or m.

        Returns:
            Outcomes (N, D). A start that is not strictly inside the limits fails at once.

        Raises:
            ValueError: a number is not finite or an array has the wrong shape; a demonstration has
                no guiding poses, or names an object that X_WO lacks.
        """
        return self._plan(demonstrations, X_WO, q_start, None, False)

    def any_success(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance until one demonstration succeeds, the nearest demonstrations first.

        Takes and returns what `all_outcomes` does; demonstrations left over are NOT_TRIED. The
        order only saves time: whether an instance succeeds does not depend on it.
        """
        there = [d.X_WO for d in demonstrations]

        def nearest_first(X_WO: Array) -> Array:
            away = [translation_distance(X_WO, X).sum(axis=-1) for X in there]
            return np.argsort(np.stack(away, axis=-1), axis=-1, kind="stable")

        return self._plan(demonstrations, X_WO, q_start, nearest_first, True)

    def plans(
        self,
        demonstrations: Sequence[Demonstration],
        X_WO: ArrayLike,
        q_start: ArrayLike,
        which: ArrayLike,
    ) -> tuple[Plan, ...]:
        """The plans behind outcomes: the joint paths that were followed to find them.

        Args:
            demonstrations, X_WO, q_start: as for `all_outcomes`.
            which: (N,) indices of the demonstration that each instance is planned with.

        Returns:
            N plans, each up to where it failed if it did. Their outcomes are those of
            `all_outcomes`, to the last bit.

        Raises:
            ValueError: as for `all_outcomes`; or an index is not that of a demonstration.
        """
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        which = np.asarray(which, dtype=np.int64)
        self._check(demonstrations, X_WO, q_start)
        N, D = len(X_WO), len(demonstrations)
        if which.shape != (N,) or ((which < 0) | (which >= D)).any():
            raise ValueError(f"which must be {N} indices from 0 to {D - 1}, it is {which}")
        if len(X_WO) == 0:
            return ()
        failed = self._failed_start(q_start, (len(X_WO),))
        if failed is not None:
            stay = np.zeros(1, dtype=np.int64), np.zeros(1)
            return tuple(Plan(q_start[None], *stay, failed[i]) for i in range(len(X_WO)))
        self._warn_of_compiling(len(X_WO))
        traced = self._kernel.trace(
            [d.X_OE for d in demonstrations],
            [d.objects for d in demonstrations],
            X_WO,
            q_start,
            which,
            threads=self.threads,
        )
        limits = np.stack([self.chain.lower, self.chain.upper])
        return tuple(
            plan
            for answers in traced
            for plan in joint_paths(_outcomes(answers)[:, 0], answers.trace, q_start, limits)
        )

    def plan(self, demonstration: Demonstration, X_WO: ArrayLike, q_start: ArrayLike) -> Plan:
        """The plan of one instance X_WO (k, 4, 4) with one demonstration; see `plans`."""
        return self.plans([demonstration], np.asarray(X_WO)[None], q_start, [0])[0]

    def _plan(
        self,
        demonstrations: Sequence[Demonstration],
        X_WO: ArrayLike,
        q_start: ArrayLike,
        order: Order | None,
        stop_at_success: bool,
    ) -> Outcomes:
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        self._check(demonstrations, X_WO, q_start)
        failed = self._failed_start(q_start, (len(X_WO), len(demonstrations)))
        if failed is not None:
            return failed
        self._warn_of_compiling(len(X_WO) * len(demonstrations))
        answers = self._kernel.plan(
            [d.X_OE for d in demonstrations],
            [d.objects for d in demonstrations],
            X_WO,
            q_start,
            order,
            stop_at_success=stop_at_success,
            threads=self.threads,
        )
        self.evaluations += EVALUATIONS_PER_STEP * int(answers.steps.sum())
        return _outcomes(answers)

    def _failed_start(self, q_start: Array, shape: tuple[int, ...]) -> Outcomes | None:
        """Outcomes of a start that is not inside the limits."""
        margin = np.minimum(q_start - self.chain.lower, self.chain.upper - q_start)
        if (margin > 0.0).all():
            return None
        return Outcomes(
            np.full(shape, Cause.JOINT_LIMIT, dtype=np.uint8),
            np.zeros(shape, dtype=np.int16),
            np.full(shape, int(np.argmin(margin)), dtype=np.int8),
            np.zeros(shape, dtype=np.float32),
        )

    def _warn_of_compiling(self, plans: int) -> None:
        if not self.compiled and plans > 0:
            _LOG.info("compiling the planner for this arm, once; this takes a few seconds")

    def _check(self, demonstrations: Sequence[Demonstration], X_WO: Array, q_start: Array) -> None:
        if q_start.shape != (self.chain.n,) or not np.isfinite(q_start).all():
            raise ValueError(f"q_start must be {self.chain.n} finite numbers, it is {q_start}")
        if X_WO.ndim != 4 or X_WO.shape[2:] != (4, 4):
            raise ValueError(f"X_WO has shape {X_WO.shape}, expected (N, k, 4, 4)")
        if not np.isfinite(X_WO.sum()):
            bad = int(np.argmax(~np.isfinite(X_WO).all(axis=(1, 2, 3))))
            raise ValueError(f"object poses X_WO of instance {bad} are not finite:\n{X_WO[bad]}")
        for d in demonstrations:
            if len(d.X_OE) == 0 or d.objects.max() >= X_WO.shape[1]:
                raise ValueError(
                    f"demonstration '{d.name}' has {len(d.X_OE)} guiding poses for the objects "
                    f"{sorted(set(d.objects.tolist()))}; X_WO has {X_WO.shape[1]} objects"
                )
            if not np.isfinite(d.X_OE).all():
                raise ValueError(f"demonstration '{d.name}' has guiding poses that are not finite")


def _outcomes(answers: Answers) -> Outcomes:
    return Outcomes(answers.cause, answers.segment, answers.joint, answers.fraction)
