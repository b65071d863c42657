"""A serial arm as a product of exponentials: all that the compiled planner knows of a robot."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.screws import adjoint, exp
from drake_screw.screws.rotations import skew
from drake_screw.typing import Array


@dataclass(frozen=True)
class ScrewChain:
    """``X_WE(q) = exp(S_1 q_1) ... exp(S_n q_n) home`` (Brockett 1984; Modern Robotics, ch. 4).

    Attributes:
        joint_names: n names, base to end effector.
        screws: (n, 6) the spatial twist [w; v] of each joint at q = 0, in W about its origin.
            A revolute joint has ``|w| = 1``; a prismatic one ``w = 0`` and ``|v| = 1``.
        home: (4, 4) X_WE at q = 0.
        lower, upper: (n,) joint limits, rad or m; infinite where a joint has none.
    """

    joint_names: tuple[str, ...]
    screws: Array
    home: Array
    lower: Array
    upper: Array

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    def margin(self, q: ArrayLike) -> Array:
        """Distance to the nearer limit, negative outside; (..., n) to (..., n), rad or m."""
        q = np.asarray(q, dtype=float)
        return np.minimum(q - self.lower, self.upper - q)

    def motions(self, q: ArrayLike) -> Array:
        """How every joint moves what lies behind it: exp(S_1 q_1) ... exp(S_i q_i) for every i.

        For a unit twist exp(S q) is a polynomial in the matrix S with coefficients that depend on
        q only (Modern Robotics, eq. 3.51 and 3.88), so all joints take one matrix product.

        Args:
            q: (N, n) rad or m.

        Returns:
            (n, N, 4, 4).
        """
        angle = np.asarray(q, dtype=float).T
        one = np.ones_like(angle)
        c = np.stack([one, angle, 1.0 - np.cos(angle), angle - np.sin(angle)], axis=-1)
        E = (c @ self._powers).reshape(*angle.shape, 4, 4)
        for i in range(1, len(E)):
            E[i] = E[i - 1] @ E[i]
        return E

    @cached_property
    def _powers(self) -> Array:
        """(n, 4, 16) the powers 0 to 3 of each screw as a matrix."""
        S = np.zeros((self.n, 4, 4))
        S[:, :3, :3], S[:, :3, 3] = skew(self.screws[:, :3]), self.screws[:, 3:]
        powers = np.stack([np.broadcast_to(np.eye(4), S.shape), S, S @ S, S @ S @ S], axis=1)
        return powers.reshape(self.n, 4, 16)

    @property
    def shoulder(self) -> Array:
        """(3,) m, a point on the first revolute axis, from which `reach` is counted."""
        return self._waypoints()[0]

    @property
    def reach(self) -> float:
        """An upper bound in m on the end effector's distance from the shoulder.

        From each revolute axis to the next, then to the end effector, it adds up lengths that no
        joint can change; prismatic joints add their travel.
        """
        points = self._waypoints()
        lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
        travel = np.maximum(np.abs(self.lower), np.abs(self.upper))[~self._revolute]
        return float(lengths.sum() + travel.sum())

    @property
    def _revolute(self) -> Array:
        return np.linalg.norm(self.screws[:, :3], axis=1) > 0.5

    def _waypoints(self) -> Array:
        """A point on each revolute axis, then the end effector, by the shorter of two ways.

        Neither way has a step that a revolute joint can change. One goes out from the base, each
        point the nearest to the one before; the other comes back from the end effector.
        """
        p_WE, axes = self.home[:3, 3], self.screws[self._revolute]
        out = _nearest_points(axes, p_WE)[1:]
        back = _nearest_points(axes[::-1], p_WE)[:0:-1]
        ways = [np.array([*way, p_WE]) if way else np.array([p_WE, p_WE]) for way in (out, back)]
        return min(ways, key=lambda way: np.linalg.norm(np.diff(way, axis=0), axis=1).sum())

    def pose(self, q: ArrayLike) -> Array:
        """Forward kinematics; q (..., n) rad or m to X_WE (..., 4, 4)."""
        each = self._exponentials(q)
        X = np.broadcast_to(self.home, (*each.shape[:-3], 4, 4))
        for i in reversed(range(self.n)):
            X = each[..., i, :, :] @ X
        return X

    def jacobian(self, q: ArrayLike) -> Array:
        """Spatial Jacobian about W's origin; q (..., n) to (..., 6, n), twists as [w; v]."""
        return self.pose_and_jacobian(q)[1]

    def pose_and_jacobian(self, q: ArrayLike) -> tuple[Array, Array]:
        """Both of the same q (..., n), for which the joints' exponentials are needed but once."""
        each = self._exponentials(q)
        before = np.empty((*each.shape[:-3], self.n + 1, 4, 4))
        before[..., 0, :, :] = np.eye(4)
        for i in range(self.n):
            before[..., i + 1, :, :] = before[..., i, :, :] @ each[..., i, :, :]
        J = (adjoint(before[..., :-1, :, :]) @ self.screws[..., None])[..., 0]
        return before[..., -1, :, :] @ self.home, np.swapaxes(J, -1, -2)

    def _exponentials(self, q: ArrayLike) -> Array:
        """exp(S_i q_i) of every joint; q (..., n) to (..., n, 4, 4)."""
        return exp(self.screws * np.asarray(q, dtype=float)[..., None])


def _nearest_points(axes: Array, start: Array) -> list[Array]:
    """The start, then a point on each axis (a, 6) in turn, the nearest to the one before."""
    places = [start]
    for S in axes:
        axis, point = S[:3], np.cross(S[:3], S[3:])
        places.append(point + axis * ((places[-1] - point) @ axis))
    return places
