"""When a plan is where: each screw segment gets a time law within joint limits.

The joint path turns a corner at each guiding pose, so each segment runs from rest to rest, by its
own `smooth_law`.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.execution.smooth_law import smooth_law, spline
from drake_screw.execution.status import ExecutionStatus
from drake_screw.planning import Plan
from drake_screw.robot import Arm
from drake_screw.screws import inverse, log
from drake_screw.screws.rotations import skew
from drake_screw.typing import Array

STILL = 1e-6  # rad, joint motion of a segment that does not move


@dataclass(frozen=True)
class TimeLimits:
    """How fast plans are executed.

    Attributes:
        speed: part of each joint's velocity limit that is used, 0 to 1.
        acceleration: rad/s^2, of every revolute joint.
        smoothing: s, over which the acceleration changes.
        slide_acceleration: m/s^2, of every prismatic one.
    """

    speed: float = 0.5
    acceleration: float = 2.0
    smoothing: float = 0.1
    slide_acceleration: float = 0.5

    def accelerations(self, arm: Arm) -> Array:
        """(n,) rad/s^2 or m/s^2, of an arm's joints."""
        return np.where(arm.slides, self.slide_acceleration, self.acceleration)


@dataclass(frozen=True, eq=False)
class TimedSegment:
    """One segment, a constant screw as a rule, with its time law, sampled evenly from rest to rest.

    Attributes:
        X_WA, X_WB: (4, 4) where the end effector starts and ends.
        period: s between samples.
        s, rate: (m,) fraction of the screw done, and its time derivative in 1/s.
        q, v: (m, n) the planned joint path, rad, and its time derivative.
        screw: whether the end effector follows a screw; a free approach follows its joint path.
    """

    X_WA: Array
    X_WB: Array
    period: float
    s: Array
    rate: Array
    q: Array
    v: Array
    screw: bool = True

    @property
    def duration(self) -> float:
        """Length in s."""
        return self.period * (len(self.s) - 1)

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """s and rate (...), q and v (..., n) at times t (...) from 0 to the duration."""
        part = t / self.period
        k = np.minimum(part.astype(np.int64), len(self.s) - 2)
        u = part - k
        s, rate = _hermite(u, self.period, self.s, self.rate, k)
        q, v = _hermite(u[..., None], self.period, self.q, self.v, k)
        return s, rate, q, v

    @cached_property
    def twist(self) -> Array:
        """(6,) [w; v] about W's origin: the end effector's twist, constant but for the rate."""
        return log(self.X_WB @ inverse(self.X_WA))

    def pose(self, s: float) -> Array:
        """(4, 4) X_WE on the constant screw at fraction s; quicker than `exp` for one pose."""
        size, S, S2, S3 = self._powers
        turned = s * size
        versine = 2.0 * math.sin(turned / 2.0) ** 2
        motion = np.eye(4) + turned * S + versine * S2 + (turned - math.sin(turned)) * S3
        return np.asarray(motion @ self.X_WA)

    @cached_property
    def _powers(self) -> tuple[float, Array, Array, Array]:
        """The twist's size, and the first powers of the unit twist as a matrix."""
        turn, shift = np.linalg.norm(self.twist[:3]), np.linalg.norm(self.twist[3:])
        size = float(turn if turn > 1e-9 else shift)
        S = np.zeros((4, 4))
        if size > 0.0:
            S[:3, :3], S[:3, 3] = skew(self.twist[:3] / size), self.twist[3:] / size
        if turn <= 1e-9:
            S[:3, :3] = 0.0
        return size, S, S @ S, S @ S @ S


@dataclass(frozen=True, eq=False)
class SetPoint:
    """Where a plan is at one time: segment, fraction s of it and its rate, joint path q and v."""

    segment: int
    s: float
    rate: float
    q: Array
    v: Array


