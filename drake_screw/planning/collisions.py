"""The planner that watches collisions: which plans that keep the limits touch nothing."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning.batch import BatchPlanner
from drake_screw.planning.columns import best_variant
from drake_screw.planning.connected import ahead, led_around, tried_first
from drake_screw.planning.connection import available, warn_of_its_absence
from drake_screw.planning.outcomes import Cause, Outcomes, Plan, concatenate, one_outcome
from drake_screw.planning.plan_checker import PlanChecker
from drake_screw.robot import Workcell
from drake_screw.typing import Array

PLANS = 1024  # that are checked together
LONG = 10  # ways around that are announced before they are sought

_LOG = logging.getLogger(__name__)


class CollisionFreePlanner:
    """A batch planner whose successes touch nothing.

    It answers as `BatchPlanner` does, with outcomes COLLISION where a plan keeps the limits but
    touches something. Where the approach is free and nothing but the approach touches, the arm is
    led around what is in the way (see `connected`), as far as OMPL is installed.

    Args:
        planner: for limits and reach.
        workcell: to collide with.

    Attributes:
        connects: whether arms are led around what is in the way.
    """

    def __init__(self, planner: BatchPlanner, workcell: Workcell) -> None:
        self.planner = planner
        self.checker = PlanChecker(workcell)
        self.connects = bool(planner.others) and available()
        if planner.others and not self.connects:
            warn_of_its_absence()

    @property
    def evaluations(self) -> int:
        """As `BatchPlanner.evaluations`."""
        return self.planner.evaluations

    def all_outcomes(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance with every demonstration; as `BatchPlanner.all_outcomes`."""
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        outcomes, touching = self._without_ways_around(demonstrations, X_WO, q_start)
        for i, d in self._to_lead_around(touching & ~outcomes.success):
            found = self._way_around(demonstrations[d], X_WO[i], q_start)
            outcomes = outcomes if found is None else outcomes.replaced((i, d), found)
        return outcomes

    def any_success(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance until one demonstration succeeds; as `BatchPlanner.any_success`.

        Ways around are sought last, where no demonstration succeeds without.
        """
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        first = self.planner.any_success(demonstrations, X_WO, q_start)
        outcomes = self._checked(first, demonstrations, X_WO, q_start)
        again = np.flatnonzero((outcomes.cause == Cause.COLLISION).any(axis=-1))
        if len(again) == 0:
            return outcomes
        others, touching = self._without_ways_around(demonstrations, X_WO[again], q_start)
        if self.connects:
            left_over = one_outcome(Cause.NOT_TRIED, fraction=0.0)
            solved = others.any_success[:, None] & touching & ~others.success
            others = others.replaced(solved, left_over)
            touching &= ~others.any_success[:, None]
        for i, d in self._to_lead_around(touching):
            if others.any_success[i]:
                others = others.replaced((i, d), left_over)
                continue
            found = self._way_around(demonstrations[d], X_WO[again[i]], q_start)
            others = others if found is None else others.replaced((i, d), found)
        return outcomes.replaced(again, others)

    def plans(
        self,
        demonstrations: Sequence[Demonstration],
        X_WO: ArrayLike,
        q_start: ArrayLike,
        which: ArrayLike,
        variant: ArrayLike = 0,
    ) -> tuple[Plan, ...]:
        """The plans behind outcomes, with the way around where one was found.

        Takes and returns what `BatchPlanner.plans` does. Plans that fail for a collision are whole:
        of collisions nothing is known there.
        """
        X_WO = np.asarray(X_WO, dtype=float)
        plans = self.planner.plans(demonstrations, X_WO, q_start, which, variant)
        if not self.connects:
            return plans
        found = self.checker.first_collisions(plans, X_WO)
        touches = found.collides & (found.segment == 0)
        return tuple(
            (led_around(self.checker, plan, X) or plan) if touch and plan.success else plan
            for plan, X, touch in zip(plans, X_WO, touches, strict=True)
        )

    def plan(
        self,
        demonstration: Demonstration,
        X_WO: ArrayLike,
        q_start: ArrayLike,
        variant: int = 0,
    ) -> Plan:
        """The plan of one instance X_WO (k, 4, 4) with a demonstration's variant; see `plans`."""
        return self.plans([demonstration], np.asarray(X_WO)[None], q_start, [0], variant)[0]

    def _without_ways_around(
        self, demonstrations: Sequence[Demonstration], X_WO: Array, q_start: Array
    ) -> tuple[Outcomes, NDArray[np.bool_]]:
        """Outcomes (N, D), and which demonstrations have plans that touch something (N, D)."""
        outcomes = self.planner.all_outcomes(demonstrations, X_WO, q_start)
        outcomes = self._checked(outcomes, demonstrations, X_WO, q_start)
        touching = outcomes.cause == Cause.COLLISION
        for d, demonstration in enumerate(demonstrations):
            again = np.flatnonzero(touching[:, d])
            if len(again) and self.planner.variants(demonstration) > 1:
                others = self._of_variants(demonstration, X_WO[again], q_start, outcomes[again, d])
                outcomes = outcomes.replaced((again, d), others)
        return outcomes, touching

    def _to_lead_around(self, touching: NDArray[np.bool_]) -> list[tuple[int, int]]:
        """Instance and demonstration of all (N, D) whose plans touch something."""
        if not self.connects:
            return []
        left = [(int(i), int(d)) for i, d in zip(*np.nonzero(touching), strict=True)]
        if len(left) >= LONG:
            _LOG.info("looking for ways around what is touched, for %d plans", len(left))
        return left

    def _way_around(
        self, demonstration: Demonstration, X_WO: Array, q_start: Array
    ) -> Outcomes | None:
        """The outcome of an instance X_WO (k, 4, 4) that a way around solves, if one does."""
        variants = np.flatnonzero(
            self.planner.variant_outcomes(demonstration, X_WO[None], q_start).success[0]
        )
        X_WO = np.broadcast_to(X_WO, (len(variants), *X_WO.shape))
        which = np.zeros(len(variants), dtype=np.int64)
        plans = self.planner.plans([demonstration], X_WO, q_start, which, variants)
        later = self.checker.first_collisions([ahead(plan) for plan in plans], X_WO).collides
        free = np.flatnonzero(~later)
        for i in free[tried_first([plans[j] for j in free])]:
            if led_around(self.checker, plans[i], X_WO[i]) is not None:
                return one_outcome(Cause.SUCCESS, variant=int(variants[i]))
        return None

    def _of_variants(
        self, demonstration: Demonstration, X_WO: Array, q_start: ArrayLike, known: Outcomes
    ) -> Outcomes:
        """(N,) outcomes of instances where a variant keeps the limits and touches something.

        Args:
            known: (N,) outcomes COLLISION of that variant, the first that keeps the limits.
        """
        outcomes = self.planner.variant_outcomes(demonstration, X_WO, q_start)
        outcomes = outcomes.replaced((np.arange(len(X_WO)), known.variant), known)
        for variant in range(int(known.variant.min()) + 1, outcomes.shape[1]):
            solved = outcomes.success[:, :variant].any(axis=1)
            left = np.flatnonzero(outcomes.success[:, variant] & ~solved)
            if len(left) == 0:
                continue
            variants = np.full(len(left), variant, dtype=np.int16)
            which = np.zeros(len(left), dtype=np.int64)
            found = self._of_plans([demonstration], X_WO[left], q_start, which, variants)
            outcomes = outcomes.replaced((left, variant), found)
        return best_variant(outcomes)

    def _checked(
        self,
        outcomes: Outcomes,
        demonstrations: Sequence[Demonstration],
        X_WO: Array,
        q_start: ArrayLike,
    ) -> Outcomes:
        """Outcomes (N, D) with COLLISION in place of those successes that touch something."""
        instance, which = np.nonzero(outcomes.success)
        variant = outcomes.variant[instance, which]
        parts = [
            self._of_plans(
                demonstrations, X_WO[instance[some]], q_start, which[some], variant[some]
            )
            for some in np.split(np.arange(len(instance)), range(PLANS, len(instance), PLANS))
        ]
        return outcomes.replaced((instance, which), concatenate(parts))

    def _of_plans(
        self,
        demonstrations: Sequence[Demonstration],
        X_WO: Array,
        q_start: ArrayLike,
        which: NDArray[np.int64],
        variant: NDArray[np.int16],
    ) -> Outcomes:
        """(N,) outcomes of plans that keep the limits, N instances with one demonstration each."""
        plans = self.planner.plans(demonstrations, X_WO, q_start, which, variant)
        found = self.checker.first_collisions(plans, X_WO)
        return Outcomes(
            np.where(found.collides, Cause.COLLISION, Cause.SUCCESS).astype(np.uint8),
            found.segment.astype(np.int16),
            np.full(len(plans), -1, dtype=np.int8),
            found.fraction.astype(np.float32),
            variant,
        )
