"""Bounds on the distance of a pair of a workcell's shapes."""

from __future__ import annotations

import math

from numba import uintp

from drake_screw.planning.compiled.inner import inlined, inner
from drake_screw.planning.swept.motion import place_shape
from drake_screw.planning.swept.separation import BAND, separation


@inlined
def standing_shapes(cell):  # type: ignore[no-untyped-def]
    """How many shapes the arm does not move."""
    return len(cell.joint) - len(cell.moved_joint)


@inlined
def between(cell, room, pair, travel):  # type: ignore[no-untyped-def]
    """Bounds in m on a pair's distance; that of a ball around b and a box around a first."""
    a, b = uintp(cell.pairs[pair, 0]), uintp(cell.pairs[pair, 1])
    if cell.joint[a] >= 0:
        place_shape(cell, room, a)
    m = b - uintp(standing_shapes(cell))
    x, y, z = room.centers[0, m], room.centers[1, m], room.centers[2, m]
    needed = cell.clearance + travel + 2.0 * BAND
    away = outside(cell, room, a, x, y, z)
    apart = needed + cell.reach[b]
    if away > apart * apart:
        return math.sqrt(away) - cell.reach[b], 1e9
    place_shape(cell, room, b)
    return exactly(
        cell.shapes, a, room.X_WG[a], b, room.X_WG[b], room.v[pair], room.hints[pair],
        needed, cell.clearance, room.W, room.weights, room.pa, room.pb,
    )  # fmt: skip


@inlined
def outside(cell, room, a, x, y, z):  # type: ignore[no-untyped-def]
    """Square of a point's distance from the box around shape a, m^2."""
    A = room.X_WG[a]
    x, y, z = x - A[0, 3], y - A[1, 3], z - A[2, 3]
    square = 0.0
    for i in range(3):
        out = abs(A[0, i] * x + A[1, i] * y + A[2, i] * z) - cell.box[a, i]
        out = max(out, 0.0)
        square += out * out
    return square


@inner
def exactly(shapes, a, A, b, B, v, hints, needed, least, W, weights, p, q):  # type: ignore[no-untyped-def]
    """`separation` of two shapes at poses A and B (3, 4), from where it was found last."""
    if v[0] == 0.0 and v[1] == 0.0 and v[2] == 0.0:
        for i in range(3):
            v[i] = A[i, 3] - B[i, 3]
        if v[0] == 0.0 and v[1] == 0.0 and v[2] == 0.0:
            v[2] = 1.0
    return separation(shapes, a, A, b, B, v, hints, needed, least, W, weights, p, q)
