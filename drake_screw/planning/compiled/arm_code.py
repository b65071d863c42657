"""The joint velocities of one arm along a constant screw, as expressions.

The minimum-norm joint velocities dq/ds = J^T (J J^T)^-1 V do not depend on the frame in which J and
V are expressed. The axes of the middle link are taken: there the two neighbouring joint axes are
constant, and the others are at most half an arm of rotations away. With fewer than six joints they
are (J^T J)^-1 J^T V instead, the least squares fit to the motion of the end effector's origin. With
more than six a motion away from the joint limits may be added that leaves the end effector alone.
Where the roll about the end effector's z axis is free, there are five directions instead of six.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from drake_screw.planning.compiled.expressions import Value, maximum, minimum, sqrt
from drake_screw.planning.compiled.functions import cos_sin
from drake_screw.planning.compiled.link_frames import LinkFrames
from drake_screw.planning.compiled.matrices import Factor, determinant
from drake_screw.planning.contract import CENTRING, FREE_PART, SOFTNESS, middle_and_half
from drake_screw.typing import Array

DAMPING = 1e-14
"""Added to the diagonal of J J^T or J^T J, where J's least singular value of 0.01 (see RATE_LIMIT)
does not feel it. An arm with more joints than directions to move in gets the velocities of least
norm."""

DAMPING_REDUNDANT = 1e-9
"""The same for J^T J if it is always singular: rounding errors of 1e-16 are divided by it."""


@dataclass(frozen=True)
class Pose:
    """A frame F seen from the middle link M: its axes, the columns of R_MF, and its origin p_MF."""

    R: Array = field(default_factory=lambda: np.eye(3).astype(object))
    p: Array = field(default_factory=lambda: np.zeros(3).astype(object))

    def turn_z(self, c: Value, s: Value) -> Pose:
        """After a turn about its own z axis, given by cos and sin."""
        x, y, z = self.R.T
        return replace(self, R=np.stack([c * x + s * y, c * y - s * x, z], axis=1))

    def turn_x(self, c: Value, s: Value) -> Pose:
        """After a turn about its own x axis, given by cos and sin."""
        x, y, z = self.R.T
        return replace(self, R=np.stack([x, c * y + s * z, c * z - s * y], axis=1))

    def move(self, d: Array) -> Pose:
        """After a shift by d (3,), in its own axes."""
        return replace(self, p=self.p + self.R @ d)


@dataclass(frozen=True)
class Kinematics:
    """An arm at one configuration: what its joint velocities depend on.

    Attributes:
        q: (n,) joint positions.
        base: P_0 = B in M.
        J: (6, n) Jacobian in M's axes, its columns twists [w; v] about `about`. Where the roll is
            free, (5, n): of w what is along `across`.
        about: (3,) point in M: M's origin, or with fewer than six joints, or where the roll is
            free, that of the end effector.
        factor: of J J^T, or with fewer joints than directions of J^T J; damped.
        limits: (2, n) lower and upper joint limits to move away from; None for none.
        across: (2, 3) where the roll is free, the end effector's x and y axis in M; else None.
    """

    q: Array
    base: Pose
    J: Array
    about: Array
    factor: Factor
    limits: Array | None = None
    across: Array | None = None

    def to_middle(self, V: Array) -> Array:
        """A twist (6,) in B about its origin, brought to M's axes and the point `about`.

        Where the roll is free, (5,): as much of it as is followed.
        """
        R, p = self.base.R, self.base.p
        w = R @ V[:3]
        moved = _shifted(np.concatenate([w, R @ V[3:] + np.cross(p, w)]), self.about)
        return _followed(moved, self.across)

    def joint_velocities(self, V: Array) -> Array:
        """dq/ds (n,) of a twist in M's axes about `about`: J^+ V, or J^+ (V - J z) + z."""
        least = self.minimum_norm(V)
        if self.limits is None:
            return least
        z = self._away_from_limits(least, self.limits)
        return least + z - self.minimum_norm(self.J @ z)

    def minimum_norm(self, V: Array) -> Array:
        """J^+ V (n,) of a twist in M's axes about `about`."""
        if len(self.q) < len(self.J):
            return self.factor.solve(self.J.T @ V)
        return self.J.T @ self.factor.solve(V)

    def _away_from_limits(self, least: Array, limits: Array) -> Array:
        """z (n,) as `contract.away_from_limits` has it, where J^+ V is `least` (n,)."""
        middle, half = middle_and_half(*limits.astype(float))
        x = (self.q - middle) * (1.0 / half)
        beyond = maximum(x - FREE_PART, 0.0) + minimum(x + FREE_PART, 0.0)
        pull = beyond / maximum(1.0 + SOFTNESS - x * x, SOFTNESS)
        return -CENTRING * sqrt(least @ least) * pull

    def residual(self, V: Array, velocities: Array) -> Value:
        """|V - J dq/ds|^2."""
        rest = V - self.J @ velocities
        return rest @ rest


