"""cos, sin and the logarithm of SE(3) as expressions: polynomials, no calls, no branches."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from drake_screw.planning.compiled.expressions import Expression, floor, maximum, sqrt, where
from drake_screw.typing import Array


def polynomial(x: Expression, coefficients: Sequence[float]) -> Expression:
    """Horner's scheme; coefficients from the constant term up."""
    *rest, highest = coefficients
    result = highest * x + rest.pop()
    for c in reversed(rest):
        result = result * x + c
    return result


def cos_sin(angle: Expression) -> tuple[Expression, Expression]:
    """cos and sin of any angle to 4e-13: polynomials on half the angle within a half turn of 0."""
    turns = floor(angle * (1.0 / (2.0 * np.pi)) + 0.5)
    half = 0.5 * angle - np.pi * turns
    square = half * half
    sine = half * polynomial(square, SIN)
    cosine = polynomial(square, COS)
    return 1.0 - 2.0 * sine * sine, 2.0 * sine * cosine


def log_between(X_BE: Array, X_BG: Array) -> Array:
    """The twist log(X_BG X_BE^-1) (6,), of an angle of at most pi, by way of the quaternion.

    Args:
        X_BE, X_BG: (3, 4) rows [R | p].
    """
    R = X_BG[:, :3] @ X_BE[:, :3].T
    p = X_BG[:, 3] - R @ X_BE[:, 3]
    x, y, z = (R[k, j] - R[j, k] for j, k in ((1, 2), (2, 0), (0, 1)))
    xy, yz, zx = (R[j, k] + R[k, j] for j, k in ((0, 1), (1, 2), (2, 0)))
    d = R.diagonal()
    candidates = np.array(
        [
            [d[0] + d[1] + d[2] + 1.0, x, y, z],
            [x, d[0] - d[1] - d[2] + 1.0, xy, zx],
            [y, xy, d[1] - d[0] - d[2] + 1.0, yz],
            [z, zx, yz, d[2] - d[0] - d[1] + 1.0],
        ]
    )
    best, size = candidates[0], candidates[0, 0]
    for i in (1, 2, 3):
        best = where(candidates[i, i] > size, candidates[i], best)
        size = maximum(candidates[i, i], size)
    w, *_ = quaternion = best * (where(best[0] < 0.0, -1.0, 1.0) / sqrt(best @ best))
    u = quaternion[1:]
    sine2, cosine = u @ u, 1.0 + w
    tangent2 = sine2 / (cosine * cosine)
    slope = 1.0 / (cosine * (1.0 + sqrt(1.0 + tangent2)))
    angle_per_sine = 8.0 * slope * polynomial(sine2 * slope * slope, _ATAN)
    turn = angle_per_sine * u
    bend = (1.0 - 0.5 * angle_per_sine * w) / (sine2 + 1e-30)
    v = p - 0.5 * np.cross(turn, p) + bend * np.cross(u, np.cross(u, p))
    return np.concatenate([turn, v])


def fit(f: Callable[[Array], Array], degree: int, end: float) -> list[float]:
    """Coefficients of the Chebyshev interpolant of f on [0, end]."""
    series = np.polynomial.Chebyshev.interpolate(f, degree, domain=[0.0, end])
    return [float(c) for c in series.convert(kind=np.polynomial.Polynomial).coef]


SIN = tuple(fit(lambda x: np.sinc(np.sqrt(x) / np.pi), 6, (np.pi / 2) ** 2))
COS = tuple(fit(lambda x: np.cos(np.sqrt(x)), 7, (np.pi / 2) ** 2))
"""Coefficients of sin(x) / x and cos(x) in x^2, for x of a quarter turn at most."""

_ATAN = fit(
    lambda x: np.arctan(np.sqrt(x + 1e-300)) / np.sqrt(x + 1e-300), 9, np.tan(np.pi / 8) ** 2
)
