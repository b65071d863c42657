"""A serial arm as a product of exponentials: all that the compiled planner knows of a robot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.screws import adjoint, exp
from drake_screw.screws.rotations import Array


@dataclass(frozen=True)
class ScrewChain:
    """``X_WE(q) = exp(S_1 q_1) ... exp(S_n q_n) home`` (Brockett 1984; Modern Robotics, ch. 4).

    Attributes:
        joint_names: n names, base to hand.
        screws: (n, 6) the spatial twist [w; v] of each joint at q = 0, in W about its origin.
            A revolute joint has |w| = 1; a prismatic one w = 0 and |v| = 1.
        home: (4, 4) X_WE at q = 0.
        lower, upper: (n,) joint limits, rad or m.
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

    @property
    def reach(self) -> float:
        """An upper bound in m on the hand's distance from the first joint's axis line.

        It adds up the common normals from each axis to the next and the way to the hand, with the
        offsets along the axes; prismatic joints add their travel.
        """
        points = [np.cross(S[:3], S[3:]) for S in self.screws if S[:3] @ S[:3] > 0.5]
        axes = [S[:3] for S in self.screws if S[:3] @ S[:3] > 0.5]
        travel = sum(
            max(abs(lo), abs(hi))
            for S, lo, hi in zip(self.screws, self.lower, self.upper, strict=True)
            if S[:3] @ S[:3] < 0.5
        )
        if not points:
            return float("inf")
        place, total = _nearest_on_line(points[0], axes[0], self.home[:3, 3]), float(travel)
        for point, axis in zip(points[1:], axes[1:], strict=True):
            following = _nearest_on_line(point, axis, place)
            total += float(np.linalg.norm(following - place))
            place = following
        return total + float(np.linalg.norm(self.home[:3, 3] - place))

    def pose(self, q: ArrayLike) -> Array:
        """Forward kinematics; q (..., n) rad or m to X_WE (..., 4, 4)."""
        q = np.asarray(q, dtype=float)
        X = np.broadcast_to(self.home, (*q.shape[:-1], 4, 4))
        for i in reversed(range(self.n)):
            X = exp(self.screws[i] * q[..., i, None]) @ X
        return X

    def jacobian(self, q: ArrayLike) -> Array:
        """Spatial Jacobian about W's origin; q (..., n) to (..., 6, n), twists as [w; v]."""
        q = np.asarray(q, dtype=float)
        J = np.empty((*q.shape[:-1], 6, self.n))
        X = np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))
        for i in range(self.n):
            J[..., i] = adjoint(X) @ self.screws[i]
            X = X @ exp(self.screws[i] * q[..., i, None])
        return J


def _nearest_on_line(point: Array, axis: Array, to: Array) -> Array:
    return point + axis * ((to - point) @ axis)
