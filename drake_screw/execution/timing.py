"""When a plan is where: each screw segment gets a time law within joint limits.

The joint path turns a corner at each guiding pose, so each segment runs from rest to rest. Toppra
(Pham and Pham, IEEE Transactions on Robotics, 2018) gives its fastest law; a moving average over
`smoothing` seconds then makes the acceleration continuous. Toppra keeps the limits only at its grid
points: the smoothed law is checked between them and slowed down where it exceeds a limit.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike
from pydrake.multibody.optimization import Toppra
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RevoluteJoint, SpatialInertia
from pydrake.trajectories import PiecewisePolynomial

from drake_screw.planning import Plan
from drake_screw.robot import Arm
from drake_screw.screws import inverse, log
from drake_screw.screws.rotations import skew
from drake_screw.typing import Array

UNLIMITED = 1e3
"""rad/s (or m/s), put in place of an infinite velocity limit."""

FINE = 1e-3  # s, between points at which a time law is checked
EVERY = 4  # of them one is kept
GRIDS = (120, 127, 139, 151, 163)
"""Points along a segment at which Toppra keeps the limits. Now and then its arithmetic fails at one
of them, on a path that has a time law: then the next number is tried."""
RESERVE = 0.99  # part of the limits that Toppra may use
STILL = 1e-6  # rad, joint motion of a segment that does not move


@dataclass(frozen=True)
class TimeLimits:
    """How fast plans are executed.

    Attributes:
        speed: part of each joint's velocity limit that is used, 0 to 1.
        acceleration: rad/s^2 (m/s^2), of every joint.
        smoothing: s, over which the acceleration changes.
    """

    speed: float = 0.5
    acceleration: float = 2.0
    smoothing: float = 0.1


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
    """

    segments: tuple[TimedSegment, ...]

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

    def at(self, t: float) -> SetPoint:
        """The set point at time t, in s from the plan's start; it rests before and after."""
        left = max(t, 0.0)
        for i, piece in enumerate(self.segments):
            if left <= piece.duration or i + 1 == len(self.segments):
                break
            left -= piece.duration
        left = min(left, piece.duration)
        k = min(int(left / piece.period), len(piece.s) - 2)
        u = left / piece.period - k
        s, rate = _hermite(u, piece.period, piece.s, piece.rate, k)
        q, v = _hermite(u, piece.period, piece.q, piece.v, k)
        return SetPoint(i, float(s), float(rate), q, v)

    def sampled(self, period: float) -> tuple[Array, Array, Array]:
        """Times t (m,), joint path q (m, n) and velocities v (m, n), `period` seconds apart.

        The end is the last sample, which may lie closer to the one before.
        """
        whole = np.arange(0.0, self.duration - 1e-9, period)
        t = np.append(whole, self.duration)
        points = [self.at(float(time)) for time in t]
        return t, np.stack([p.q for p in points]), np.stack([p.v for p in points])


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
    return TimedPlan(tuple(pieces))


def _timed(
    X_WA: Array, X_WB: Array, s: Array, q: Array, arm: Arm, limits: TimeLimits
) -> TimedSegment:
    if np.ptp(q, axis=0).max() < STILL:
        ends = np.array([0.0, 1.0])
        still = np.zeros((2, arm.n))
        return TimedSegment(X_WA, X_WB, limits.smoothing, ends, 0.0 * ends, q[[0, -1]], still)
    velocity = limits.speed * np.minimum(arm.velocity_limits, UNLIMITED)
    acceleration = np.full(arm.n, limits.acceleration)
    path = _spline(s, q)
    slope, bend = path.derivative(1), path.derivative(2)
    law = _fastest(path, RESERVE * velocity, RESERVE * acceleration)
    s, rate, change = _smoothed(law, limits.smoothing)
    along = _values(slope, s)
    v = along * rate
    a = _values(bend, s) * rate**2 + along * change
    excess = np.max(np.abs(v) / velocity[:, None])
    excess = max(1.0, excess, np.sqrt(np.max(np.abs(a) / acceleration[:, None])))
    kept = slice(None, None, EVERY)
    period = excess * EVERY * FINE
    q = _values(path, s[kept]).T
    return TimedSegment(X_WA, X_WB, period, s[kept], rate[kept] / excess, q, v.T[kept] / excess)


def _smoothed(law: PiecewisePolynomial, window: float) -> tuple[Array, Array, Array]:
    """A time law averaged over a window: s, its rate and the rate's change (m,), FINE apart.

    The average of shifted copies of a law has the average of their derivatives.
    """
    width = max(1, round(window / FINE))
    last = int(np.ceil(law.end_time() / FINE)) + width
    last = EVERY * int(np.ceil(last / EVERY))
    t = FINE * np.arange(last + 1)
    within = np.minimum(t, law.end_time())
    moving = t <= law.end_time()
    box = np.full(width, 1.0 / width)
    s, rate, change = (
        np.convolve(values, box)[: last + 1]
        for values in (
            _values(law, within)[0],
            _values(law.derivative(1), within)[0] * moving,
            _values(law.derivative(2), within)[0] * moving,
        )
    )
    return np.clip(s, 0.0, 1.0), rate, change


def _spline(s: Array, q: Array) -> PiecewisePolynomial:
    """A twice differentiable path through points; those nearly in one place count once."""
    kept = np.concatenate([[True], (np.diff(s) > 1e-6) & (s[1:] < 1.0 - 1e-6)])
    s, q = np.append(s[kept], 1.0), np.concatenate([q[kept], q[-1:]])
    if len(s) < 5:
        even = np.linspace(0.0, 1.0, 5)
        s, q = even, np.stack([np.interp(even, s, angle) for angle in q.T], axis=-1)
    return PiecewisePolynomial.CubicWithContinuousSecondDerivatives(s, q.T)


def _fastest(
    path: PiecewisePolynomial, velocity: Array, acceleration: Array
) -> PiecewisePolynomial:
    for count in GRIDS:
        toppra = Toppra(path, _joints(len(velocity)), np.linspace(0.0, 1.0, count))
        toppra.AddJointVelocityLimit(-velocity, velocity)
        toppra.AddJointAccelerationLimit(-acceleration, acceleration)
        law = toppra.SolvePathParameterization()
        if law is not None:
            return law
    raise RuntimeError("Toppra found no time law for a path that starts and ends at rest")


@lru_cache
def _joints(n: int) -> MultibodyPlant:
    """A plant of n joints, of which Toppra asks only how many there are."""
    plant = MultibodyPlant(0.0)
    body = plant.world_body()
    for i in range(n):
        link = plant.AddRigidBody(f"link{i}", SpatialInertia.Zero())
        joint = RevoluteJoint(f"joint{i}", body.body_frame(), link.body_frame(), [0.0, 0.0, 1.0])
        plant.AddJoint(joint)
        body = link
    plant.Finalize()
    return plant


def _values(trajectory: PiecewisePolynomial, t: Array) -> Array:
    """(rows, m) values at times t (m,)."""
    return np.asarray(trajectory.vector_values(t))


def _hermite(u: float, h: float, x: Array, slope: Array, k: int) -> tuple[Array, Array]:
    """Value and derivative of the cubic through two samples with their slopes, at u in [0, 1]."""
    rise = x[k + 1] - x[k]
    left, right = h * slope[k], h * slope[k + 1]
    b, c = 3.0 * rise - 2.0 * left - right, left + right - 2.0 * rise
    return x[k] + u * (left + u * (b + u * c)), (left + u * (2.0 * b + 3.0 * u * c)) / h
