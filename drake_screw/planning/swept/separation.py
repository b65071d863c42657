"""Bounds on the distance of two convex shapes: the algorithm of Gilbert, Johnson and Keerthi.

The difference A - B of two shapes holds the origin where they touch, and its point nearest to the
origin is as far away as they are apart ("A fast procedure for computing the distance between
complex objects in three-dimensional space", 1988). Every direction v gives a lower bound on the
distance, how far the plane that v is normal to is from the origin, with all of A - B behind it; and
every point of A - B an upper one. Both hold whatever rounding does to the search in between.

The search runs on the inner cores, so that it is well-posed where the shapes just touch; the lower
bound is that of the shapes themselves.
"""

from __future__ import annotations

from drake_screw.planning.compiled.inner import inner
from drake_screw.planning.swept.convex import held, support
from drake_screw.planning.swept.simplex import nearest

ITERATIONS = 40

CONVERGED = 1e-9
"""Of the square of a distance: what another step of the search would gain at most."""

BAND = 1e-5
"""m, about the distance in question within which nothing is said: Drake decides."""


@inner
def separation(shapes, a, X_WA, b, X_WB, v, hints, needed, least, W, weights, p, q):  # type: ignore[no-untyped-def]
    """Bounds on the distance of two shapes, as good as they have to be.

    The search ends when the lower bound exceeds `needed`, when the upper one is below `least` by
    BAND, or when the distance is known to be more than `least` and less than `needed`.

    Args:
        a, b: the shapes.
        X_WA, X_WB: (3, 4) their poses.
        v: (3,) a direction from B to A to begin with; that of the best lower bound is left there.
        hints: (2,) corners to begin with, for each of the shapes.
        needed, least: m.
        W: (5, 3), weights: (4,), p, q: (6,) to work in.

    Returns:
        lower, upper: m; the lower one is at least -inf.
    """
    balls, inside = shapes.round[a] + shapes.round[b], held(shapes, a) + held(shapes, b)
    lower, upper = -1e9, 1e9
    count = 0
    vx, vy, vz = v[0], v[1], v[2]
    for _ in range(ITERATIONS):
        length2 = vx * vx + vy * vy + vz * vz
        if length2 <= 1e-24:
            return lower, -inside
        length = length2**0.5
        if count > 0:
            upper = min(upper, length - inside)
            if upper < least - BAND:
                break
        support(
            shapes, a,
            -(X_WA[0, 0] * vx + X_WA[1, 0] * vy + X_WA[2, 0] * vz),
            -(X_WA[0, 1] * vx + X_WA[1, 1] * vy + X_WA[2, 1] * vz),
            -(X_WA[0, 2] * vx + X_WA[1, 2] * vy + X_WA[2, 2] * vz),
            hints[0:1], p,
        )  # fmt: skip
        support(
            shapes, b,
            X_WB[0, 0] * vx + X_WB[1, 0] * vy + X_WB[2, 0] * vz,
            X_WB[0, 1] * vx + X_WB[1, 1] * vy + X_WB[2, 1] * vz,
            X_WB[0, 2] * vx + X_WB[1, 2] * vy + X_WB[2, 2] * vz,
            hints[1:2], q,
        )  # fmt: skip
        outer = 0.0
        far = 0.0
        for i in range(3):
            va = vx if i == 0 else (vy if i == 1 else vz)
            base = X_WA[i, 3] - X_WB[i, 3]
            w = base
            for j in range(3):
                base += X_WA[i, j] * p[j] - X_WB[i, j] * q[j]
                w += X_WA[i, j] * p[3 + j] - X_WB[i, j] * q[3 + j]
            outer += va * base
            far += va * w
            W[count, i] = w
        bound = outer / length - balls
        if bound > lower:
            lower = bound
            v[0], v[1], v[2] = vx, vy, vz
            if lower > needed:
                break
        between = lower > least + BAND and upper < needed
        if count > 0 and (between or length2 - far <= CONVERGED * length2):
            break
        count += 1
        if nearest(W, count, weights):
            return lower, -inside
        vx = vy = vz = 0.0
        kept = 0
        for i in range(count):
            if weights[i] > 0.0:
                vx += weights[i] * W[i, 0]
                vy += weights[i] * W[i, 1]
                vz += weights[i] * W[i, 2]
                for j in range(3):
                    W[kept, j] = W[i, j]
                kept += 1
        count = kept
    return lower, upper
