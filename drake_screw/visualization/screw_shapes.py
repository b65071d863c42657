"""Shapes that show screws and joints: axes, helices with an arrow head, dials of joint ranges."""

from __future__ import annotations

import numpy as np

from drake_screw.typing import Array
from drake_screw.visualization.meshes import Mesh, join, lathe, tube

RADIUS = 0.06
"""m. Of the helix that is drawn around a screw's axis."""


def along(direction: Array) -> Array:
    """A rotation (3, 3) whose z axis is a unit vector (3,)."""
    x = np.cross(np.eye(3)[np.abs(direction).argmin()], direction)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(direction, x), direction], axis=-1)


def arrow(start: Array, end: Array, thickness: float) -> Mesh:
    """An arrow between two points (3,) in m: a shaft, and a head where there is room for one."""
    way = end - start
    length = float(np.linalg.norm(way))
    head = min(4.0 * thickness, 0.6 * length)
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = along(way / max(length, 1e-12)), start
    profile = [
        [0.0, 0.0],
        [thickness / 2.0, 0.0],
        [thickness / 2.0, length - head],
        [1.4 * thickness, length - head],
        [0.0, length],
    ]
    return lathe(profile, sides=16).moved(X)


def turning(
    axis: Array, point: Array, first: Array, angle: float, translation: float, thickness: float
) -> Mesh:
    """A helix about a screw's axis with an arrow head: its angle, its sense and its pitch.

    Args:
        axis: (3,) unit direction.
        point: (3,) m, on the axis where the motion begins.
        first: (3,) unit vector across the axis, towards where the helix begins.
        angle: rad, at least a little.
        translation: m, along the axis.
        thickness: m, of the line.
    """
    s = np.linspace(0.0, 1.0, max(8, int(np.ceil(angle / 0.08))))
    other = np.cross(axis, first)
    c, d = np.cos(angle * s)[:, None], np.sin(angle * s)[:, None]
    helix = point + RADIUS * (c * first + d * other) + (translation * s)[:, None] * axis
    length = max(float(np.linalg.norm(np.diff(helix, axis=0), axis=1).sum()), 1e-9)
    head = min(5.0 * thickness / length, 0.5)
    cut = max(2, int(np.searchsorted(s, 1.0 - head)))
    tip = arrow_head(helix[cut - 1], helix[-1], 1.6 * thickness)
    return join([tube(helix[:cut], thickness, sides=8), tip])


def arrow_head(base: Array, tip: Array, radius: float) -> Mesh:
    """A cone from a base to a tip (3,)."""
    length = float(np.linalg.norm(tip - base))
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = along((tip - base) / max(length, 1e-12)), base
    return lathe([[0.0, 0.0], [radius, 0.0], [0.0, length]], sides=16).moved(X)


def sector(inner: float, outer: float, lower: float, upper: float, thickness: float) -> Mesh:
    """A flat piece of a ring about z, from one angle about z to another, centred on z = 0."""
    count = max(2, int(np.ceil((upper - lower) / 0.06)) + 1)
    angle = np.linspace(lower, upper, count)
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], axis=-1)
    lift = np.array([0.0, 0.0, thickness / 2.0])
    rows = [inner * circle - lift, outer * circle - lift, outer * circle + lift]
    rows.append(inner * circle + lift)
    vertices = np.stack(rows, axis=1).reshape(-1, 3)
    corner = np.arange(4)
    quads = [
        np.stack([4 * i + corner, 4 * i + (corner + 1) % 4], axis=-1) for i in range(count - 1)
    ]
    faces = [
        triangle
        for row in quads
        for a, b in row.tolist()
        for triangle in ((a, b + 4, b), (a, a + 4, b + 4))
    ]
    last = 4 * (count - 1)
    faces += [(0, 1, 2), (0, 2, 3), (last, last + 2, last + 1), (last, last + 3, last + 2)]
    return Mesh(vertices, np.array(faces, dtype=np.int32))
