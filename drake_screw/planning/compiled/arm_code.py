"""Writes the joint rates of one arm along a constant screw as straight-line code.

The rates dq/ds = J^T (J J^T)^-1 xi do not depend on the frame in which J and xi are expressed. The
frame of the middle link is taken: there the two neighbouring joint axes are constant, and the
others are at most half an arm of rotations away. With fewer than six joints the rates are
(J^T J)^-1 J^T xi instead, the same wherever the arm can follow the screw at all.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.compiled.emitter import Emitter, Value, Vector
from drake_screw.planning.compiled.link_frames import LinkFrames

Array = NDArray[np.float64]

DETERMINANT_MIN = 1e-14
"""Determinants are held above this, so that a singular J gives huge rates and not infinite ones."""


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
        columns: n columns of J in M.
    """

    frames: LinkFrames
    e: Emitter
    base: Pose = field(default_factory=Pose)
    tip: Pose = field(default_factory=Pose)
    columns: list[list[Value]] = field(default_factory=list)

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
        self.columns = [columns[i] for i in range(n)]

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
        """A twist in B about its origin, brought to M."""
        e, base = self.e, self.base
        w_B, v_B = twist[:3], twist[3:]
        rows = list(zip(base.x, base.y, base.z, strict=True))
        w = [e.dot(row, w_B) for row in rows]
        moment = e.cross(base.p, w)
        v = [
            e.sum(*zip(row, v_B, strict=True), (1.0, k))
            for row, k in zip(rows, moment, strict=True)
        ]
        return [*w, *v]

    def gram(self) -> list[list[Value]]:
        """The lower triangle of J J^T, or with fewer than six joints of J^T J."""
        vectors = self.columns if len(self.columns) < 6 else list(zip(*self.columns, strict=True))
        return [[self.e.dot(a, b) for b in vectors[: i + 1]] for i, a in enumerate(vectors)]

    def pose_of_hand(self) -> list[Value]:
        """X_BE as three rows of [R | p]."""
        e, base, hand = self.e, self.base, Pose(self.tip.x, self.tip.y, self.tip.z, self.tip.p)
        X_CE = self.frames.X_CE
        axes = (hand.x, hand.y, hand.z)
        hand.move(e, *map(float, X_CE[:3, 3]))
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


@dataclass
class Factor:
    """A symmetric positive matrix [[P, Q], [Q^T, S]], ready to be solved with.

    P is of size 3 at most. Inverting it, and its complement S - Q^T P^-1 Q, by their cofactors
    takes more multiplications than L D L^T, but few divisions and no long chain of dependent steps.

    Attributes:
        first: P^-1, last: (S - Q^T P^-1 Q)^-1, bridge: P^-1 Q, coupling: Q^T.
    """

    first: list[list[Value]]
    last: list[list[Value]]
    bridge: list[list[Value]]
    coupling: list[list[Value]]

    @staticmethod
    def of(e: Emitter, A: list[list[Value]]) -> Factor:
        """Of a matrix given by its lower triangle."""
        k = min(3, len(A))
        first = inverse(e, A[:k])
        coupling = [row[:k] for row in A[k:]]
        bridge = [[e.dot(row, column) for column in coupling] for row in first]
        last = inverse(
            e,
            [
                [
                    e.sum((1.0, row[k + j]), *((-1.0, row[a], bridge[a][j]) for a in range(k)))
                    for j in range(i + 1)
                ]
                for i, row in enumerate(A[k:])
            ],
        )
        return Factor(first, last, bridge, coupling)

    def solve(self, e: Emitter, b: Vector) -> list[Value]:
        k = len(self.first)
        y = [e.dot(row, b[:k]) for row in self.first]
        rest = [
            e.sum((1.0, value), *((-1.0, q, yj) for q, yj in zip(row, y, strict=True)))
            for value, row in zip(b[k:], self.coupling, strict=True)
        ]
        x = [e.dot(row, rest) for row in self.last]
        head = [
            e.sum((1.0, value), *((-1.0, w, xj) for w, xj in zip(row, x, strict=True)))
            for value, row in zip(y, self.bridge, strict=True)
        ]
        return [*head, *x]


def inverse(e: Emitter, lower: list[list[Value]]) -> list[list[Value]]:
    """Inverse of a symmetric positive matrix of size 0 to 3, given by its lower triangle."""
    n = len(lower)
    A = [[lower[max(i, j)][min(i, j)] for j in range(n)] for i in range(n)]
    if n == 0:
        return []
    if n == 1:
        cofactors: list[list[Value]] = [[1.0]]
    elif n == 2:
        cofactors = [[A[1][1], e.sum((-1.0, A[1][0]))], [e.sum((-1.0, A[1][0])), A[0][0]]]
    else:
        cofactors = [[0.0] * 3 for _ in range(3)]
        for i in range(3):
            for j in range(i + 1):
                (a, b), (c, d) = ((i + 1) % 3, (i + 2) % 3), ((j + 1) % 3, (j + 2) % 3)
                minor = e.sum((A[a][c], A[b][d]), (-1.0, A[a][d], A[b][c]))
                cofactors[i][j] = cofactors[j][i] = minor
    determinant = e.dot(A[0], cofactors[0])
    scale = e.let(f"1.0 / max({determinant}, {DETERMINANT_MIN})")
    return [[e.sum((scale, c)) for c in row] for row in cofactors]


def joint_rates(
    e: Emitter, columns: list[list[Value]], factor: Factor, twist: Vector
) -> list[Value]:
    """J^+ twist, all in M."""
    if len(columns) < 6:
        return factor.solve(e, [e.dot(column, twist) for column in columns])
    force = factor.solve(e, twist)
    return [e.dot(column, force) for column in columns]


def cos_sin(e: Emitter, angle: Value) -> tuple[Value, Value]:
    """cos and sin of any angle to 1e-14: polynomials on half the angle within a half turn of 0."""
    turns = e.let(f"floor({angle} * {1.0 / (2.0 * np.pi)!r} + 0.5)")
    half = e.let(f"0.5 * {angle} - {np.pi!r} * {turns}")
    square = e.sum((half, half))
    quotient = e.polynomial(str(square), _SIN)
    sine = e.sum((half, quotient))
    cosine = e.polynomial(str(square), _COS)
    return e.let(f"1.0 - 2.0*{sine}*{sine}"), e.sum((2.0, sine, cosine))


def fit(f: Callable[[Array], Array], degree: int, end: float) -> list[float]:
    """Coefficients of the Chebyshev interpolant of f on [0, end]."""
    fit = np.polynomial.Chebyshev.interpolate(f, degree, domain=[0.0, end])
    return [float(c) for c in fit.convert(kind=np.polynomial.Polynomial).coef]


_SIN = fit(lambda x: np.sinc(np.sqrt(x) / np.pi), 6, (np.pi / 2) ** 2)
_COS = fit(lambda x: np.cos(np.sqrt(x)), 7, (np.pi / 2) ** 2)
