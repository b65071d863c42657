"""The batch planner: many instances, many demonstrations, on code compiled for the arm."""

from __future__ import annotations

import copy
import os
from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import questions
from drake_screw.planning.approach import approached, stuck
from drake_screw.planning.columns import Columns, furthest
from drake_screw.planning.compiled import Answers, Kernel, Order, Settings
from drake_screw.planning.contract import Redundancy
from drake_screw.planning.outcomes import Outcomes, Plan, concatenate
from drake_screw.planning.paths import joint_paths
from drake_screw.planning.plan_checker import check_of
from drake_screw.planning.swept import SweptChecker
from drake_screw.planning.symmetry import Symmetries
from drake_screw.robot import ScrewChain
from drake_screw.screws.endless import brought_near, is_endless
from drake_screw.typing import Array

EVALUATIONS_PER_STEP = 6


class BatchPlanner:
    """Answers `ReferencePlanner`'s question for whole batches, on all processors.

    The first planner of an arm on a machine has its code compiled at its first use, which takes
    a few seconds and is logged (INFO); later ones load it from a cache in the user's cache folder.

    Args:
        chain: the arm.
        tolerance: rad (or m), error allowed in one step of the path.
        threads: to use; all processors if None.
        symmetries: of the objects and the tool.
        seeds: (S, n) configurations from which inverse kinematics of the first guiding pose sets
            out where the screw from the start fails: the approach is free then. None where every
            motion is along a screw.
        redundancy: what more joints than six do with the motion that the end effector leaves free.
        free_axis: (3,) in E, about which the end effector's roll is free; None where none is.

    Attributes:
        checker: of what successes must not touch; None where collisions are not looked at.
        evaluations: of dq/ds = J^+ V so far, for benchmarks.
    """

    def __init__(
        self,
        chain: ScrewChain,
        *,
        tolerance: float | None = None,
        threads: int | None = None,
        symmetries: Symmetries | None = None,
        seeds: Array | None = None,
        redundancy: Redundancy = "least_norm",
        free_axis: ArrayLike | None = None,
    ) -> None:
        self.chain = chain
        self.seeds = np.zeros((0, chain.n)) if seeds is None else seeds
        self.others = range(1, 1 + len(self.seeds))
        self.symmetries = symmetries or Symmetries()
        self.threads = threads or os.cpu_count() or 1
        self.evaluations, self.redundancy = 0, redundancy
        self.free_axis = None if free_axis is None else np.asarray(free_axis, dtype=float)
        self.checker: SweptChecker | None = None
        settings = Settings(tolerance=tolerance or Settings.tolerance, redundancy=redundancy)
        ranges = chain.lower, chain.upper
        self._kernel = Kernel(chain.screws, chain.home, *ranges, settings, self.free_axis)

    def checked(self, checker: SweptChecker) -> BatchPlanner:
        """The same planner, whose successes touch nothing by that checker."""
        planner = copy.copy(self)
        planner.checker, planner.evaluations = checker, 0
        return planner

    @property
    def compiled(self) -> bool:
        """Whether the arm's code is compiled already, so that the first use will not wait."""
        return self._kernel.compiled

    def all_outcomes(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance with every demonstration.

        Where there are variants of a demonstration (turns of symmetric bodies, configurations to
        come from), they are tried until one succeeds.

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
        questions.check_question(self.chain, demonstrations, X_WO, q_start)
        outcomes = self._each_alone(demonstrations, X_WO, q_start, range(1))
        if not self.others:
            return outcomes
        for d, demonstration in enumerate(demonstrations):
            left = np.flatnonzero(~outcomes.success[:, d])
            again = self._each_alone([demonstration], X_WO[left], q_start, self.others)[:, 0]
            outcomes = outcomes.replaced((left, d), furthest(outcomes[left, d], again))
        return outcomes

    def any_success(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance until one demonstration succeeds, the nearest demonstrations first.

        Takes and returns what `all_outcomes` does; demonstrations left over are NOT_TRIED. The
        order only saves time: whether an instance succeeds does not depend on it. Where there are
        variants, the first one of every demonstration is tried, then the second one of every, and
        so on; a demonstration that is left over before its last variant is NOT_TRIED, too.
        """
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        questions.check_question(self.chain, demonstrations, X_WO, q_start)
        order = partial(questions.nearest_first, demonstrations)

        outcomes = self._plan(demonstrations, X_WO, q_start, order, None, range(1))
        left = np.flatnonzero(~outcomes.any_success)
        if not self.others or len(left) == 0:
            return outcomes
        again = self._plan(demonstrations, X_WO[left], q_start, order, None, self.others)
        return outcomes.replaced(left, furthest(outcomes[left], again))

    def variant_outcomes(
        self,
        demonstration: Demonstration,
        X_WO: ArrayLike,
        q_start: ArrayLike,
        *,
        others: bool = True,
    ) -> Outcomes:
        """Plan every instance with every variant of a demonstration, whether or not one succeeds.

        Takes what `all_outcomes` does, and returns outcomes (N, V), by the number of the variant;
        without `others` only of those that come from the arm's own start.
        """
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        questions.check_question(self.chain, [demonstration], X_WO, q_start)
        starts = range(1 + len(self.others)) if others else range(1)
        columns = self._columns([demonstration], X_WO, starts)
        failed = questions.failed_start(self.chain, q_start, (len(X_WO), len(columns.X_OE)))
        if failed is not None:
            return failed
        answers = self._answers(columns, X_WO, q_start, None, 1)
        return concatenate([columns.each(found) for found in answers])

    def variants(self, demonstration: Demonstration) -> int:
        """How many variants of a demonstration there are."""
        return self.symmetries.count(demonstration) * (1 + len(self.others))

    def plans(
        self,
        demonstrations: Sequence[Demonstration],
        X_WO: ArrayLike,
        q_start: ArrayLike,
        which: ArrayLike,
        variant: ArrayLike = 0,
    ) -> tuple[Plan, ...]:
        """The plans behind outcomes: the joint paths that were followed to find them.

        Args:
            demonstrations, X_WO, q_start: as for `all_outcomes`.
            which: (N,) indices of the demonstration that each instance is planned with.
            variant: (N,) or one for all, which variant of it, as outcomes have it.

        Returns:
            N plans, each up to where it failed if it did. Their outcomes are those of
            `all_outcomes`, to the last bit.

        Raises:
            ValueError: as for `all_outcomes`; or an index is not that of a demonstration, or of a
                variant of it.
        """
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        which = np.asarray(which, dtype=np.int64)
        questions.check_question(self.chain, demonstrations, X_WO, q_start)
        variant = np.broadcast_to(np.asarray(variant, dtype=np.int64), (N := len(X_WO),))
        columns = self._columns(demonstrations, X_WO, range(1 + len(self.others)))
        questions.check_choice(which, variant, N, columns.counts)
        if N == 0:
            return ()
        guides, angles = columns.followed(X_WO, which, variant)
        failed = questions.failed_start(self.chain, q_start, (N,))
        if failed is not None:
            return stuck(q_start, failed, guides, angles)
        self._kernel.tell_of_compiling()
        column = columns.first[which] + variant
        traced = self._kernel.trace(
            columns.X_OE,
            columns.objects,
            X_WO,
            self._starts(q_start),
            column,
            begins=columns.begins,
            place=columns.poses,
            threads=self.threads,
        )
        limits = np.stack([self.chain.lower, self.chain.upper])
        starts = self._starts(q_start)[columns.begins[column]]
        plans: list[Plan] = []
        for answers in traced:
            own = slice(len(plans), len(plans) + len(answers.cause))
            found = columns.of_columns(answers, column[own])
            plans += joint_paths(
                found, answers.trace, starts[own], limits, guides[own], angles[own], self.free_axis
            )
        return tuple(
            approached(plan, q_start) if columns.begins[c] else plan
            for plan, c in zip(plans, column, strict=True)
        )

    def plan(
        self, demonstration: Demonstration, X_WO: ArrayLike, q_start: ArrayLike, variant: int = 0
    ) -> Plan:
        """The plan of one instance X_WO (k, 4, 4); see `plans`."""
        return self.plans([demonstration], np.asarray(X_WO)[None], q_start, [0], variant)[0]

    def _starts(self, q_start: Array) -> Array:
        """(1 + S, n) the start, and the seeds of a free approach, by whole turns near it."""
        endless = is_endless(self.chain.lower, self.chain.upper)
        return np.concatenate([q_start[None], brought_near(self.seeds, q_start, endless)])

    def _columns(
        self, demonstrations: Sequence[Demonstration], X_WO: Array, starts: range
    ) -> Columns:
        return Columns.of(demonstrations, self.symmetries, X_WO.shape[1], starts)

    def _each_alone(
        self, demonstrations: Sequence[Demonstration], X_WO: Array, q_start: Array, starts: range
    ) -> Outcomes:
        """Outcomes (N, D), the variants of each demonstration ended by a success of that one."""
        counts = [self.symmetries.count(d) * len(starts) for d in demonstrations]
        if len(set(counts)) <= 1:
            run = max(counts, default=1)
            return self._plan(demonstrations, X_WO, q_start, None, run, starts)
        parts = [self._plan([d], X_WO, q_start, None, None, starts) for d in demonstrations]
        return concatenate(parts, axis=1)

    def _plan(
        self,
        demonstrations: Sequence[Demonstration],
        X_WO: Array,
        q_start: Array,
        order: Order | None,
        run: int | None,
        starts: range,
    ) -> Outcomes:
        """Outcomes (N, D), each run of so many variants ended by a success; one run if None.

        Args:
            order: of the demonstrations.
            starts: configurations to try.
        """
        failed = questions.failed_start(self.chain, q_start, (len(X_WO), len(demonstrations)))
        if failed is not None:
            return failed
        columns = self._columns(demonstrations, X_WO, starts)
        answers = self._answers(columns, X_WO, q_start, order, run or len(columns.X_OE))
        return concatenate([columns.outcomes(found) for found in answers])

    def _answers(
        self, columns: Columns, X_WO: Array, q_start: Array, order: Order | None, run: int
    ) -> list[Answers]:
        """The kernel's answers (m, C) for successive instances."""
        if len(X_WO) * len(columns.X_OE) > 0:
            self._kernel.tell_of_compiling()

        def in_order(X_WO: Array) -> NDArray[np.int64]:
            assert order is not None
            return columns.in_order(order(X_WO))

        answers = self._kernel.plan(
            columns.X_OE,
            columns.objects,
            X_WO,
            self._starts(q_start),
            order and in_order,
            run=run,
            begins=columns.begins,
            place=columns.poses,
            check=check_of(self.checker, columns.begins, q_start),
            threads=self.threads,
        )
        self.evaluations += EVALUATIONS_PER_STEP * sum(int(a.steps.sum()) for a in answers)
        return answers
