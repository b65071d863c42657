"""Convex shapes as arrays: which point of one is farthest in a direction.

Each shape is a core, swept by a ball: a sphere is a point, a capsule a line segment with a ball
around it; boxes, cylinders, ellipsoids and hulls are their own cores. Besides, every core has an
inner one, which the shape contains even if a ball of `BALL` is swept along it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.compiled.inner import inner

Array = NDArray[np.float64]
Index = NDArray[np.int64]

POINT, SEGMENT, BOX, CYLINDER, ELLIPSOID, HULL = range(6)
"""Kinds of cores. Segments and cylinders lie along z, all are centred at their frame's origin but
hulls, which are about it somehow."""

BALL = 1e-5
"""m, radius of the ball that a shape holds wherever its inner core is."""


class Convex(NamedTuple):
    """S shapes, each in its own frame G.

    Attributes:
        kind: (S,) of cores.
        size: (S, 3) m, half extents of the core along x, y, z; unused ones are 0.
        inner: (S, 3) m, half extents of the inner core; of a hull, its scale in each place.
        round: (S,) m, radius of the ball that sweeps the core.
        first: (S + 1,) where the corners of each hull begin.
        corners: (V, 3) m, of all hulls.
        beside: (V + 1,) where the neighbours of each corner begin.
        neighbours: (E,) corners that share an edge with one, as indices of `corners`.
    """

    kind: Index
    size: Array
    inner: Array
    round: Array
    first: Index
    corners: Array
    beside: Index
    neighbours: Index


@inner
def held(shapes, s):  # type: ignore[no-untyped-def]
    """Radius in m of the ball that shape s holds wherever its inner core is."""
    return shapes.round[s] if shapes.kind[s] <= SEGMENT else BALL


@inner
def support(shapes, s, x, y, z, hint, p):  # type: ignore[no-untyped-def]
    """The point of a core that is farthest in a direction, and that of its inner core.

    Args:
        s: the shape.
        x, y, z: the direction in G, of any length but 0.
        hint: (1,) a corner of the hull from which to go on; that of the answer is left there.
        p: (6,) m, to be filled in with the two points in G.
    """
    kind = shapes.kind[s]
    if kind == HULL:
        k = _corner(shapes, s, x, y, z, hint)
        for i in range(3):
            p[i] = shapes.corners[k, i]
            p[3 + i] = p[i] * shapes.inner[s, i]
        return
    a, b, c = shapes.size[s, 0], shapes.size[s, 1], shapes.size[s, 2]
    u, v, w = shapes.inner[s, 0], shapes.inner[s, 1], shapes.inner[s, 2]
    if kind == CYLINDER:
        across = (x * x + y * y) ** 0.5
        px, py = (x / across, y / across) if across > 0.0 else (0.0, 0.0)
        pz = 1.0 if z >= 0.0 else -1.0
    elif kind == ELLIPSOID:
        px, py, pz = a * x, b * y, c * z
        length = (px * px + py * py + pz * pz) ** 0.5
        px, py, pz = px / length, py / length, pz / length
    else:
        px, py = (1.0 if x >= 0.0 else -1.0), (1.0 if y >= 0.0 else -1.0)
        pz = 1.0 if z >= 0.0 else -1.0
    p[0], p[1], p[2] = a * px, b * py, c * pz
    p[3], p[4], p[5] = u * px, v * py, w * pz


@inner
def _corner(shapes, s, x, y, z, hint):  # type: ignore[no-untyped-def]
    """The corner of a hull that is farthest: from corner to corner, uphill.

    A corner of a convex hull none of whose neighbours is farther is the farthest.
    """
    k = hint[0]
    if k < shapes.first[s] or k >= shapes.first[s + 1]:
        k = shapes.first[s]
    corners = shapes.corners
    most = x * corners[k, 0] + y * corners[k, 1] + z * corners[k, 2]
    going = True
    while going:
        going = False
        for e in range(shapes.beside[k], shapes.beside[k + 1]):
            j = shapes.neighbours[e]
            far = x * corners[j, 0] + y * corners[j, 1] + z * corners[j, 2]
            if far > most:
                most, best, going = far, j, True
        if going:
            k = best
    hint[0] = k
    return k
