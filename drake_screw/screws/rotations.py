"""Rotations as unit quaternions (w, x, y, z) and 3x3 matrices, batched over leading axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.typing import Array


def cross(a: ArrayLike, b: ArrayLike) -> Array:
    """Cross product, quicker than numpy's; (..., 3) twice to (..., 3), broadcast together."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    a0, a1, a2 = a[..., 0], a[..., 1], a[..., 2]
    b0, b1, b2 = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0], axis=-1)


def skew(w: ArrayLike) -> Array:
    """Cross-product matrix: ``skew(w) @ v == cross(w, v)``.

    Args:
        w: (..., 3).

    Returns:
        (..., 3, 3) antisymmetric.
    """
    w = np.asarray(w, dtype=float)
    S = np.zeros((*w.shape, 3))
    S[..., 0, 1], S[..., 0, 2], S[..., 1, 2] = -w[..., 2], w[..., 1], -w[..., 0]
    return S - np.swapaxes(S, -1, -2)


def quaternion_multiply(a: ArrayLike, b: ArrayLike) -> Array:
    """Hamilton product.

    Args:
        a, b: (..., 4) as w, x, y, z.

    Returns:
        (..., 4).
    """
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    aw, av, bw, bv = a[..., :1], a[..., 1:], b[..., :1], b[..., 1:]
    w = aw * bw - np.sum(av * bv, axis=-1, keepdims=True)
    v = aw * bv + bw * av + cross(av, bv)
    return np.concatenate([w, v], axis=-1)


def quaternion_conjugate(q: ArrayLike) -> Array:
    """Conjugate, which is the inverse of a unit quaternion; (..., 4) to (..., 4)."""
    return np.asarray(q, dtype=float) * np.array([1.0, -1.0, -1.0, -1.0])


def rotation_from_quaternion(q: ArrayLike) -> Array:
    """Rotation matrix of a quaternion, which is normalised first.

    Args:
        q: (..., 4) as w, x, y, z, not zero.

    Returns:
        (..., 3, 3).
    """
    q = np.asarray(q, dtype=float)
    unit = q / np.linalg.norm(q, axis=-1, keepdims=True)
    S = skew(unit[..., 1:])
    return np.eye(3) + 2.0 * (unit[..., :1, None] * S + S @ S)


def quaternion_from_rotation(R: ArrayLike) -> Array:
    """Unit quaternion of a rotation matrix, with w >= 0.

    Every row of ``4 q q^T`` can be read off R; the one with the largest diagonal is divided by its
    own length, so that no rotation angle loses digits (Shepperd, J. Guidance and Control, 1978).

    Args:
        R: (..., 3, 3).

    Returns:
        (..., 4) as w, x, y, z.
    """
    R = np.asarray(R, dtype=float)
    d0, d1, d2 = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    Q = np.empty((*R.shape[:-2], 4, 4))
    Q[..., 0, 0] = 1.0 + d0 + d1 + d2
    Q[..., 1, 1] = 1.0 + d0 - d1 - d2
    Q[..., 2, 2] = 1.0 - d0 + d1 - d2
    Q[..., 3, 3] = 1.0 - d0 - d1 + d2
    for i, (j, k) in enumerate([(1, 2), (2, 0), (0, 1)], start=1):
        Q[..., 0, i] = Q[..., i, 0] = R[..., k, j] - R[..., j, k]
    for i, j in [(0, 1), (0, 2), (1, 2)]:
        Q[..., i + 1, j + 1] = Q[..., j + 1, i + 1] = R[..., i, j] + R[..., j, i]
    largest = np.argmax(np.diagonal(Q, axis1=-2, axis2=-1), axis=-1)
    q = np.take_along_axis(Q, largest[..., None, None], axis=-2)[..., 0, :]
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    return np.where(q[..., :1] < 0, -q, q)


def quaternion_from_rotation_vector(w: ArrayLike) -> Array:
    """Unit quaternion of the rotation by ``|w|`` about w; (..., 3) rad to (..., 4)."""
    w = np.asarray(w, dtype=float)
    half = 0.5 * np.linalg.norm(w, axis=-1, keepdims=True)
    return np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * w], axis=-1)


def rotation_vector_from_quaternion(q: ArrayLike) -> Array:
    """Rotation vector (axis times angle, the angle at most pi) of a unit quaternion.

    Args:
        q: (..., 4) as w, x, y, z.

    Returns:
        (..., 3) rad.
    """
    q = np.asarray(q, dtype=float)
    q = np.where(q[..., :1] < 0, -q, q)
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    half = np.arctan2(sine, q[..., :1])
    scale = np.where(sine > 0.0, 2.0 * half / np.where(sine > 0.0, sine, 1.0), 2.0)
    return scale * q[..., 1:]
