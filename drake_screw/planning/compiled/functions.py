"""cos, sin and the logarithm of SE(3) as straight-line code: polynomials, no calls, no branches."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.compiled.emitter import Emitter, Value, Vector

Array = NDArray[np.float64]


def cos_sin(e: Emitter, angle: Value) -> tuple[Value, Value]:
    """cos and sin of any angle to 4e-13: polynomials on half the angle within a half turn of 0."""
    turns = e.let(f"floor({angle} * {1.0 / (2.0 * np.pi)!r} + 0.5)")
    half = e.let(f"0.5 * {angle} - {np.pi!r} * {turns}")
    square = e.sum((half, half))
    quotient = e.polynomial(str(square), _SIN)
    sine = e.sum((half, quotient))
    cosine = e.polynomial(str(square), _COS)
    return e.let(f"1.0 - 2.0*{sine}*{sine}"), e.sum((2.0, sine, cosine))


def log_between(e: Emitter, X_BE: Vector, X_BG: Vector) -> list[Value]:
    """The twist log(X_BG X_BE^-1), of an angle of at most pi, by way of the quaternion."""

    def R(X: Vector, i: int, j: int) -> Value:
        return X[4 * i + j]

    M = [
        [e.sum(*((R(X_BG, i, k), R(X_BE, j, k)) for k in range(3))) for j in range(3)]
        for i in range(3)
    ]
    p = [
        e.sum((X_BG[4 * i + 3],), *((-1.0, M[i][j], X_BE[4 * j + 3]) for j in range(3)))
        for i in range(3)
    ]
    diagonal = [
        e.sum((1.0,), *((1.0 if k in (0, i) else -1.0, M[k - 1][k - 1]) for k in (1, 2, 3)))
        if i
        else e.sum((1.0,), *((M[k][k],) for k in range(3)))
        for i in range(4)
    ]
    x, y, z = (e.sum((M[k][j],), (-1.0, M[j][k])) for j, k in ((1, 2), (2, 0), (0, 1)))
    xy, yz, zx = (e.sum((M[j][k],), (M[k][j],)) for j, k in ((0, 1), (1, 2), (2, 0)))
    candidates = [
        [diagonal[0], x, y, z],
        [x, diagonal[1], xy, zx],
        [y, xy, diagonal[2], yz],
        [z, zx, yz, diagonal[3]],
    ]
    best, size = candidates[0], diagonal[0]
    for i in (1, 2, 3):
        better = e.let(f"{diagonal[i]} > {size}")
        best = [e.where(better, new, old) for new, old in zip(candidates[i], best, strict=True)]
        size = e.let(f"max({diagonal[i]}, {size})")
    sign = e.where(f"{best[0]} < 0.0", -1.0, 1.0)
    scale = e.let(f"{sign} / sqrt({e.dot(best, best)})")
    w, *u = (e.sum((scale, component)) for component in best)
    sine2 = e.dot(u, u)
    cosine = e.let(f"1.0 + {w}")
    tangent2 = e.let(f"{sine2} / ({cosine} * {cosine})")
    slope = e.let(f"1.0 / ({cosine} * (1.0 + sqrt(1.0 + {tangent2})))")
    quarter2 = e.let(f"{sine2} * {slope} * {slope}")
    angle_per_sine = e.let(f"8.0 * {slope} * {e.polynomial(quarter2, _ATAN)}")
    turn = [e.sum((angle_per_sine, component)) for component in u]
    bend = e.let(f"(1.0 - 0.5 * {angle_per_sine} * {w}) / ({sine2} + 1e-30)")
    swing, twice = e.cross(turn, p), e.cross(u, e.cross(u, p))
    v = [e.sum((p[k],), (-0.5, swing[k]), (bend, twice[k])) for k in range(3)]
    return [*turn, *v]


def fit(f: Callable[[Array], Array], degree: int, end: float) -> list[float]:
    """Coefficients of the Chebyshev interpolant of f on [0, end]."""
    series = np.polynomial.Chebyshev.interpolate(f, degree, domain=[0.0, end])
    return [float(c) for c in series.convert(kind=np.polynomial.Polynomial).coef]


_SIN = fit(lambda x: np.sinc(np.sqrt(x) / np.pi), 6, (np.pi / 2) ** 2)
_COS = fit(lambda x: np.cos(np.sqrt(x)), 7, (np.pi / 2) ** 2)
_ATAN = fit(
    lambda x: np.arctan(np.sqrt(x + 1e-300)) / np.sqrt(x + 1e-300), 9, np.tan(np.pi / 8) ** 2
)
