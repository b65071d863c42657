"""Unit dual quaternions, the form in which ScLERP was first written.

Stored as eight numbers: the real part (w, x, y, z), a rotation, then the dual part (w, x, y, z),
half of position times rotation. The rest of the project uses matrices and twists; this is for
those who come from the papers (Kavan et al., 2006; Daniilidis, 1999).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.screws.interpolation import Screw, screw_from_twist
from drake_screw.screws.poses import log, pose
from drake_screw.screws.rotations import (
    quaternion_conjugate,
    quaternion_from_rotation,
    quaternion_multiply,
    rotation_from_quaternion,
)
from drake_screw.typing import Array


def dual_quaternion_from_pose(X: ArrayLike) -> Array:
    """Unit dual quaternion, its real w >= 0, of a pose; (..., 4, 4) to (..., 8).

    >>> dual_quaternion_from_pose(pose(np.eye(3), [0.2, 0.4, 0.6])).round(6).tolist()
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.3]
    """
    X = np.asarray(X, dtype=float)
    real = quaternion_from_rotation(X[..., :3, :3])
    p = np.concatenate([np.zeros_like(X[..., :1, 3]), X[..., :3, 3]], axis=-1)
    return np.concatenate([real, 0.5 * quaternion_multiply(p, real)], axis=-1)


def pose_from_dual_quaternion(Q: ArrayLike) -> Array:
    """Pose of a unit dual quaternion; (..., 8) to (..., 4, 4)."""
    Q = np.asarray(Q, dtype=float)
    p = 2.0 * quaternion_multiply(Q[..., 4:], quaternion_conjugate(Q[..., :4]))[..., 1:]
    return pose(rotation_from_quaternion(Q[..., :4]), p)


def dual_quaternion_multiply(A: ArrayLike, B: ArrayLike) -> Array:
    """Product, which composes poses; (..., 8) twice to (..., 8)."""
    A, B = np.asarray(A, dtype=float), np.asarray(B, dtype=float)
    dual = quaternion_multiply(A[..., :4], B[..., 4:]) + quaternion_multiply(A[..., 4:], B[..., :4])
    return np.concatenate([quaternion_multiply(A[..., :4], B[..., :4]), dual], axis=-1)


def dual_quaternion_conjugate(Q: ArrayLike) -> Array:
    """Conjugate of both parts, the inverse of a unit dual quaternion; (..., 8) to (..., 8)."""
    Q = np.asarray(Q, dtype=float)
    return np.concatenate(
        [quaternion_conjugate(Q[..., :4]), quaternion_conjugate(Q[..., 4:])], axis=-1
    )


def dual_quaternion_from_screw(screw: Screw) -> Array:
    """``cos(phi/2) + sin(phi/2) (l + eps m)`` with the dual angle phi = angle + eps translation.

    Returns:
        (..., 8).
    """
    c, s = np.cos(screw.angle / 2.0)[..., None], np.sin(screw.angle / 2.0)[..., None]
    half = screw.translation[..., None] / 2.0
    return np.concatenate(
        [c, s * screw.axis, -half * s, s * screw.moment + half * c * screw.axis], axis=-1
    )


def dual_quaternion_power(Q: ArrayLike, s: ArrayLike) -> Array:
    """Q^s, the s-th part of the screw displacement Q by the short way round.

    Args:
        Q: (..., 8) unit.
        s: (...).

    Returns:
        (..., 8). ScLERP from A to B is ``A (A* B)^s``.

    >>> Q = dual_quaternion_from_pose(pose(np.eye(3), [0.2, 0.4, 0.6]))
    >>> pose_from_dual_quaternion(dual_quaternion_power(Q, 0.5))[:3, 3].round(6).tolist()
    [0.1, 0.2, 0.3]
    """
    s = np.asarray(s, dtype=float)
    screw = screw_from_twist(log(pose_from_dual_quaternion(Q)))
    return dual_quaternion_from_screw(
        Screw(screw.axis, screw.point, s * screw.angle, s * screw.translation)
    )
