"""SE(3): poses X as 4x4 matrices, spatial twists V as [w; v], batched over leading axes.

A twist here is *spatial*: w in rad is the angular part, v in m is the velocity of the point of the
moving body that passes through the origin of the frame in which all is expressed (Lynch and Park,
"Modern Robotics", 2017, section 3.3). Applied from the left, ``exp(V) @ X_WE`` moves E in W.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.screws.rotations import (
    cross,
    quaternion_from_rotation,
    rotation_from_quaternion,
    rotation_vector_from_quaternion,
    skew,
)
from drake_screw.typing import Array

_SERIES_BELOW = 0.04  # rad^2; below it the power series are exact to machine precision


def pose(R: ArrayLike, p: ArrayLike) -> Array:
    """Pose from its rotation and position, which are broadcast together.

    Args:
        R: (..., 3, 3).
        p: (..., 3) m.

    Returns:
        X: (..., 4, 4).
    """
    R, p = np.asarray(R, dtype=float), np.asarray(p, dtype=float)
    X = np.zeros((*np.broadcast_shapes(R.shape[:-2], p.shape[:-1]), 4, 4))
    X[..., :3, :3], X[..., :3, 3], X[..., 3, 3] = R, p, 1.0
    return X


def pose_from_planar(x_y_yaw: ArrayLike, z: ArrayLike = 0.0) -> Array:
    """Pose of an upright body: turned by yaw about W's z axis, then put at (x, y, z).

    Args:
        x_y_yaw: (..., 3) in m, m, rad.
        z: (...) m.

    Returns:
        X_WB: (..., 4, 4).

    >>> X_WB = pose_from_planar([0.9, 0.3, np.pi / 2], z=-0.1)
    >>> (X_WB @ [1.0, 0.0, 0.0, 1.0]).round(6).tolist()
    [0.9, 1.3, -0.1, 1.0]
    """
    x_y_yaw, z = np.asarray(x_y_yaw, dtype=float), np.asarray(z, dtype=float)
    X = np.zeros((*np.broadcast_shapes(x_y_yaw.shape[:-1], z.shape), 4, 4))
    c, s = np.cos(x_y_yaw[..., 2]), np.sin(x_y_yaw[..., 2])
    X[..., 0, 0], X[..., 0, 1], X[..., 1, 0], X[..., 1, 1] = c, -s, s, c
    X[..., 2, 2] = X[..., 3, 3] = 1.0
    X[..., 0, 3], X[..., 1, 3], X[..., 2, 3] = x_y_yaw[..., 0], x_y_yaw[..., 1], z
    return X


def inverse(X: ArrayLike) -> Array:
    """Inverse pose; (..., 4, 4) to (..., 4, 4)."""
    X = np.asarray(X, dtype=float)
    Rt = np.swapaxes(X[..., :3, :3], -1, -2)
    return pose(Rt, -(Rt @ X[..., :3, 3, None])[..., 0])


def adjoint(X_AB: ArrayLike) -> Array:
    """The matrix that re-expresses a spatial twist: ``V_A = adjoint(X_AB) @ V_B``.

    Args:
        X_AB: (..., 4, 4).

    Returns:
        (..., 6, 6), for twists [w; v].

    Moving by V_B seen from B is moving by V_A seen from A:

    >>> X_AB, V_B = pose_from_planar([1.0, 2.0, 0.5]), np.array([0.1, 0.0, 0.3, 0.0, 0.2, 0.0])
    >>> np.allclose(exp(adjoint(X_AB) @ V_B) @ X_AB, X_AB @ exp(V_B))
    True
    """
    X_AB = np.asarray(X_AB, dtype=float)
    R = X_AB[..., :3, :3]
    A = np.zeros((*X_AB.shape[:-2], 6, 6))
    A[..., :3, :3] = A[..., 3:, 3:] = R
    A[..., 3:, :3] = skew(X_AB[..., :3, 3]) @ R
    return A


def shift(V: ArrayLike, p: ArrayLike) -> Array:
    """A twist about another point: its linear part is the velocity of the body's point at p.

    ``[w; v]`` about the origin becomes ``[w; v + w x p]``; shifting by -p leads back (Modern
    Robotics, section 3.3.2). For a spatial twist V_WE and p = p_WE it is the spatial velocity of E.

    Args:
        V: (..., 6) as [w; v], rad and m.
        p: (..., 3) m, in the frame V is expressed in; broadcast against V's leading axes.

    Returns:
        (..., 6).

    A turn about the z axis carries a point on the x axis along y:

    >>> shift([0.0, 0.0, 2.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.0]).tolist()
    [0.0, 0.0, 2.0, 0.0, 1.0, 0.0]
    """
    V = np.asarray(V, dtype=float)
    v = V[..., 3:] + cross(V[..., :3], p)
    return np.concatenate([np.broadcast_to(V[..., :3], v.shape), v], axis=-1)


def exp(V: ArrayLike) -> Array:
    """Pose reached by following the constant twist V for unit time (Modern Robotics, eq. 3.88).

    Args:
        V: (..., 6) as [w; v], rad and m.

    Returns:
        X: (..., 4, 4).

    A quarter turn about the z axis through (1, 0, 0), which climbs by 0.2:

    >>> X = exp([0.0, 0.0, np.pi / 2, 0.0, -np.pi / 2, 0.2])
    >>> X[:3, 3].round(6).tolist()
    [1.0, -1.0, 0.2]
    >>> log(X).round(6).tolist()
    [0.0, 0.0, 1.570796, 0.0, -1.570796, 0.2]
    """
    V = np.asarray(V, dtype=float)
    w, v = V[..., :3], V[..., 3:]
    t2 = np.sum(w * w, axis=-1)
    t = np.sqrt(t2)
    small = t2 < _SERIES_BELOW
    safe = np.where(small, 1.0, t)
    a = np.sinc(t / np.pi)
    b = 0.5 * np.sinc(t / (2.0 * np.pi)) ** 2
    series = 1 / 6 - t2 * (1 / 120 - t2 * (1 / 5040 - t2 * (1 / 362880 - t2 / 39916800)))
    c = np.where(small, series, (safe - np.sin(safe)) / safe**3)
    S = skew(w)
    S2 = S @ S
    R = np.eye(3) + a[..., None, None] * S + b[..., None, None] * S2
    G = np.eye(3) + b[..., None, None] * S + c[..., None, None] * S2
    return pose(R, (G @ v[..., None])[..., 0])


def log(X: ArrayLike) -> Array:
    """The twist of least rotation that `exp` takes to X; its angle is in [0, pi].

    Goes through the quaternion, so it keeps its digits near pi as well as near 0. At exactly pi
    both directions of the axis are right; one is chosen.

    Args:
        X: (..., 4, 4).

    Returns:
        V: (..., 6) as [w; v], rad and m.

    >>> log(pose(np.eye(3), [0.1, 0.2, 0.3])).round(6).tolist()
    [0.0, 0.0, 0.0, 0.1, 0.2, 0.3]
    """
    X = np.asarray(X, dtype=float)
    w = rotation_vector_from_quaternion(quaternion_from_rotation(X[..., :3, :3]))
    p = X[..., :3, 3]
    t2 = np.sum(w * w, axis=-1)
    small = t2 < _SERIES_BELOW
    half = np.sqrt(np.where(small, 1.0, t2)) / 2.0
    series = 1 / 12 + t2 * (1 / 720 + t2 * (1 / 30240 + t2 * (1 / 1209600 + t2 / 47900160)))
    c = np.where(small, series, (1.0 - half / np.tan(half)) / np.where(small, 1.0, t2))
    wp = cross(w, p)
    v = p - 0.5 * wp + c[..., None] * cross(w, wp)
    return np.concatenate([w, v], axis=-1)


def translation_distance(X_WA: ArrayLike, X_WB: ArrayLike) -> Array:
    """Distance in m of two frames' origins; (..., 4, 4) twice to (...)."""
    difference = np.asarray(X_WA, dtype=float)[..., :3, 3] - np.asarray(X_WB)[..., :3, 3]
    return np.linalg.norm(difference, axis=-1)


def rotation_angle(X_WA: ArrayLike, X_WB: ArrayLike) -> Array:
    """Angle in rad, at most pi, that turns A into B; (..., 4, 4) twice to (...)."""
    R_AB = np.swapaxes(np.asarray(X_WA)[..., :3, :3], -1, -2) @ np.asarray(X_WB)[..., :3, :3]
    q = quaternion_from_rotation(R_AB)
    return 2.0 * np.arctan2(np.linalg.norm(q[..., 1:], axis=-1), q[..., 0])


def quaternion_distance(X_WA: ArrayLike, X_WB: ArrayLike) -> Array:
    """Chordal distance of the orientations: ``min(|a - b|, |a + b|)`` of their quaternions.

    It is ``2 sin(angle / 4)``, between 0 and sqrt(2); (..., 4, 4) twice to (...).
    """
    return 2.0 * np.sin(rotation_angle(X_WA, X_WB) / 4.0)


def normalized(X: ArrayLike) -> Array:
    """The pose with its rotation made orthonormal; (..., 4, 4) to (..., 4, 4)."""
    X = np.asarray(X, dtype=float)
    R = rotation_from_quaternion(quaternion_from_rotation(X[..., :3, :3]))
    return pose(R, X[..., :3, 3])
