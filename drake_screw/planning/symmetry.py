"""What a task leaves free: bodies that look the same after a turn about their axis.

Where an object is symmetric, guiding poses that belong to it may be turned with it about its axis:
what they do to the object is the same. Where what the hand holds is symmetric, the end effector may
be turned about the tool's axis at all guiding poses alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.robot import ScrewChain
from drake_screw.screws import inverse, pose, skew
from drake_screw.screws.rotations import cross
from drake_screw.tasks import Symmetry
from drake_screw.typing import Array

TRIED = 24
"""Turns that are tried of a body that may be turned by any angle."""


TOOL = "tool"
"""What the end effector holds goes by that name."""


@dataclass(frozen=True, eq=False)
class Turned:
    """A symmetric body as a plan turns it.

    Attributes:
        body: name of the object, or TOOL.
        angle: rad, about its axis, from where it stands in the instance; in (-pi, pi].
        X_FT: (4, 4) T turns with the body: its z axis is that of the symmetry, and at an angle of
            0 its x axis is across it. F is the world, or of the tool the end effector.
    """

    body: str
    angle: float
    X_FT: Array

    def __str__(self) -> str:
        degrees = f"{np.degrees(self.angle):+.0f}°".replace("-", "−")
        return f"the {self.body} turned by {degrees}"


@dataclass(frozen=True, eq=False)
class Symmetries:
    """The symmetry of every object and of the tool, and which turns are tried in which order.

    The turn of an object that is tried first makes of the recorded motion, as nearly as the
    symmetry allows, the one that swings it about the arm's first joint: from where the
    object stood, seen from there, to where it stands now. After that come turns to both sides, the
    smaller ones first. The tool is tried as recorded first. Several bodies turn independently.

    Attributes:
        objects: of each of the k objects, None where it has none; () where no object has any.
        tool: of what the end effector holds.
        X_ET: (4, 4) the tool's frame in the end effector's.
        tried: turns of a body that may be turned by any angle.
        swing: (6,) [w; v] the first joint's screw in W, if it is revolute.
    """

    objects: tuple[Symmetry | None, ...] = ()
    tool: Symmetry | None = None
    X_ET: Array = field(default_factory=lambda: np.eye(4))
    tried: int = TRIED
    swing: Array | None = None

    @staticmethod
    def of(
        chain: ScrewChain,
        objects: Sequence[Symmetry | None],
        tool: Symmetry | None = None,
        X_ET: ArrayLike | None = None,
        tried: int = TRIED,
    ) -> Symmetries:
        """Those of a task for an arm; arguments as the attributes."""
        turns = bool(np.linalg.norm(chain.screws[0, :3]) > 0.5)
        frame = np.eye(4) if X_ET is None else np.asarray(X_ET, dtype=float)
        swing = chain.screws[0] if turns else None
        return Symmetries(tuple(objects), tool, frame, tried, swing)

    def bodies(self, demonstration: Demonstration) -> tuple[int, ...]:
        """Symmetric bodies that a demonstration may turn: objects it works on; -1, the tool."""
        owners = sorted(set(demonstration.objects.tolist()))
        turning = [i for i in owners if i < len(self.objects) and self.objects[i] is not None]
        return (*turning, *([] if self.tool is None else [-1]))

    def count(self, demonstration: Demonstration) -> int:
        """How many turns are tried with a demonstration; 1 where there is nothing to turn."""
        return int(np.prod([self._of(b).tried(self.tried) for b in self.bodies(demonstration)]))

    def away(self, demonstration: Demonstration, k: int) -> Array:
        """(T, k + 1) rad: the turns of each object and the tool, from the one tried first."""
        bodies = self.bodies(demonstration)
        steps = [_both_sides(self._of(body).tried(self.tried)) for body in bodies]
        angles = np.array(list(product(*steps))).reshape(self.count(demonstration), len(bodies))
        order = np.argsort(np.round(np.abs(angles).sum(axis=1), 9), kind="stable")
        found = np.zeros((len(angles), k + 1))
        found[:, list(bodies)] = angles[order]
        return found

    def first(self, demonstration: Demonstration, X_WO: ArrayLike) -> Array:
        """The turns that are tried first, (..., k + 1) rad, for objects X_WO (..., k, 4, 4)."""
        X_WO = np.asarray(X_WO, dtype=float)
        angles = np.zeros((*X_WO.shape[:-3], X_WO.shape[-3] + 1))
        for body in self.bodies(demonstration):
            if body >= 0:
                X, there = X_WO[..., body, :, :], demonstration.X_WO[body]
                angles[..., body] = self._swung(self._of(body), there, X)
        return angles

    def angles(self, demonstration: Demonstration, X_WO: ArrayLike, turn: ArrayLike = 0) -> Array:
        """By how much every body is turned.

        Args:
            demonstration: that is carried over.
            X_WO: (..., k, 4, 4).
            turn: (...) its number in the order in which turns are tried, from 0, and over again.

        Returns:
            (..., k + 1) rad, of each object, and last of the tool; 0 for what is not symmetric.
        """
        first = self.first(demonstration, X_WO)
        away = self.away(demonstration, first.shape[-1] - 1)
        return first + away[np.asarray(turn) % len(away)]

    def guides(self, demonstration: Demonstration, X_WO: ArrayLike, angles: ArrayLike) -> Array:
        """Guiding poses of a demonstration whose bodies are turned.

        Args:
            demonstration: that is carried over.
            X_WO: (..., k, 4, 4).
            angles: (..., k + 1) rad, as `angles` has them.

        Returns:
            X_WE: (..., g, 4, 4).
        """
        angles = np.asarray(angles, dtype=float)
        if not angles.any():
            return demonstration.transfer(X_WO)
        turned = self.turned(X_WO, angles[..., :-1])
        return demonstration.transfer(turned) @ self._of_tool(angles[..., -1])[..., None, :, :]

    def named(
        self,
        demonstration: Demonstration,
        X_WO: Array,
        angles: Array,
        names: Sequence[str],
    ) -> tuple[Turned, ...]:
        """How each symmetric body is turned.

        Args:
            demonstration: that is carried over.
            X_WO: (k, 4, 4) the objects.
            angles: (k + 1,) rad, as `angles` has them.
            names: of the k objects.
        """
        found = []
        for body in self.bodies(demonstration):
            symmetry, X_FB = self._of(body), self.X_ET if body < 0 else X_WO[body]
            axes = np.stack([*_plane(np.array(symmetry.axis)), symmetry.axis], axis=-1)
            angle = float(-np.remainder(np.pi - angles[body], 2.0 * np.pi) + np.pi)
            turn = _turns(np.array(symmetry.axis), np.array(angle))
            name = TOOL if body < 0 else names[body]
            found.append(Turned(name, angle, X_FB @ turn @ pose(axes, np.zeros(3))))
        return tuple(found)

    def turned(self, X_WO: ArrayLike, angles: ArrayLike) -> Array:
        """Object poses (..., k, 4, 4), each turned by an angle (..., k) in rad about its axis."""
        axes = np.array([(0.0, 0.0, 0.0) if s is None else s.axis for s in self.objects])
        axes = np.zeros((np.shape(X_WO)[-3], 3)) if len(axes) == 0 else axes
        return np.asarray(X_WO, dtype=float) @ _turns(axes, np.asarray(angles, dtype=float))

    def variants(self, demonstration: Demonstration, k: int) -> Array:
        """(T, g, 4, 4) guiding poses for every turn, in the frames of objects turned by `first`."""
        away = self.away(demonstration, k)
        X_OO = self.turned(np.broadcast_to(np.eye(4), (len(away), k, 4, 4)), away[:, :-1])
        turned = X_OO[:, demonstration.objects] @ demonstration.X_OE
        return turned @ self._of_tool(away[:, -1])[:, None]

    def _of(self, body: int) -> Symmetry:
        found = self.tool if body < 0 else self.objects[body]
        assert found is not None
        return found

    def _of_tool(self, angle: Array) -> Array:
        """(..., 4, 4) how the end effector moves in its own frame as the tool is turned."""
        axis = np.zeros(3) if self.tool is None else np.array(self.tool.axis)
        return self.X_ET @ _turns(axis, angle) @ inverse(self.X_ET)

    def _swung(self, symmetry: Symmetry, there: Array, X_WO: Array) -> Array:
        """The turn (...) of an object at X_WO (..., 4, 4) nearest to the recorded motion, swung.

        Of the turns R(a, angle) it is the one with the largest trace of R(a, angle)^T M, where
        M = R_WO^T R_swing R_WO' turns the object as the swing does; only what M does to the plane
        normal to the axis a counts.
        """
        plane = _plane(np.array(symmetry.axis))
        before, now = there[:3, :3] @ plane.T, X_WO[..., :3, :3] @ plane.T
        swung = [before[:, i] for i in range(2)]
        if self.swing is not None:
            w = self.swing[:3]
            centre = cross(w, self.swing[3:])
            swing = _angle(w, there[:3, 3] - centre, X_WO[..., :3, 3] - centre)
            swung = [_rotated(w, swing, u) for u in swung]
        M = [[(now[..., i] * u).sum(axis=-1) for u in swung] for i in range(2)]
        angle = np.arctan2(M[1][0] - M[0][1], M[0][0] + M[1][1])
        if symmetry.turns is None:
            return np.asarray(angle)
        one = 2.0 * np.pi / symmetry.turns
        return np.asarray(np.round(angle / one) * one)


def _both_sides(count: int) -> NDArray[np.float64]:
    """0, then equal steps of a full turn, one to either side, two to either side, ..."""
    number = np.arange(count)
    steps = (number + 1) // 2 * np.where(number % 2 == 1, 1, -1)
    return np.asarray(steps * (2.0 * np.pi / count), dtype=float)


def _turns(axis: Array, angle: Array) -> Array:
    """Motions (..., 4, 4) that turn by angles (...) about axes (..., 3) through the origin.

    Rodrigues' formula; an axis of zeros turns nothing.
    """
    K = skew(axis)
    s, c = np.sin(angle)[..., None, None], np.cos(angle)[..., None, None]
    X = np.zeros((*np.shape(angle), 4, 4))
    X[..., :3, :3] = np.eye(3) + s * K + (1.0 - c) * (K @ K)
    X[..., 3, 3] = 1.0
    return X


def _rotated(w: Array, angle: Array, u: Array) -> Array:
    """A vector u (3,) turned by angles (...) about the unit vector w (3,): (..., 3)."""
    along = (w @ u) * w
    s, c = np.sin(angle)[..., None], np.cos(angle)[..., None]
    return np.asarray(along + c * (u - along) + s * cross(w, u))


def _angle(w: Array, u: Array, v: Array) -> Array:
    """Angles (...) about the unit vector w (3,) from u (3,) to v (..., 3)."""
    return np.arctan2(v @ cross(w, u), v @ (u - (w @ u) * w))


def _plane(a: Array) -> Array:
    """(2, 3) two unit vectors that make a right-handed frame with the unit vector a (3,)."""
    least = np.eye(3)[2 - np.abs(a)[::-1].argmin()]
    first = cross(least, a) / np.linalg.norm(cross(least, a))
    return np.stack([first, cross(a, first)])
