"""Collisions along plans: which of those that keep the limits touch something, and where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning.batch import BatchPlanner
from drake_screw.planning.clearance import bubbles_of
from drake_screw.planning.columns import best_variant
from drake_screw.planning.outcomes import Cause, Outcomes, Plan, concatenate
from drake_screw.robot import Workcell
from drake_screw.typing import Array

SPACING = 0.01
"""m, at most, that the arm moves between two configurations that Drake is asked about."""

SLACK = 2e-3
"""m, by which the way of a part of the arm between two points of a plan may be longer than the
straight line."""

CHUNK = 8192  # configurations whose bounds are computed together
PLANS = 1024  # that are checked together


@dataclass(frozen=True, eq=False)
class Collisions:
    """The first collision on each of N paths.

    Attributes:
        collides: (N,) whether there is any.
        segment: (N,) where it is, from 0; -1 if there is none.
        fraction: (N,) how much of that segment is done by then.
        q: (N, n) rad, the first colliding configuration; NaN if there is none.
    """

    collides: NDArray[np.bool_]
    segment: NDArray[np.int64]
    fraction: Array
    q: Array


@dataclass(frozen=True)
class Hit:
    """Where a plan first touches something: segment from 0, fraction of it, pairs of bodies."""

    segment: int
    fraction: float
    bodies: tuple[tuple[str, str], ...]

    def __str__(self) -> str:
        pairs = ", ".join(f"{a} touches {b}" for a, b in self.bodies)
        return f"{pairs} in segment {self.segment + 1}"


class PlanChecker:
    """Finds the collisions of plans in a workcell.

    Bounds on clearance (`planning.clearance`) show which stretches of a path are surely free. On
    the rest, `Workcell.collides` is asked about configurations at most SPACING apart, for all
    paths in one parallel call.

    Args:
        workcell: robot, table and objects.
    """

    def __init__(self, workcell: Workcell) -> None:
        self.workcell = workcell
        self.bubbles = bubbles_of(workcell)
        self.asked = 0

    def first_collisions(self, plans: Sequence[Plan], X_WO: ArrayLike) -> Collisions:
        """Check plans.

        Args:
            plans: N of the batch planner's.
            X_WO: (N, k, 4, 4) the objects of each.
        """
        N, X_WO = len(plans), np.asarray(X_WO, dtype=float)
        n = self.workcell.arm.n
        result = Collisions(
            np.zeros(N, dtype=bool), np.full(N, -1), np.ones(N), np.full((N, n), np.nan)
        )
        if N == 0:
            return result
        q = np.concatenate([plan.q for plan in plans])
        segment = np.concatenate([plan.segment for plan in plans])
        s = np.concatenate([plan.s for plan in plans])
        owner = np.repeat(np.arange(N), [len(plan.q) for plan in plans])
        uncertain, travel = self._bounds(q, X_WO, owner)
        step = np.flatnonzero(uncertain)
        parts = np.maximum(np.ceil(travel[step] / SPACING).astype(int), 1)
        part = 1 + np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
        step, share = np.repeat(step, parts), part / np.repeat(parts, parts)
        asked = q[step] + share[:, None] * (q[step + 1] - q[step])
        hit = np.flatnonzero(self._collide(asked, X_WO[owner[step]]))
        found, first = np.unique(owner[step[hit]], return_index=True)
        at = hit[first]
        where, into = step[at], share[at]
        began = np.where(segment[where] == segment[where + 1], s[where], 0.0)
        result.collides[found] = True
        result.segment[found] = segment[where + 1]
        result.fraction[found] = began + into * (s[where + 1] - began)
        result.q[found] = asked[at]
        return result

    def explain(self, plan: Plan, X_WO: ArrayLike) -> Hit | None:
        """The first collision of a plan among objects X_WO (k, 4, 4), if there is one."""
        X_WO = np.asarray(X_WO, dtype=float)
        found = self.first_collisions([plan], X_WO[None])
        if not found.collides[0]:
            return None
        bodies = self.workcell.colliding_bodies(found.q[0], X_WO)
        return Hit(int(found.segment[0]), float(found.fraction[0]), bodies)

    def _collide(self, q: Array, X_WO: Array) -> Array:
        self.asked += len(q)
        return self.workcell.collides(q, X_WO) if len(q) else np.zeros(0, dtype=bool)

    def _bounds(self, q: Array, X_WO: Array, owner: Array) -> tuple[Array, Array]:
        """Which of the steps between successive points are not surely free, and their travel in m.

        Args:
            q: (M, n) points of plans, one plan after the other.
            X_WO: (N, k, 4, 4) the objects of each plan.
            owner: (M,) the plan of each point.

        Returns:
            (M - 1,) bool, False between two plans; (M - 1,) m.
        """
        uncertain, travel = np.zeros(len(q) - 1, dtype=bool), np.zeros(len(q) - 1)
        for first in range(0, len(q) - 1, CHUNK):
            steps, points = slice(first, first + CHUNK), slice(first, first + CHUNK + 1)
            distance, p = self.bubbles(q[points], X_WO[owner[points]])
            moved = np.linalg.norm(np.diff(p, axis=0), axis=-1) + SLACK
            free = distance[1:] + distance[:-1] > moved
            uncertain[steps] = ~free.all(axis=-1)
            travel[steps] = moved.max(axis=-1, initial=0.0)
        return uncertain & (owner[1:] == owner[:-1]), travel


class CollisionFreePlanner:
    """A batch planner whose successes touch nothing.

    It answers as `BatchPlanner` does, with outcomes COLLISION where a plan keeps the limits but
    touches something.

    Args:
        planner: for limits and reach.
        workcell: to collide with.
    """

    def __init__(self, planner: BatchPlanner, workcell: Workcell) -> None:
        self.planner = planner
        self.checker = PlanChecker(workcell)

    @property
    def evaluations(self) -> int:
        """As `BatchPlanner.evaluations`."""
        return self.planner.evaluations

    def all_outcomes(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance with every demonstration; as `BatchPlanner.all_outcomes`."""
        X_WO = np.asarray(X_WO, dtype=float)
        outcomes = self.planner.all_outcomes(demonstrations, X_WO, q_start)
        outcomes = self._checked(outcomes, demonstrations, X_WO, q_start)
        for d, demonstration in enumerate(demonstrations):
            again = np.flatnonzero(outcomes.cause[:, d] == Cause.COLLISION)
            if len(again) and self.planner.variants(demonstration) > 1:
                others = self._of_variants(demonstration, X_WO[again], q_start, outcomes[again, d])
                outcomes = outcomes.replaced((again, d), others)
        return outcomes

    def any_success(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance until one demonstration succeeds; as `BatchPlanner.any_success`."""
        X_WO = np.asarray(X_WO, dtype=float)
        first = self.planner.any_success(demonstrations, X_WO, q_start)
        outcomes = self._checked(first, demonstrations, X_WO, q_start)
        again = np.flatnonzero((outcomes.cause == Cause.COLLISION).any(axis=-1))
        if len(again) == 0:
            return outcomes
        return outcomes.replaced(again, self.all_outcomes(demonstrations, X_WO[again], q_start))

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
