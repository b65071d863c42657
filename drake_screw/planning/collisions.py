"""The planner that watches collisions: which plans that keep the limits touch nothing."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import connection
from drake_screw.planning.batch import BatchPlanner
from drake_screw.planning.connected import ahead, led_around, tried_first
from drake_screw.planning.outcomes import Cause, Outcomes, Plan, one_outcome
from drake_screw.planning.plan_checker import PlanChecker
from drake_screw.robot import ScrewChain, Workcell
from drake_screw.typing import Array

LONG = 10  # ways around that are announced, once, before they are sought

_LOG = logging.getLogger(__name__)


class CollisionFreePlanner:
    """A batch planner whose successes touch nothing.

    It answers as `BatchPlanner` does, with outcomes COLLISION where a plan keeps the limits but
    touches something: the variants of a demonstration are tried until one succeeds. Where the
    approach is free and nothing but the approach touches, the arm is led around what is in the way
    (see `connected`), as far as OMPL is installed.

    Args:
        planner: for limits and reach.
        workcell: to collide with.
        clearance: m, to be kept.

    Attributes:
        connects: whether arms are led around what is in the way.
    """

    def __init__(self, planner: BatchPlanner, workcell: Workcell, clearance: float = 0.0) -> None:
        self.planner = planner
        self.checker = PlanChecker(workcell, clearance)
        self.checked = planner.checked(self.checker.swept)
        self._announced = False
        self.connects = bool(planner.others) and connection.available()
        if planner.others and not self.connects:
            connection.warn_of_its_absence()

    @property
    def chain(self) -> ScrewChain:
        """The arm."""
        return self.planner.chain

    @property
    def evaluations(self) -> int:
        """As `BatchPlanner.evaluations`."""
        return self.planner.evaluations + self.checked.evaluations

    def all_outcomes(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance with every demonstration; as `BatchPlanner.all_outcomes`."""
        X_WO, q_start = np.asarray(X_WO, dtype=float), np.asarray(q_start, dtype=float)
        outcomes = self.checked.all_outcomes(demonstrations, X_WO, q_start)
        for i, d in self._to_lead_around(demonstrations, X_WO, q_start, ~outcomes.success):
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
        outcomes = self.checked.any_success(demonstrations, X_WO, q_start)
        failed = np.repeat(~outcomes.any_success[:, None], len(demonstrations), axis=1)
        solved = np.zeros(len(X_WO), dtype=bool)
        for i, d in self._to_lead_around(demonstrations, X_WO, q_start, failed):
            if solved[i]:
                outcomes = outcomes.replaced((i, d), one_outcome(Cause.NOT_TRIED, fraction=0.0))
                continue
            found = self._way_around(demonstrations[d], X_WO[i], q_start)
            if found is not None:
                outcomes, solved[i] = outcomes.replaced((i, d), found), True
        return outcomes

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

    def _to_lead_around(
        self,
        demonstrations: Sequence[Demonstration],
        X_WO: Array,
        q_start: Array,
        failed: NDArray[np.bool_],
    ) -> list[tuple[int, int]]:
        """Instance and demonstration of those that failed (N, D), but have plans within limits."""
        if not self.connects or not failed.any():
            return []
        touching = np.zeros_like(failed)
        for d, demonstration in enumerate(demonstrations):
            again = np.flatnonzero(failed[:, d])
            within = self.planner.all_outcomes([demonstration], X_WO[again], q_start)
            touching[again, d] = within.success[:, 0]
        left = [(int(i), int(d)) for i, d in zip(*np.nonzero(touching), strict=True)]
        if len(left) >= LONG:
            level = logging.DEBUG if self._announced else logging.INFO
            _LOG.log(level, "looking for ways around what is touched, for %d plans", len(left))
            self._announced = True
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
