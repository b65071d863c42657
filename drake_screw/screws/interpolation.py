"""Constant screw motions: Chasles' parameters, screw linear interpolation, nearest points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.screws.poses import exp, inverse, log
from drake_screw.screws.rotations import Array


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
        return np.cross(self.point, self.axis)

    @property
    def twist(self) -> Array:
        """(..., 6) the spatial twist [w; v] that makes this displacement in unit time."""
        w = self.angle[..., None] * self.axis
        return np.concatenate(
            [w, np.cross(self.point, w) + self.translation[..., None] * self.axis], axis=-1
        )


def screw_from_twist(V: ArrayLike) -> Screw:
    """Screw parameters of a spatial twist followed for unit time (Modern Robotics, section 3.3.2).

    A twist that turns by less than 1e-12 rad counts as a pure translation.

    Args:
        V: (..., 6) as [w; v], rad and m.
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
    point = np.where(turns[..., None], np.cross(w, v) / square, 0.0)
    return Screw(axis, point, np.where(turns, angle, 0.0), np.sum(axis * v, axis=-1))


def screw_between(X_WA: ArrayLike, X_WB: ArrayLike) -> Screw:
    """The screw, expressed in W, that takes pose A to pose B; poses are (..., 4, 4)."""
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
    """
    V = log(np.asarray(X_WB) @ inverse(X_WA))
    return exp(np.asarray(s, dtype=float)[..., None] * V) @ np.asarray(X_WA)


def nearest_on_screw(X_WA: ArrayLike, X_WB: ArrayLike, p_WQ: ArrayLike) -> Array:
    """Where on the constant screw from A to B the moving origin comes nearest to a point.

    The distance along a helix can have several minima: the least of 65 samples is refined by
    Newton's method, within [0, 1].

    Args:
        X_WA, X_WB: (4, 4).
        p_WQ: (..., 3) m.

    Returns:
        s: (...) in [0, 1].
    """
    X_WA, Q = np.asarray(X_WA, dtype=float), np.asarray(p_WQ, dtype=float)
    screw = screw_between(X_WA, X_WB)
    l, theta, d = screw.axis, float(screw.angle), float(screw.translation)

    def cylindrical(p: Array) -> tuple[Array, Array, Array]:
        """Along the axis; across it; and across it turned by a right angle."""
        offset = p - screw.point
        along = offset @ l
        return along, offset - along[..., None] * l, np.cross(l, offset)

    z0, r0, t0 = cylindrical(X_WA[:3, 3])
    z, r, _ = cylindrical(Q)
    # squared distance = const - 2 (a cos(theta s) + b sin(theta s)) + (d s - h)^2
    a, b, h = r @ r0, r @ t0, z - z0

    def value(s: Array) -> Array:
        turned = a[..., None] * np.cos(theta * s) + b[..., None] * np.sin(theta * s)
        return (d * s - h[..., None]) ** 2 - 2.0 * turned

    grid = np.linspace(0.0, 1.0, 65)
    s = grid[np.argmin(value(grid), axis=-1)]
    low, high = np.maximum(s - grid[1], 0.0), np.minimum(s + grid[1], 1.0)
    for _ in range(8):
        c, q = np.cos(theta * s), np.sin(theta * s)
        slope = 2.0 * d * (d * s - h) + 2.0 * theta * (a * q - b * c)
        bend = 2.0 * d * d + 2.0 * theta**2 * (a * c + b * q)
        step = np.where(bend > 0.0, slope / np.where(bend > 0.0, bend, 1.0), 0.0)
        s = np.clip(s - step, low, high)
    return s
