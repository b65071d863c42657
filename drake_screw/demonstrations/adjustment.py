"""Guiding poses moved, so that the screws between them come nearer to samples that scatter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.compile_cache import cached_njit
from drake_screw.demonstrations.screw_fit import poses_on_screws
from drake_screw.screws import (
    pose,
    quaternion_from_rotation,
    quaternion_from_rotation_vector,
    quaternion_multiply,
    rotation_from_quaternion,
)
from drake_screw.typing import Array

_POSES = 49  # of each screw, that samples are held against
_NORMS = (2, 3, 4, 6, 9, 12, 16, 20, 24, 32)
_RIDGE = 1e-4  # of the mean, so that guiding poses with hardly a sample stay where they are


@dataclass(frozen=True)
class Adjusted:
    """Guiding poses, and how near samples are to the screws between them.

    Attributes:
        X_WE: (g, 4, 4).
        share: of the tolerances; each sample is within it of one pose of the screws, in the order
            shown.
        farthest: index of the sample for which it takes that much.
    """

    X_WE: Array
    share: float
    farthest: int


def adjusted(
    X_guides: Array,
    cuts: NDArray[np.int64],
    samples: Array,
    position_tolerance: float,
    rotation_tolerance: float,
) -> Adjusted:
    """Guiding poses moved for the largest deviation of samples from the screws to become less.

    The samples between two cuts belong to the screw between the two guiding poses. Each is held
    against one of its poses, in the order shown, and counts for both guiding poses in proportion to
    the screw parameter. Newton's method makes the p-norm of the deviations less, with p rising from
    2, by which the least largest deviation is approached (Burrus, Barreto and Selesnick, IEEE
    Transactions on Signal Processing, 1994). The nearest of the guiding poses on the way are taken,
    those given among them.

    Args:
        X_guides: (g, 4, 4), at least two.
        cuts: (g,) increasing indices of the samples at them, from 0 to m - 1.
        samples: (m, 4, 4).
        position_tolerance, rotation_tolerance: m, rad.
    """
    P, Q = np.ascontiguousarray(samples[:, :3, 3]), quaternion_from_rotation(samples[:, :3, :3])
    p, q = X_guides[:, :3, 3], quaternion_from_rotation(X_guides[:, :3, :3])
    screw = np.searchsorted(cuts[1:-1], np.arange(len(samples)), side="right")
    nearest, least, farthest = (p, q), np.inf, 0
    for norm in (*_NORMS, None):
        track = poses_on_screws(p, q, _POSES)
        at = _in_order(P, Q, screw, *track, position_tolerance, rotation_tolerance)
        deviations = _deviations(P, Q, screw, *track, at, position_tolerance, rotation_tolerance)
        shares = np.sqrt(np.sum(deviations**2, axis=2))
        if shares.max() < least:
            nearest, least = (p, q), float(shares.max())
            farthest = int(np.argmax(shares.max(axis=0)))
        if norm is None or least == 0.0:
            break
        away, off = (
            np.linalg.solve(*_normal_equations(d, share, screw, at / (_POSES - 1), len(cuts), norm))
            for d, share in zip(deviations, shares, strict=True)
        )
        p = p + position_tolerance / (norm - 1) * away
        turn = quaternion_from_rotation_vector(rotation_tolerance / (norm - 1) * off)
        q = quaternion_multiply(turn, q)
    return Adjusted(pose(rotation_from_quaternion(nearest[1]), nearest[0]), least, farthest)


@cached_njit()
def _in_order(
    p: Array, q: Array, screw: Array, P: Array, Q: Array, place: float, turn: float
) -> NDArray[np.int64]:
    """For each sample (p, q) the pose of its screw (P, Q): in order, least 8-norm of deviations."""
    m, count = len(p), P.shape[1]
    chosen, origin = np.empty(m, dtype=np.int64), np.empty((m, count), dtype=np.int16)
    total, begin = np.zeros(count), 0
    for k in range(m):
        i = screw[k]
        least, where = np.inf, 0
        for n in range(count):
            d0, d1, d2 = p[k, 0] - P[i, n, 0], p[k, 1] - P[i, n, 1], p[k, 2] - P[i, n, 2]
            c = (
                q[k, 0] * Q[i, n, 0]
                + q[k, 1] * Q[i, n, 1]
                + q[k, 2] * Q[i, n, 2]
                + q[k, 3] * Q[i, n, 3]
            )
            away = (d0 * d0 + d1 * d1 + d2 * d2) / place**2
            square = max(away, 4.0 * (1.0 - c * c) / turn**2)  # of an angle, if it is small
            square *= square
            if total[n] < least:
                least, where = total[n], n
            origin[k, n] = where
            total[n] = least + square * square
        if k == m - 1 or screw[k + 1] != i:
            at = np.argmin(total)
            for j in range(k, begin - 1, -1):
                chosen[j] = at
                at = origin[j, at]
            total[:], begin = 0.0, k + 1
    return chosen


@cached_njit()
def _deviations(
    p: Array, q: Array, screw: Array, P: Array, Q: Array, at: Array, place: float, turn: float
) -> Array:
    """From poses of screws to the samples: translations, rotation vectors; (2, m, 3) tolerances."""
    deviations = np.empty((2, len(p), 3))
    for k in range(len(p)):
        a, b = Q[screw[k], at[k]], q[k]
        w = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
        v0 = a[0] * b[1] - a[1] * b[0] + a[2] * b[3] - a[3] * b[2]
        v1 = a[0] * b[2] - a[2] * b[0] + a[3] * b[1] - a[1] * b[3]
        v2 = a[0] * b[3] - a[3] * b[0] + a[1] * b[2] - a[2] * b[1]
        sine = np.sqrt(v0 * v0 + v1 * v1 + v2 * v2)
        scale = 2.0 * np.arctan2(sine, abs(w)) / max(sine, 1e-300) / turn
        scale = -scale if w < 0.0 else scale
        deviations[1, k, 0], deviations[1, k, 1], deviations[1, k, 2] = (
            scale * v0,
            scale * v1,
            scale * v2,
        )
        for c in range(3):
            deviations[0, k, c] = (p[k, c] - P[screw[k], at[k], c]) / place
    return deviations


@cached_njit()
def _normal_equations(
    deviations: Array, sizes: Array, screw: Array, s: Array, count: int, norm: int
) -> tuple[Array, Array]:
    """Of guiding poses' moves, blended by s, for least squares of the deviations left over.

    Each is weighted by its size to the power of norm - 2.

    Returns:
        (count, count) and (count, 3).
    """
    largest = sizes.max()
    left, right = np.zeros((count, count)), np.zeros((count, 3))
    for k in range(len(sizes)):
        weight, i = (sizes[k] / largest) ** (norm - 2) if largest > 0.0 else 1.0, screw[k]
        part = 1.0 - s[k], s[k]
        for a in range(2):
            for b in range(2):
                left[i + a, i + b] += weight * part[a] * part[b]
            for c in range(3):
                right[i + a, c] += weight * part[a] * deviations[k, c]
    ridge = _RIDGE * np.trace(left) / count
    for i in range(count):
        left[i, i] += ridge
    return left, right
