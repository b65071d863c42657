"""Collisions along plans: which of them touch something, and where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.planning.clearance import bubbles_of
from drake_screw.planning.outcomes import Plan
from drake_screw.robot import Workcell
from drake_screw.typing import Array

SPACING = 0.01
"""m, at most, that the arm moves between two configurations that Drake is asked about."""

SLACK = 2e-3
"""m, by which the way of a part of the arm between two points of a plan may be longer than the
straight line."""

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
        asked, step, share = self._in_doubt(q, X_WO, owner)
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

    def free(self, q: Array, X_WO: Array, coarse: float = 1.0) -> bool:
        """Whether a path touches nothing, its first point left aside.

        Args:
            q: (m, n) its points, near to one another as those of a plan.
            X_WO: (k, 4, 4) the objects.
            coarse: times SPACING is how far apart the configurations are that are asked about.
        """
        alone = np.zeros(len(q), dtype=int)
        asked, _, _ = self._in_doubt(q, X_WO[None], alone, coarse)
        unknown = np.ones(len(asked), dtype=bool)
        for every in (16, 4, 1):  # what collides does so over a stretch, most often
            some = np.flatnonzero(unknown[::every]) * every
            if self._collide(asked[some], X_WO).any():
                return False
            unknown[some] = False
        return True

    def _in_doubt(
        self, q: Array, X_WO: Array, owner: Array, coarse: float = 1.0
    ) -> tuple[Array, Array, Array]:
        """Configurations (p, n) that Drake is to be asked about, `coarse` times SPACING apart.

        Takes what `_bounds` does; also returns the step (p,) that each lies in, and how much of it
        is done there (p,), up to 1.
        """
        uncertain, travel = self._bounds(q, X_WO, owner)
        step = np.flatnonzero(uncertain)
        parts = np.maximum(np.ceil(travel[step] / (coarse * SPACING)).astype(int), 1)
        part = 1 + np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
        step, share = np.repeat(step, parts), part / np.repeat(parts, parts)
        return q[step] + share[:, None] * (q[step + 1] - q[step]), step, share

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
