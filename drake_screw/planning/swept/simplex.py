"""The point of a simplex that is nearest to the origin."""

from __future__ import annotations

from drake_screw.planning.compiled.inner import inner

INSIDE = 1e-12
"""m, by which the origin must lie within each face of a tetrahedron to count as inside."""

FLAT = 1e-9
"""m, height of a tetrahedron that has an inside."""


@inner
def nearest(W, count, weights):  # type: ignore[no-untyped-def]
    """The point of a simplex nearest to the origin, as weights of its corners.

    Where rounding makes the choice of a face unsure the point may be a little farther away; it is a
    point of the simplex in any case.

    Args:
        W: (4, 3) m, the corners; the first `count` of them, 1 to 4.
        weights: (4,) to be filled in; they sum up to 1, none is negative.

    Returns:
        Whether the origin is inside a tetrahedron; the weights say nothing then.
    """
    for i in range(4):
        weights[i] = 0.0
    if count == 1:
        weights[0] = 1.0
    elif count == 2:
        _edge(W, 0, 1, weights)
    elif count == 3:
        _triangle(W, 0, 1, 2, weights)
    else:
        return _tetrahedron(W, weights)
    return False


@inner
def _dot(W, i, j):  # type: ignore[no-untyped-def]
    return W[i, 0] * W[j, 0] + W[i, 1] * W[j, 1] + W[i, 2] * W[j, 2]


@inner
def _edge(W, i, j, weights):  # type: ignore[no-untyped-def]
    along = _dot(W, i, i) - _dot(W, i, j)
    length2 = along + _dot(W, j, j) - _dot(W, i, j)
    t = along / length2 if length2 > 0.0 else 0.0
    t = min(max(t, 0.0), 1.0)
    weights[i], weights[j] = 1.0 - t, t


@inner
def _triangle(W, i, j, k, weights):  # type: ignore[no-untyped-def]
    """Which of the regions about a triangle the origin is in: Ericson, Real-Time Collision
    Detection (2005), section 5.1.5."""
    ii, jj, kk = _dot(W, i, i), _dot(W, j, j), _dot(W, k, k)
    ij, jk, ki = _dot(W, i, j), _dot(W, j, k), _dot(W, k, i)
    d1, d2 = ii - ij, ii - ki
    if d1 <= 0.0 and d2 <= 0.0:
        weights[i] = 1.0
        return
    d3, d4 = ij - jj, ij - jk
    if d3 >= 0.0 and d4 <= d3:
        weights[j] = 1.0
        return
    d5, d6 = ki - jk, ki - kk
    if d6 >= 0.0 and d5 <= d6:
        weights[k] = 1.0
        return
    c = d1 * d4 - d3 * d2
    if c <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        _edge(W, i, j, weights)
        return
    b = d5 * d2 - d1 * d6
    if b <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        _edge(W, i, k, weights)
        return
    a = d3 * d6 - d5 * d4
    if a <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        _edge(W, j, k, weights)
        return
    total = a + b + c
    if total > 0.0:
        weights[i], weights[j], weights[k] = a / total, b / total, c / total
    else:
        _edge(W, i, j, weights)


@inner
def _height(W, i, j, k, m):  # type: ignore[no-untyped-def]
    """How far the origin is from the plane of i, j and k, in m; negative beyond it, seen from m.

    Negative in any case where the tetrahedron is flat.
    """
    ax, ay, az = W[j, 0] - W[i, 0], W[j, 1] - W[i, 1], W[j, 2] - W[i, 2]
    bx, by, bz = W[k, 0] - W[i, 0], W[k, 1] - W[i, 1], W[k, 2] - W[i, 2]
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    mine = x * (W[m, 0] - W[i, 0]) + y * (W[m, 1] - W[i, 1]) + z * (W[m, 2] - W[i, 2])
    origin = -(x * W[i, 0] + y * W[i, 1] + z * W[i, 2])
    size = (x * x + y * y + z * z) ** 0.5
    if abs(mine) <= INSIDE + FLAT * size:
        return -1.0
    return (origin if mine >= 0.0 else -origin) / size


@inner
def _tetrahedron(W, weights):  # type: ignore[no-untyped-def]
    best, inside = -1.0, True
    w0 = w1 = w2 = w3 = 0.0
    for m in range(4):
        i, j, k = (m + 1) & 3, (m + 2) & 3, (m + 3) & 3
        if _height(W, i, j, k, m) > INSIDE:
            continue
        inside = False
        for c in range(4):
            weights[c] = 0.0
        _triangle(W, i, j, k, weights)
        square = 0.0
        for c in range(3):
            x = 0.0
            for r in range(4):
                x += weights[r] * W[r, c]
            square += x * x
        if best < 0.0 or square < best:
            best = square
            w0, w1, w2, w3 = weights[0], weights[1], weights[2], weights[3]
    weights[0], weights[1], weights[2], weights[3] = w0, w1, w2, w3
    return inside
