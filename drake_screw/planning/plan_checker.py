"""Collisions along plans: which of them touch something, and where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.planning.compiled import Check, Touches, Trace
from drake_screw.planning.outcomes import Plan
from drake_screw.planning.swept import SweptChecker, Touched, lines, straight_steps
from drake_screw.robot import Workcell
from drake_screw.typing import Array

FAR = 0.1
"""m, beyond which it does not matter how far away things are."""


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


class PlanChecker:
    """Finds the collisions of plans in a workcell, all along them: see `planning.swept`.

    Args:
        workcell: robot, table and objects.
        clearance: m, that they have to keep.
    """

    def __init__(self, workcell: Workcell, clearance: float = 0.0) -> None:
        self.workcell = workcell
        self.swept = SweptChecker(workcell, clearance)

    @property
    def asked(self) -> int:
        """Configurations that Drake was asked about so far."""
        return self.swept.asked

    def first_collisions(self, plans: Sequence[Plan], X_WO: ArrayLike) -> Collisions:
        """Check plans.

        Args:
            plans: N of the batch planner's.
            X_WO: (N, k, 4, 4) the objects of each.
        """
        N, n = len(plans), self.workcell.arm.n
        if N == 0:
            none = np.zeros(0)
            return Collisions(none.astype(bool), none.astype(int), none, np.zeros((0, n)))
        return _collisions(plans, self._along([p.q for p in plans], np.asarray(X_WO, dtype=float)))

    def free(self, q: Array, X_WO: Array) -> bool:
        """Whether a path touches nothing.

        Args:
            q: (m, n) its points; straight lines connect them.
            X_WO: (k, 4, 4) the objects.
        """
        return not bool(self._along([q], X_WO[None]).touches[0])

    def clearance(self, plan: Plan, X_WO: ArrayLike) -> float:
        """How far in m a plan stays from touching anything, as far as FAR; X_WO (k, 4, 4)."""
        return self.swept.distance_along(lines(plan.q), np.asarray(X_WO, dtype=float), FAR)

    def _along(self, paths: Sequence[Array], X_WO: Array) -> Touched:
        steps = [lines(q) for q in paths]
        first = np.cumsum([0, *map(len, steps)], dtype=np.int64)
        return self.swept.along(np.concatenate(steps), first, X_WO)


def _collisions(plans: Sequence[Plan], found: Touched) -> Collisions:
    """The first touches of plans, as places in their segments."""
    segment, fraction = np.full(len(plans), -1), np.ones(len(plans))
    for i in np.flatnonzero(found.touches).tolist():
        plan, step = plans[i], int(found.step[i])
        end = min(step + 1, len(plan.q) - 1)
        began = plan.s[step] if plan.segment[step] == plan.segment[end] else 0.0
        segment[i] = plan.segment[end]
        fraction[i] = began + found.place[i] * (plan.s[end] - began)
    return Collisions(found.touches, segment, fraction, found.q)


def check_of(
    checker: SweptChecker | None, begins: NDArray[np.int64], q_start: Array
) -> Check | None:
    """A checker of plans for the kernel.

    Args:
        checker: of the workcell; None for none.
        begins: (C,) the configuration that each column begins at; 0 for the arm's start, from which
            the others' first guiding poses are approached along a straight line in joint space.
        q_start: (n,) rad or m, the arm's start.
    """

    if checker is None:
        return None

    def check(X_WO: Array, trace: Trace) -> Touches:
        instance, column = trace.plan.T
        q, s, segment, first = trace.q, trace.s, trace.segment, trace.first
        away = begins[column] > 0
        if away.any():
            owner = np.repeat(np.arange(len(away)), np.diff(first))
            to_come = away[owner] & (segment == 0)
            ends = np.append((owner[1:] != owner[:-1]) | (segment[1:] != 0), True)
            approach, kept = to_come & ends, ~to_come | ends
            q, s = q.copy(), s.copy()
            there = q[approach, 1]
            q[approach] = straight_steps(np.broadcast_to(q_start, there.shape), there)
            s[approach] = 0.0, 1.0
            q, s, segment = q[kept], s[kept], segment[kept]
            first = np.concatenate([[0], np.cumsum(np.bincount(owner[kept], minlength=len(away)))])
        found = checker.along(q, first, X_WO[instance])
        step = first[:-1] + np.maximum(found.step, 0)
        fraction = s[step, 0] + found.place * (s[step, 1] - s[step, 0])
        return Touches(found.touches, segment[step], fraction, found.pair)

    return check
