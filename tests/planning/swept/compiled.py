"""What `planning.swept` compiles for itself only, made callable for its tests."""

from __future__ import annotations

import hashlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from numba import njit

from drake_screw.planning.swept import convex, separation, simplex

_separation, _nearest, _support = separation.separation, simplex.nearest, convex.support
_SOURCES = (convex, separation, simplex)


def _compiled(text: str) -> Any:
    """Kept in numba's cache by the text of what is compiled in."""

    @njit(error_model="numpy", cache=True)
    def bounds(shapes, ab, X_WA, X_WB, needed, least, v, lower, upper):  # type: ignore[no-untyped-def]
        if text == "":
            return
        hints = np.zeros(2, dtype=np.int64)
        W, weights, p, q = np.zeros((5, 3)), np.zeros(4), np.zeros(6), np.zeros(6)
        for i in range(len(ab)):
            hints[:] = 0
            lower[i], upper[i] = _separation(
                shapes, ab[i, 0], X_WA[i], ab[i, 1], X_WB[i], v[i], hints,
                needed[i], least[i], W, weights, p, q,
            )  # fmt: skip

    @njit(error_model="numpy", cache=True)
    def nearest(W, count, weights, inside):  # type: ignore[no-untyped-def]
        if text == "":
            return
        for i in range(len(W)):
            inside[i] = _nearest(W[i], count[i], weights[i])

    @njit(error_model="numpy", cache=True)
    def support(shapes, s, directions, p):  # type: ignore[no-untyped-def]
        if text == "":
            return
        hint = np.zeros(1, dtype=np.int64)
        for i in range(len(directions)):
            _support(shapes, s[i], directions[i, 0], directions[i, 1], directions[i, 2], hint, p[i])

    return SimpleNamespace(bounds=bounds, nearest=nearest, support=support)


_functions = _compiled(
    hashlib.sha256(b"\0".join(Path(m.__file__).read_bytes() for m in _SOURCES)).hexdigest()
)


def bounds_on_distance(shapes, ab, X_WA, X_WB, needed, least):  # type: ignore[no-untyped-def]
    """Lower and upper bounds (N,) in m on the distances of pairs ab (N, 2) of shapes.

    They come together where `least` is the distance and `needed` is more.

    Args:
        shapes: a `Convex`.
        X_WA, X_WB: (N, 4, 4).
        needed, least: (N,) m, as `separation` has them.
    """
    N = len(ab)
    lower, upper = np.empty(N), np.empty(N)
    v = np.ascontiguousarray(X_WA[:, :3, 3] - X_WB[:, :3, 3])
    v[~v.any(axis=1), 2] = 1.0
    frames = (np.ascontiguousarray(X[:, :3]) for X in (X_WA, X_WB))
    given = (np.broadcast_to(np.asarray(x, dtype=float), N).copy() for x in (needed, least))
    _functions.bounds(shapes, np.asarray(ab, dtype=np.int64), *frames, *given, v, lower, upper)
    return lower, upper


def nearest_points(W: np.ndarray, count: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weights (N, 4) of corners W (N, 4, 3), the first `count` (N,) of each; which are inside."""
    weights, inside = np.full((len(W), 4), np.nan), np.zeros(len(W), dtype=bool)
    _functions.nearest(np.ascontiguousarray(W), count, weights, inside)
    return weights, inside


def farthest(shapes, s: int, directions: np.ndarray) -> np.ndarray:  # type: ignore[no-untyped-def]
    """Points (N, 6) of a core and its inner core, each going on from the corner before."""
    p = np.empty((len(directions), 6))
    _functions.support(shapes, np.full(len(directions), s), np.ascontiguousarray(directions), p)
    return p