@dataclass(frozen=True, eq=False)
class TimedPlan:
    """A plan that knows when. It never changes, so copies are the plan itself.

    Attributes:
        segments: in their order; none for an empty plan.
        free_axis: (3,) in the end effector's frame, about which its roll is free: of the screws it
            follows position and that axis. None where it follows them as a whole.
        begins: s, the time at which it is to be followed, with the plan before it until then; None
            for at once.
        ending: the status that it ends with whatever it arrives at, of a motion that only brings
            the arm to rest. None where it is done on arrival.
    """

    segments: tuple[TimedSegment, ...]
    free_axis: Array | None = None
    begins: float | None = None
    ending: ExecutionStatus | None = None

    def __deepcopy__(self, _: object) -> TimedPlan:
        return self

    @cached_property
    def duration(self) -> float:
        """Length in s."""
        return float(sum(piece.duration for piece in self.segments))

    @property
    def poses(self) -> Array:
        """(g + 1, 4, 4) X_WE at the start and at the guiding poses."""
        return np.stack([self.segments[0].X_WA, *(piece.X_WB for piece in self.segments)])

    def moved(self, poses: ArrayLike) -> TimedPlan:
        """The plan along other screws at the same times; joint paths stay as they are.

        Args:
            poses: (g + 1, 4, 4) X_WE, in place of `poses`.
        """
        ends = itertools.pairwise(np.asarray(poses, dtype=float))
        pieces = zip(self.segments, ends, strict=True)
        return replace(self, segments=tuple(replace(p, X_WA=A, X_WB=B) for p, (A, B) in pieces))

    def at(self, t: float) -> SetPoint:
        """The set point at time t, in s from the plan's start; it rests before and after."""
        left = max(t, 0.0)
        for i, piece in enumerate(self.segments):
            if left <= piece.duration or i + 1 == len(self.segments):
                break
            left -= piece.duration
        s, rate, q, v = piece.at(np.array(min(left, piece.duration)))
        return SetPoint(i, float(s), float(rate), q, v)

    def end_of_segment(self, t: float) -> float:
        """When the segment that the plan is in at time t ends, in s from the plan's start."""
        ends = np.cumsum([piece.duration for piece in self.segments])
        return float(ends[min(int(np.searchsorted(ends, t)), len(ends) - 1)])

    def shown(self, segment: int) -> int | None:
        """The segment that an execution is said to be in: of one that is being ended, where."""
        return segment if self.ending is None else self.ending.segment

    def sampled(self, period: float) -> tuple[Array, Array, Array]:
        """Times t (m,), joint path q (m, n) and velocities v (m, n), `period` seconds apart.

        The end is the last sample, which may lie closer to the one before.
        """
        whole = np.arange(0.0, self.duration - 1e-9, period)
        t = np.append(whole, self.duration)
        return t, *self.path(t)

    def path(self, t: Array) -> tuple[Array, Array]:
        """Joint path q (m, n) and velocities v (m, n) at ascending times t (m,) in s.

        Before and after the plan the arm rests.
        """
        begins = np.cumsum([0.0, *(piece.duration for piece in self.segments)])
        number = np.clip(np.searchsorted(begins, t) - 1, 0, len(self.segments) - 1)
        parts = [
            piece.at(np.clip(t[number == i] - begins[i], 0.0, piece.duration))
            for i, piece in enumerate(self.segments)
        ]
        q, v = (np.concatenate([part[k] for part in parts]) for k in (2, 3))
        return q, v


def time_plan(
    plan: Plan, poses: ArrayLike, arm: Arm, limits: TimeLimits | None = None
) -> TimedPlan:
    """Give a plan its time law.

    Args:
        plan: one that succeeded.
        poses: (g + 1, 4, 4) X_WE of the start, then the guiding poses.
        arm: whose velocity limits hold.
        limits: how fast.

    Returns:
        The timed plan; without segments if the plan has none.
    """
    limits = limits or TimeLimits()
    poses = np.asarray(poses, dtype=float)
    pieces = []
    start = plan.q[0]
    for i, (X_WA, X_WB) in enumerate(itertools.pairwise(poses)):
        inside = (plan.segment == i) & (plan.s > 0.0)
        q = np.concatenate([start[None], plan.q[inside]])
        s = np.concatenate([[0.0], plan.s[inside]])
        piece = _timed(X_WA, X_WB, s, q, arm, limits)
        pieces.append(replace(piece, screw=i > 0 or not plan.approach))
        start = q[-1]
    return TimedPlan(tuple(pieces), plan.free_axis)


def _timed(
    X_WA: Array, X_WB: Array, s: Array, q: Array, arm: Arm, limits: TimeLimits
) -> TimedSegment:
    if np.ptp(q, axis=0).max() < STILL:
        ends = np.array([0.0, 1.0])
        still = np.zeros((2, arm.n))
        return TimedSegment(X_WA, X_WB, limits.smoothing, ends, 0.0 * ends, q[[0, -1]], still)
    velocity = limits.speed * arm.velocity_limits
    law = smooth_law(spline(s, q), velocity, limits.accelerations(arm), limits.smoothing)
    return TimedSegment(X_WA, X_WB, law.period, law.s, law.rate, law.q, law.v)


def _hermite(u: Array, h: float, x: Array, slope: Array, k: Array) -> tuple[Array, Array]:
    """Value and derivative of the cubic from sample k to the next, at u in [0, 1] of the way."""
    rise = x[k + 1] - x[k]
    left, right = h * slope[k], h * slope[k + 1]
    b, c = 3.0 * rise - 2.0 * left - right, left + right - 2.0 * rise
    return x[k] + u * (left + u * (b + u * c)), (left + u * (2.0 * b + 3.0 * u * c)) / h
