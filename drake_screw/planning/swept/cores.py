"""Drake's collision shapes as cores that a ball sweeps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import (
    Box,
    Capsule,
    Cylinder,
    Ellipsoid,
    HalfSpace,
    Mesh,
    Shape,
    Sphere,
)
from pydrake.geometry import (
    Convex as ConvexShape,
)

from drake_screw.planning.swept import convex
from drake_screw.planning.swept.convex import BALL, Convex
from drake_screw.robot.shapes import vertices
from drake_screw.typing import Array

ENDLESS = 20.0
"""m, half extent of the box that stands for a half space."""


@dataclass(frozen=True)
class Core:
    """A shape as a core that a ball sweeps (see `convex.Convex`), in a frame of its own.

    Attributes:
        kind: of the core.
        size, inner: (3,) m, half extents of core and inner core, or the inner hull's scale.
        round: m, the ball's radius.
        p: (3,) m, the core's middle in the shape's frame.
        corners: (c, 3) m, of a hull, about its middle.
        edges: (e, 2) corners that share an edge.
    """

    kind: int
    size: Array
    inner: Array
    round: float
    p: Array
    corners: Array
    edges: Array

    @property
    def box(self) -> Array:
        """(3,) m, half extents of a box about its middle that holds it."""
        if self.kind == convex.HULL:
            return np.abs(self.corners).max(axis=0)
        return self.size + self.round

    @property
    def reach(self) -> float:
        """How far in m its points are from its middle at most."""
        if self.kind == convex.HULL:
            return float(np.linalg.norm(self.corners, axis=1).max())
        if self.kind == convex.CYLINDER:
            return float(np.hypot(self.size[0], self.size[2]))
        if self.kind == convex.ELLIPSOID:
            return float(self.size.max())
        return float(np.linalg.norm(self.size) + self.round)


def core_of(shape: Shape) -> Core | None:
    """A shape's core; None of a kind that is not known here.

    Raises:
        ValueError: a mesh is flat.
    """
    ball = 0.0
    match shape:
        case Sphere():
            kind, size, ball = convex.POINT, np.zeros(3), shape.radius()
        case Capsule():
            kind, size = convex.SEGMENT, np.array([0.0, 0.0, shape.length() / 2.0])
            ball = shape.radius()
        case Box():
            kind, size = convex.BOX, np.asarray(shape.size()) / 2.0
        case HalfSpace():
            corner = np.full(3, ENDLESS)
            return _plain(convex.BOX, corner, 0.0, np.array([0.0, 0.0, -ENDLESS]))
        case Cylinder():
            kind = convex.CYLINDER
            size = np.array([shape.radius(), shape.radius(), shape.length() / 2.0])
        case Ellipsoid():
            kind, size = convex.ELLIPSOID, np.array([shape.a(), shape.b(), shape.c()])
        case Mesh() | ConvexShape():
            return _hull(shape)
        case _:
            return None
    return _plain(kind, size, ball, np.zeros(3))


def _plain(kind: int, size: Array, ball: float, p: Array) -> Core:
    if kind in (convex.POINT, convex.SEGMENT):
        smaller = size
    elif kind == convex.ELLIPSOID:
        smaller = size * max(1.0 - BALL / size.min(), 0.0)
    else:
        smaller = np.maximum(size - BALL, 0.0)
    none = np.zeros((0, 3)), np.zeros((0, 2), dtype=np.int64)
    return Core(kind, size, smaller, ball, p, *none)


def _hull(shape: Mesh | ConvexShape) -> Core:
    """The convex hull of a mesh, which is what Drake takes it for."""
    from scipy.spatial import ConvexHull, QhullError  # take long to import

    surface = shape.GetConvexHull()
    points = vertices(surface)
    try:
        hull = ConvexHull(points)
    except QhullError as error:
        raise ValueError("a flat mesh") from error
    corners = points[hull.vertices]
    number = np.full(len(points), -1)
    number[hull.vertices] = np.arange(len(hull.vertices))
    triangles = number[hull.simplices]
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    middle = corners.mean(axis=0)
    inradius = -(hull.equations[:, :3] @ middle + hull.equations[:, 3]).max()
    scale = np.full(3, max(1.0 - BALL / inradius, 0.0))
    return Core(convex.HULL, np.zeros(3), scale, 0.0, middle, corners - middle, edges)


def together(cores: Sequence[Core]) -> Convex:
    """Cores as arrays."""
    first = np.cumsum([0, *(len(core.corners) for core in cores)], dtype=np.int64)
    corners = np.concatenate([np.zeros((0, 3)), *(core.corners for core in cores)])
    edges = np.concatenate(
        [
            np.zeros((0, 2), dtype=np.int64),
            *(core.edges + f for core, f in zip(cores, first[:-1], strict=True)),
        ]
    ).astype(np.int64)
    both = np.unique(np.concatenate([edges, edges[:, ::-1]]), axis=0)
    beside = np.searchsorted(both[:, 0], np.arange(len(corners) + 1)).astype(np.int64)
    return Convex(
        np.array([core.kind for core in cores], dtype=np.int64),
        np.array([core.size for core in cores], dtype=float).reshape(-1, 3),
        np.array([core.inner for core in cores], dtype=float).reshape(-1, 3),
        np.array([core.round for core in cores], dtype=float),
        first,
        np.ascontiguousarray(corners, dtype=float),
        beside,
        np.ascontiguousarray(both[:, 1]),
    )
