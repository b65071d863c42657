"""Collisions along plans: which of those that keep the limits touch something, and where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning.batch import BatchPlanner
from drake_screw.planning.clearance import bubbles_of
from drake_screw.planning.outcomes import Cause, Outcomes
from drake_screw.planning.paths import Paths, joint_paths
from drake_screw.robot import Workcell
from drake_screw.typing import Array

SPACING = 0.01
"""m, at most, that the arm moves between two configurations that Drake is asked about."""

SLACK = 2e-3
"""m, by which a part of the arm may stray from the straight line between two points of a path."""

CHUNK = 8192  # configurations whose bounds are computed together


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

    Bounds on clearance (`planning.clearance`) tell which stretches of a path are surely free. On
    the rest, `Workcell.collides` is asked about configurations at most SPACING apart, for all
    paths in one parallel call.

    Args:
        workcell: robot, table and objects.
    """

    def __init__(self, workcell: Workcell) -> None:
        self.workcell = workcell
        self.bubbles = bubbles_of(workcell)
        self.asked = 0

    def first_collisions(self, paths: Paths, X_WO: ArrayLike) -> Collisions:
        """Check paths.

        Args:
            paths: of N plans.
            X_WO: (N, k, 4, 4) the objects of each.
        """
        N, _, n = paths.q.shape
        X_WO = np.asarray(X_WO, dtype=float)
        uncertain, travel = self._bounds(paths.q, X_WO)
        path, step = np.nonzero(uncertain)
        parts = np.maximum(np.ceil(travel[path, step] / SPACING).astype(int), 1)
        which = np.repeat(np.arange(len(path)), parts)
        part = 1 + np.arange(len(which)) - np.repeat(np.cumsum(parts) - parts, parts)
        share = part / parts[which]
        path, step = path[which], step[which]
        before, after = paths.q[path, step], paths.q[path, step + 1]
        q = before + share[:, None] * (after - before)
        hit = self.workcell.collides(q, X_WO[path]) if len(q) else np.zeros(0, dtype=bool)
        self.asked += len(q)
        found, first = np.unique(path[hit], return_index=True)
        at = np.flatnonzero(hit)[first]
        where, into = step[at], share[at]
        began = np.where(paths.segment[where] == paths.segment[where + 1], paths.s[where], 0.0)
        result = Collisions(
            np.zeros(N, dtype=bool),
            np.full(N, -1),
            np.ones(N),
            np.full((N, n), np.nan),
        )
        result.collides[found] = True
        result.segment[found] = paths.segment[where + 1]
        result.fraction[found] = began + into * (paths.s[where + 1] - began)
        result.q[found] = q[at]
        return result

    def explain(
        self, demonstration: Demonstration, X_WO: ArrayLike, q_start: ArrayLike
    ) -> Hit | None:
        """The first collision of the plan for one instance X_WO (k, 4, 4), if there is one."""
        one = np.asarray(X_WO, dtype=float)[None]
        found = self.first_collisions(
            joint_paths(self.bubbles.frames, demonstration, one, q_start), one
        )
        if not found.collides[0]:
            return None
        bodies = self.workcell.colliding_bodies(found.q[0], one[0])
        return Hit(int(found.segment[0]), float(found.fraction[0]), bodies)

    def _bounds(self, q: Array, X_WO: Array) -> tuple[Array, Array]:
        """Which steps (N, m - 1) of paths (N, m, n) are not surely free, and their travel in m."""
        N, m, _ = q.shape
        uncertain, travel = np.zeros((N, m - 1), dtype=bool), np.zeros((N, m - 1))
        several = max(1, CHUNK // m)
        for first in range(0, N, several):
            some = slice(first, first + several)
            count = len(q[some])
            distance, p = self.bubbles(
                q[some].reshape(count * m, -1), np.repeat(X_WO[some], m, axis=0)
            )
            distance, p = distance.reshape(count, m, -1), p.reshape(count, m, -1, 3)
            moved = np.linalg.norm(np.diff(p, axis=1), axis=-1) + SLACK
            free = distance[:, 1:] + distance[:, :-1] > moved
            uncertain[some] = ~free.all(axis=-1)
            travel[some] = moved.max(axis=-1, initial=0.0)
        return uncertain, travel


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
        return self._checked(outcomes, demonstrations, X_WO, q_start)

    def any_success(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance until one demonstration succeeds; as `BatchPlanner.any_success`."""
        X_WO = np.asarray(X_WO, dtype=float)
        first = self.planner.any_success(demonstrations, X_WO, q_start)
        outcomes = self._checked(first, demonstrations, X_WO, q_start)
        again = np.flatnonzero((outcomes.cause == Cause.COLLISION).any(axis=-1))
        if len(again):
            every = self.all_outcomes(demonstrations, X_WO[again], q_start)
            for kept, found in zip(_arrays(outcomes), _arrays(every), strict=True):
                kept[again] = found
        return outcomes

    def _checked(
        self,
        outcomes: Outcomes,
        demonstrations: Sequence[Demonstration],
        X_WO: Array,
        q_start: ArrayLike,
    ) -> Outcomes:
        for i, demonstration in enumerate(demonstrations):
            rows = np.flatnonzero(outcomes.success[:, i])
            if len(rows) == 0:
                continue
            paths = joint_paths(self.checker.bubbles.frames, demonstration, X_WO[rows], q_start)
            found = self.checker.first_collisions(paths, X_WO[rows])
            hit = rows[found.collides]
            outcomes.cause[hit, i] = Cause.COLLISION
            outcomes.segment[hit, i] = found.segment[found.collides]
            outcomes.fraction[hit, i] = found.fraction[found.collides]
        return outcomes


def _arrays(outcomes: Outcomes) -> tuple[Array, ...]:
    return outcomes.cause, outcomes.segment, outcomes.joint, outcomes.fraction