def kinematics(
    frames: LinkFrames, q: Array, limits: Array | None = None, *, roll_free: bool = False
) -> tuple[Kinematics, Array]:
    """An arm at joint positions q (n,), and its X_BE as three rows (3, 4) of [R | p].

    Args:
        limits: (2, n) joint limits that more joints than directions are to move away from.
        roll_free: whether the roll about E's z axis is not followed.
    """
    directions = 5 if roll_free else 6
    n, few, X_CE = len(q), len(q) < directions, frames.X_CE
    base, links = link_poses(frames, q)
    R_ME, p_ME = links[-1].R @ X_CE[:3, :3], links[-1].move(X_CE[:3, 3]).p
    about = p_ME if few or roll_free else np.zeros(3)
    across = R_ME[:, :2].T if roll_free else None
    columns = [_twist(link, turns) for link, turns in zip(links, frames.revolute, strict=True)]
    J = _followed(_shifted(np.stack(columns, axis=1), about), across)
    gram = J.T @ J if few else J @ J.T
    damping = DAMPING_REDUNDANT if few and frames.redundant else DAMPING
    factor = Factor.of(gram + damping * np.eye(len(gram)))
    X_BE = base.R.T @ np.column_stack([R_ME, p_ME - base.p])
    return Kinematics(q, base, J, about, factor, limits if n > directions else None, across), X_BE


def link_poses(frames: LinkFrames, q: Array) -> tuple[Pose, list[Pose]]:
    """The base frame B and the frames C_0, ..., C_{n-1} of the links, seen from the middle link.

    A point that is fixed to link i at p_CP is at ``links[i].move(p_CP).p`` in M.
    """
    n, middle = len(q), frames.middle
    base, tip = Pose(), Pose()
    inward, outward = [], []
    for i in range(middle, n):
        tip = _across(frames, tip, i, q[i], 1.0)
        outward.append(tip)
        if i < n - 1:
            tip = tip.turn_x(*frames.tilt[i]).move(frames.shift[i])
    for i in reversed(range(middle)):
        c, s = frames.tilt[i]
        base = base.turn_x(c, -s).move(-frames.shift[i])
        inward.append(base)
        base = _across(frames, base, i, q[i], -1.0)
    return base, inward[::-1] + outward


def _across(frames: LinkFrames, pose: Pose, i: int, q: Value, direction: float) -> Pose:
    """From one side of joint i to the other: in direction 1 from P_i to C_i, in -1 back."""
    turn = frames.turn[i]
    if frames.revolute[i]:
        c, s = cos_sin(q + turn)
        return pose.turn_z(c, direction * s)
    moved = pose.move(np.array([0.0, 0.0, direction * q]))
    return moved.turn_z(np.cos(turn), direction * np.sin(turn))


def _twist(link: Pose, turns: bool) -> Array:
    """The twist (6,) about M's origin of a joint that turns about its link's z axis, or slides."""
    z = link.R[:, 2]
    return np.concatenate([z, np.cross(link.p, z)] if turns else [np.zeros(3), z])


def _shifted(V: Array, p: Array) -> Array:
    """Twists (6, ...) about another point: their linear parts are velocities at p (3,)."""
    w = V[:3]
    return np.concatenate([w, V[3:] + np.cross(w, p, axisa=0, axisc=0)])


def _followed(V: Array, across: Array | None) -> Array:
    """Of twists (6, ...) what is followed, (5, ...), or all of it if `across` is None."""
    return V if across is None else np.concatenate([across @ V[:3], V[3:]])


def orientation(J_before: Array, J_after: Array) -> Value:
    """det(J_before^T J_after) of Jacobians (d, n), n <= d.

    It is the inner product of the volumes that the columns span (Cauchy and Binet), which turns
    negative where a path passes through a singularity in between.
    """
    return determinant(J_before.T @ J_after)
