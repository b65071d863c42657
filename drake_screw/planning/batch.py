"""The batch planner: many instances, many demonstrations, on code compiled for the arm."""

from __future__ import annotations

import logging
import os
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning.columns import Columns, every_turn
from drake_screw.planning.compiled import Answers, Kernel, Order, Settings
from drake_screw.planning.outcomes import Outcomes, Plan, concatenate
from drake_screw.planning.paths import joint_paths
from drake_screw.planning.questions import check_question, failed_start
from drake_screw.planning.symmetry import Symmetries
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
        symmetries: of the objects and the tool; of none if None.

    Attributes:
        evaluations: of dq/ds = J^+ V so far, for benchmarks.
    """

    def __init__(
        self,
        chain: ScrewChain,
        *,
        tolerance: float | None = None,
        threads: int | None = None,
        symmetries: Symmetries | None = None,
    ) -> None:
        self.chain = chain
        self.symmetries = symmetries or Symmetries()
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

        Where bodies are symmetric, a demonstration's turns are tried until one succeeds.

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
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        check_question(self.chain, demonstrations, X_WO, q_start)
        counts = np.array([self.symmetries.count(d) for d in demonstrations], dtype=np.int64)
        if len(np.unique(counts)) <= 1:
            run = int(counts.max(initial=1))
            return self._plan(demonstrations, X_WO, q_start, None, run)
        one_by_one = zip(demonstrations, counts.tolist(), strict=True)
        parts = [self._plan([d], X_WO, q_start, None, run) for d, run in one_by_one]
        return concatenate(parts, axis=1)

    def any_success(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance until one demonstration succeeds, the nearest demonstrations first.

        Takes and returns what `all_outcomes` does; demonstrations left over are NOT_TRIED. The
        order only saves time: whether an instance succeeds does not depend on it. Where bodies are
        symmetric, every demonstration is tried as it is turned first, then with its second turn,
        and so on; one that is left over before its last is NOT_TRIED, too.
        """
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        check_question(self.chain, demonstrations, X_WO, q_start)
        there = [d.X_WO for d in demonstrations]

        def nearest_first(X_WO: Array) -> Array:
            away = [translation_distance(X_WO, X).sum(axis=-1) for X in there]
            return np.argsort(np.stack(away, axis=-1), axis=-1, kind="stable")

        return self._plan(demonstrations, X_WO, q_start, nearest_first, None)

    def turn_outcomes(
        self, demonstration: Demonstration, X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance with every turn of a demonstration, whether or not one succeeds.

        Takes what `all_outcomes` does, and returns outcomes (N, T), by the order of the turns.
        """
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        check_question(self.chain, [demonstration], X_WO, q_start)
        turns = self.symmetries.count(demonstration)
        failed = failed_start(self.chain, q_start, (len(X_WO), turns))
        if failed is not None:
            return failed
        columns = Columns.of([demonstration], self.symmetries, X_WO.shape[1])
        answers = self._answers(columns, X_WO, q_start, None, 1)
        return concatenate([every_turn(found) for found in answers])

    def plans(
        self,
        demonstrations: Sequence[Demonstration],
        X_WO: ArrayLike,
        q_start: ArrayLike,
        which: ArrayLike,
        turn: ArrayLike = 0,
    ) -> tuple[Plan, ...]:
        """The plans behind outcomes: the joint paths that were followed to find them.

        Args:
            demonstrations, X_WO, q_start: as for `all_outcomes`.
            which: (N,) indices of the demonstration that each instance is planned with.
            turn: (N,) or one for all, which turn of it, as outcomes have it.

        Returns:
            N plans, each up to where it failed if it did. Their outcomes are those of
            `all_outcomes`, to the last bit.

        Raises:
            ValueError: as for `all_outcomes`; or an index is not that of a demonstration, or of a
                turn of it.
        """
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        which = np.asarray(which, dtype=np.int64)
        check_question(self.chain, demonstrations, X_WO, q_start)
        N, D = len(X_WO), len(demonstrations)
        if which.shape != (N,) or ((which < 0) | (which >= D)).any():
            raise ValueError(f"which must be {N} indices from 0 to {D - 1}, it is {which}")
        if N == 0:
            return ()
        columns = Columns.of(demonstrations, self.symmetries, X_WO.shape[1])
        turn = np.broadcast_to(np.asarray(turn, dtype=np.int64), (N,))
        if ((turn < 0) | (turn >= columns.counts[which])).any():
            raise ValueError(f"turn must count from 0 up to the turns there are, it is {turn}")
        guides, angles = self._followed(demonstrations, X_WO, which, turn)
        failed = failed_start(self.chain, q_start, (N,))
        if failed is not None:
            stay = np.zeros(1, dtype=np.int64), np.zeros(1)
            return tuple(
                Plan(q_start[None], *stay, failed[i], guides[i], angles[i]) for i in range(N)
            )
        self._warn_of_compiling(N)
        traced = self._kernel.trace(
            columns.X_OE,
            columns.objects,
            X_WO,
            q_start,
            columns.first[which] + turn,
            place=columns.poses,
            threads=self.threads,
        )
        limits = np.stack([self.chain.lower, self.chain.upper])
        plans: list[Plan] = []
        first = 0
        for answers in traced:
            found = _outcomes(answers, turn[first : first + len(answers.cause)])
            own = slice(first, first + len(found.cause))
            plans += joint_paths(found, answers.trace, q_start, limits, guides[own], angles[own])
            first = own.stop
        return tuple(plans)

    def plan(
        self,
        demonstration: Demonstration,
        X_WO: ArrayLike,
        q_start: ArrayLike,
        turn: int = 0,
    ) -> Plan:
        """The plan of one instance X_WO (k, 4, 4) with a turn of a demonstration; see `plans`."""
        return self.plans([demonstration], np.asarray(X_WO)[None], q_start, [0], turn)[0]

    def _plan(
        self,
        demonstrations: Sequence[Demonstration],
        X_WO: Array,
        q_start: Array,
        order: Order | None,
        run: int | None,
    ) -> Outcomes:
        """Outcomes (N, D), each run of so many turns ended by a success; all are one run if None.

        Args:
            order: of the demonstrations.
        """
        failed = failed_start(self.chain, q_start, (len(X_WO), len(demonstrations)))
        if failed is not None:
            return failed
        columns = Columns.of(demonstrations, self.symmetries, X_WO.shape[1])
        answers = self._answers(columns, X_WO, q_start, order, run or len(columns.X_OE))
        return concatenate([columns.outcomes(found) for found in answers])

    def _answers(
        self, columns: Columns, X_WO: Array, q_start: Array, order: Order | None, run: int
    ) -> list[Answers]:
        """The kernel's answers (m, C) for successive instances."""
        self._warn_of_compiling(len(X_WO) * len(columns.X_OE))

        def in_order(X_WO: Array) -> NDArray[np.int64]:
            assert order is not None
            return columns.in_order(order(X_WO))

        answers = self._kernel.plan(
            columns.X_OE,
            columns.objects,
            X_WO,
            q_start,
            order and in_order,
            run=run,
            place=columns.poses,
            threads=self.threads,
        )
        self.evaluations += EVALUATIONS_PER_STEP * sum(int(a.steps.sum()) for a in answers)
        return answers

    def _followed(
        self,
        demonstrations: Sequence[Demonstration],
        X_WO: Array,
        which: NDArray[np.int64],
        turn: NDArray[np.int64],
    ) -> tuple[list[Array], Array]:
        """Guiding poses X_WE (g, 4, 4) that each plan follows, and how its bodies are turned."""
        angles = np.zeros((len(X_WO), X_WO.shape[1] + 1))
        guides: list[Array] = [np.empty((0, 4, 4))] * len(X_WO)
        for d in np.unique(which):
            rows, demonstration = np.flatnonzero(which == d), demonstrations[d]
            angles[rows] = self.symmetries.angles(demonstration, X_WO[rows], turn[rows])
            X_WE = self.symmetries.guides(demonstration, X_WO[rows], angles[rows])
            for row, X in zip(rows.tolist(), X_WE, strict=True):
                guides[row] = X
        return guides, angles

    def _warn_of_compiling(self, plans: int) -> None:
        if not self.compiled and plans > 0:
            _LOG.info("compiling the planner for this arm, once; this takes a few seconds")


def _outcomes(answers: Answers, turn: NDArray[np.int64]) -> Outcomes:
    """Outcomes (N,) of answers (N, 1)."""
    found = every_turn(answers)[:, 0]
    return replace(found, turn=turn.astype(np.int16))
