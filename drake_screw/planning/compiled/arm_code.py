"""Writes the joint rates of one arm along a constant screw as straight-line code.

The rates dq/ds = J^T (J J^T)^-1 V do not depend on the frame in which J and V are expressed. The
axes of the middle link are taken: there the two neighbouring joint axes are constant, and the
others are at most half an arm of rotations away. With fewer than six joints the rates are
(J^T J)^-1 J^T V instead, the least squares fit to the motion of the hand's origin.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from drake_screw.planning.compiled.emitter import Emitter, Value, Vector
from drake_screw.planning.compiled.functions import cos_sin
from drake_screw.planning.compiled.link_frames import LinkFrames
from drake_screw.planning.compiled.matrices import Factor, determinant

DAMPING = 1e-14
"""Added to the diagonal of J J^T or J^T J, where J's least singular value of 0.01 (see RATE_LIMIT)
does not feel it. An arm with more joints than directions to move in gets its least rates."""

DAMPING_REDUNDANT = 1e-9
"""The same for J^T J if it is always singular: rounding errors of 1e-16 are divided by it."""


@dataclass
class Pose:
    """A frame F seen from the middle link M: its axes, and its origin p_MF, as code."""

    x: Vector = (1.0, 0.0, 0.0)
    y: Vector = (0.0, 1.0, 0.0)
    z: Vector = (0.0, 0.0, 1.0)
    p: Vector = (0.0, 0.0, 0.0)

    def turn_z(self, e: Emitter, c: Value, s: Value) -> None:
        x, y = self.x, self.y
        self.x = e.combine(c, x, s, y)
        self.y = [e.sum((c, yi), (-1.0, s, xi)) for xi, yi in zip(x, y, strict=True)]

    def turn_x(self, e: Emitter, c: float, s: float) -> None:
        y, z = self.y, self.z
        self.y = e.combine(c, y, s, z)
        self.z = e.combine(-s, y, c, z)

    def move(self, e: Emitter, x: Value, y: Value, z: Value) -> None:
        self.p = [
            e.sum((1.0, p), (x, a), (y, b), (z, c))
            for p, a, b, c in zip(self.p, self.x, self.y, self.z, strict=True)
        ]


@dataclass
class ArmCode:
    """Code of one arm at one configuration, written into an emitter.

    Attributes:
        base, tip: P_0 = B and C_{n-1} in M, once `walk` is done.
        columns: n columns of J in M's axes.
        about: the point in M that J's columns, as twists, are about: M's origin, or with fewer than
            six joints the hand's.
    """

    frames: LinkFrames
    e: Emitter
    base: Pose = field(default_factory=Pose)
    tip: Pose = field(default_factory=Pose)
    columns: list[list[Value]] = field(default_factory=list)
    about: Vector = (0.0, 0.0, 0.0)

    def walk(self, q_row: int) -> None:
        """Forward kinematics from the middle link to both ends, and the Jacobian on the way."""
        f, e, m = self.frames, self.e, self.frames.middle
        n = len(f.revolute)
        columns: dict[int, list[Value]] = {}
        for i in range(m, n):
            columns[i] = self._column(self.tip, i)
            self._joint(self.tip, i, q_row, 1.0)
            if i < n - 1:
                self.tip.turn_x(e, *map(float, f.tilt[i]))
                self.tip.move(e, *map(float, f.shift[i]))
        for i in range(m - 1, -1, -1):
            c, s = map(float, f.tilt[i])
            self.base.turn_x(e, c, -s)
            self.base.move(e, *map(float, -f.shift[i]))
            columns[i] = self._column(self.base, i)
            self._joint(self.base, i, q_row, -1.0)
        if n < 6:
            self.about = self._hand().p
        self.columns = [self._moved(columns[i]) for i in range(n)]

    def _moved(self, twist: Vector) -> list[Value]:
        """A twist about M's origin as the twist about the point `about`."""
        drag = self.e.cross(twist[:3], self.about)
        return [*twist[:3], *(self.e.sum((v,), (d,)) for v, d in zip(twist[3:], drag, strict=True))]

    def _hand(self) -> Pose:
        """C_{n-1}'s axes at the origin of E, in M."""
        hand = Pose(self.tip.x, self.tip.y, self.tip.z, self.tip.p)
        hand.move(self.e, *map(float, self.frames.X_CE[:3, 3]))
        return hand

    def _column(self, axis: Pose, i: int) -> list[Value]:
        if not self.frames.revolute[i]:
            return [0.0, 0.0, 0.0, *axis.z]
        return [*axis.z, *self.e.cross(axis.p, axis.z)]

    def _joint(self, pose: Pose, i: int, q_row: int, direction: float) -> None:
        e, turn = self.e, float(self.frames.turn[i])
        q = e.load(q_row + i)
        c: Value
        s: Value
        if self.frames.revolute[i]:
            c, s = cos_sin(e, e.sum((q,), (turn,)))
        else:
            c, s = float(np.cos(turn)), float(np.sin(turn))
        if not self.frames.revolute[i]:
            pose.move(e, 0.0, 0.0, e.sum((direction, q)))
        pose.turn_z(e, c, e.sum((direction, s)))

    def to_middle(self, twist: Vector) -> list[Value]:
        """A twist in B about its origin, brought to M's axes and the point `about`."""
        e, base = self.e, self.base
        w_B, v_B = twist[:3], twist[3:]
        rows = list(zip(base.x, base.y, base.z, strict=True))
        w = [e.dot(row, w_B) for row in rows]
        moment = e.cross(base.p, w)
        v = [
            e.sum(*zip(row, v_B, strict=True), (1.0, k))
            for row, k in zip(rows, moment, strict=True)
        ]
        return self._moved([*w, *v])

    def gram(self) -> list[list[Value]]:
        """The lower triangle of J J^T, or with fewer than six joints of J^T J; damped."""
        vectors = self.columns if len(self.columns) < 6 else list(zip(*self.columns, strict=True))
        products = [
            [list(zip(a, b, strict=True)) for b in vectors[: i + 1]] for i, a in enumerate(vectors)
        ]
        few = len(self.columns) < 6
        damping = DAMPING_REDUNDANT if few and self.frames.redundant else DAMPING
        for row in products:
            row[-1].append((1.0, damping))
        return [[self.e.sum(*terms) for terms in row] for row in products]

    def pose_of_hand(self) -> list[Value]:
        """X_BE as three rows of [R | p]."""
        e, base, hand = self.e, self.base, self._hand()
        X_CE = self.frames.X_CE
        axes = (hand.x, hand.y, hand.z)
        R_ME = [
            [e.sum(*((float(X_CE[k, j]), axes[k][i]) for k in range(3))) for j in range(3)]
            for i in range(3)
        ]
        p_BE_M = e.combine(1.0, hand.p, -1.0, base.p)
        rows = []
        for axis in (base.x, base.y, base.z):
            rows += [e.dot(axis, [R_ME[k][j] for k in range(3)]) for j in range(3)]
            rows.append(e.dot(axis, p_BE_M))
        return rows


def joint_rates(
    e: Emitter, columns: list[list[Value]], factor: Factor, twist: Vector
) -> list[Value]:
    """J^+ twist."""
    if len(columns) < 6:
        return factor.solve(e, [e.dot(column, twist) for column in columns])
    force = factor.solve(e, twist)
    return [e.dot(column, force) for column in columns]


def residual(e: Emitter, columns: list[list[Value]], rates: Vector, twist: Vector) -> Value:
    """|twist - J rates|^2."""
    rest = [
        e.sum(
            (1.0, v),
            *((-1.0, column[k], rate) for column, rate in zip(columns, rates, strict=True)),
        )
        for k, v in enumerate(twist)
    ]
    return e.dot(rest, rest)


def orientation(e: Emitter, before: list[list[Value]], after: list[list[Value]]) -> Value:
    """det(J_before^T J_after), of at most six joints.

    It is the inner product of the volumes that the columns span (Cauchy and Binet), which turns
    negative where a path passes through a singularity in between.
    """
    return determinant(e, [[e.dot(a, b) for b in after] for a in before])
