"""Constant screw motions: Chasles' parameters, screw linear interpolation, nearest points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.screws.poses import exp, inverse, log, shift
from drake_screw.screws.rotations import cross
from drake_screw.typing import Array


@dataclass(frozen=True)
class Screw:
    """A screw displacement: rotation about a line and translation along it (Chasles' theorem).

    Attributes:
        axis: (..., 3) unit direction l of the line. Any unit vector for the identity.
        point: (..., 3) m, the point of the line nearest to the origin (zero for a translation).
        angle: (...) rad in [0, pi], about the axis.
        translation: (...) m, along the axis.
    """

    axis: Array
    point: Array
    angle: Array
    translation: Array

    @property
    def pitch(self) -> Array:
        """(...) m/rad, translation per angle; infinite for a pure translation."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.angle > 0.0, self.translation / self.angle, np.inf)

    @property
    def moment(self) -> Array:
        """(..., 3) m, the axis line's Plücker moment, point x axis."""
        return cross(self.point, self.axis)

    @property
    def twist(self) -> Array:
        """(..., 6) the spatial twist [w; v] that makes this displacement in unit time."""
        w = self.angle[..., None] * self.axis
        return np.concatenate(
            [w, cross(self.point, w) + self.translation[..., None] * self.axis], axis=-1
        )


def screw_from_twist(V: ArrayLike) -> Screw:
    """Screw parameters of a spatial twist followed for unit time (Modern Robotics, section 3.3.2).

    A twist that turns by less than 1e-12 rad counts as a pure translation.

    Args:
        V: (..., 6) as [w; v], rad and m.

    >>> screw = screw_from_twist([0.0, 0.0, 2.0, 0.0, -2.0, 0.5])
    >>> screw.axis.tolist(), screw.point[:2].tolist()
    ([0.0, 0.0, 1.0], [1.0, 0.0])
    >>> float(screw.angle), float(screw.translation), float(screw.pitch)
    (2.0, 0.5, 0.25)
    """
    V = np.asarray(V, dtype=float)
    w, v = V[..., :3], V[..., 3:]
    angle, length = np.linalg.norm(w, axis=-1), np.linalg.norm(v, axis=-1)
    turns = angle > 1e-12
    direction = np.where(turns[..., None], w, v)
    size = np.where(turns, angle, length)[..., None]
    x_axis = np.array([1.0, 0.0, 0.0])
    axis = np.where(size > 0.0, direction / np.where(size > 0.0, size, 1.0), x_axis)
    square = np.where(turns, angle, 1.0)[..., None] ** 2
    point = np.where(turns[..., None], cross(w, v) / square, 0.0)
    return Screw(axis, point, np.where(turns, angle, 0.0), np.sum(axis * v, axis=-1))


def screw_between(X_WA: ArrayLike, X_WB: ArrayLike) -> Screw:
    """The screw, expressed in W, that takes pose A to pose B; poses are (..., 4, 4).

    From (1, 0) to (0, 1) with a quarter turn: a rotation about the origin.

    >>> from drake_screw.screws import pose_from_planar
    >>> screw = screw_between(pose_from_planar([1, 0, 0]), pose_from_planar([0, 1, np.pi / 2]))
    >>> round(float(screw.angle), 6), bool(abs(screw.point).max() < 1e-12)
    (1.570796, True)
    """
    return screw_from_twist(log(np.asarray(X_WB) @ inverse(X_WA)))


def sclerp(X_WA: ArrayLike, X_WB: ArrayLike, s: ArrayLike) -> Array:
    """Screw linear interpolation: ``exp(s log(X_WB X_WA^-1)) X_WA``.

    The motion keeps one twist from A (s = 0) to B (s = 1), whatever frame it is seen from
    (Sarker, Sinha, Chakraborty, IROS 2020).

    Args:
        X_WA, X_WB: (..., 4, 4).
        s: (...), broadcast against the poses' leading axes.

    Returns:
        X_WE(s): (..., 4, 4).

    Half of a quarter turn about the origin:

    >>> from drake_screw.screws import pose_from_planar
    >>> X_WA, X_WB = pose_from_planar([1, 0, 0]), pose_from_planar([0, 1, np.pi / 2])
    >>> sclerp(X_WA, X_WB, 0.5)[:2, 3].round(6).tolist()
    [0.707107, 0.707107]
    >>> sclerp(X_WA, X_WB, np.linspace(0, 1, 5)).shape
    (5, 4, 4)
    """
    V = log(np.asarray(X_WB) @ inverse(X_WA))
    return exp(np.asarray(s, dtype=float)[..., None] * V) @ np.asarray(X_WA)


def sclerp_position(X_WA: ArrayLike, X_WB: ArrayLike, s: ArrayLike) -> Array:
    """Position of `sclerp`, in closed form, where its orientation is not needed.

    Args:
        X_WA, X_WB: (..., 4, 4).
        s: (...), broadcast against the poses' leading axes.

    Returns:
        p_WE(s): (..., 3) m.
    """
    return np.asarray(X_WA)[..., :3, 3] + _OriginMotion.between(X_WA, X_WB).displacement(s)


def nearest_on_screw(X_WA: ArrayLike, X_WB: ArrayLike, p_WQ: ArrayLike) -> Array:
    """Where on the constant screw from A to B the moving origin comes nearest to a point.

    The distance along a helix can have several minima: the least of 65 samples is refined by
    Newton's method, within [0, 1].

    Args:
        X_WA, X_WB: (..., 4, 4).
        p_WQ: (..., 3) m, broadcast against the poses' leading axes.

    Returns:
        s: (...) in [0, 1].

    >>> from drake_screw.screws import pose_from_planar
    >>> X_WA, X_WB = pose_from_planar([1, 0, 0]), pose_from_planar([0, 1, np.pi / 2])
    >>> round(float(nearest_on_screw(X_WA, X_WB, [5.0, 5.0, 0.0])), 6)
    0.5
    """
    p_AQ = np.asarray(p_WQ, dtype=float) - np.asarray(X_WA)[..., :3, 3]
    motion = _OriginMotion.between(X_WA, X_WB)
    grid = np.linspace(0.0, 1.0, 65)
    track = motion.stretched().displacement(grid)
    half_square = 0.5 * np.sum(track * track, axis=-1) - np.einsum("...i,...ki", p_AQ, track)
    s = grid[np.argmin(half_square, axis=-1)]
    low, high = np.maximum(s - grid[1], 0.0), np.minimum(s + grid[1], 1.0)

    theta, d = motion.angle, motion.along
    forward = d * np.sum(motion.axis * p_AQ, axis=-1)
    across = np.sum(motion.across * p_AQ, axis=-1)
    inward = np.sum(motion.across**2, axis=-1) - theta * np.sum(motion.inward * p_AQ, axis=-1)
    for _ in range(8):
        c, sine = np.cos(theta * s), s * np.sinc(theta * s / np.pi)
        slope = d * d * s - forward + inward * sine - across * c
        bend = d * d + inward * c + theta**2 * across * sine
        step = np.where(bend > 0.0, slope / np.where(bend > 0.0, bend, 1.0), 0.0)
        s = np.clip(s - step, low, high)
    return s


@dataclass(frozen=True)
class _OriginMotion:
    """How a frame's origin moves on a constant screw, relative to where it starts.

    The screw's axis plays no part: it lies very far away when the screw hardly turns.

    Attributes:
        axis: (..., 3) the screw's direction.
        angle: (...) rad, turned in unit time.
        along: (...) m, travelled along the axis in unit time.
        across, inward: (..., 3) the origin's first velocity across the axis, and the same turned
            by a right angle about the axis.
    """

    axis: Array
    angle: Array
    along: Array
    across: Array
    inward: Array

    @classmethod
    def between(cls, X_WA: ArrayLike, X_WB: ArrayLike) -> _OriginMotion:
        V = log(np.asarray(X_WB) @ inverse(X_WA))
        V = shift(V, np.asarray(X_WA)[..., :3, 3])
        screw = screw_from_twist(V)
        across = V[..., 3:] - screw.translation[..., None] * screw.axis
        return cls(screw.axis, screw.angle, screw.translation, across, cross(screw.axis, across))

    def stretched(self) -> _OriginMotion:
        """With one more axis at the end of the leading axes."""
        return _OriginMotion(
            self.axis[..., None, :],
            self.angle[..., None],
            self.along[..., None],
            self.across[..., None, :],
            self.inward[..., None, :],
        )

    def displacement(self, s: ArrayLike) -> Array:
        """(..., 3) m, from where the origin starts to where it is at s (...)."""
        s = np.asarray(s, dtype=float)
        turned = self.angle * s
        sine = s * np.sinc(turned / np.pi)
        versine = 0.5 * turned * s * np.sinc(turned / (2.0 * np.pi)) ** 2
        return (
            (self.along * s)[..., None] * self.axis
            + sine[..., None] * self.across
            + versine[..., None] * self.inward
        )
