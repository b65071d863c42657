"""Triangle meshes for what Meshcat has no shape of."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.typing import Array


@dataclass(frozen=True, eq=False)
class Mesh:
    """Vertices (v, 3) in m and triangles (f, 3) of indices into them."""

    vertices: Array
    faces: NDArray[np.int32]

    def moved(self, X: ArrayLike) -> Mesh:
        """The mesh at the pose X (4, 4)."""
        X = np.asarray(X, dtype=float)
        return Mesh(self.vertices @ X[:3, :3].T + X[:3, 3], self.faces)


def join(meshes: Iterable[Mesh]) -> Mesh:
    """Several meshes, at least one, as one."""
    meshes = list(meshes)
    first = np.cumsum([0] + [len(m.vertices) for m in meshes[:-1]])
    faces = [m.faces + start for m, start in zip(meshes, first, strict=True)]
    vertices = np.concatenate([m.vertices for m in meshes])
    return Mesh(vertices, np.concatenate(faces).astype(np.int32))


def lathe(profile: ArrayLike, sides: int = 48) -> Mesh:
    """A profile (p, 2) of radius and height turned about the z axis."""
    profile = np.asarray(profile, dtype=float)
    angle = np.arange(sides) * 2.0 * np.pi / sides
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    plane = profile[:, None, :1] * circle
    height = np.broadcast_to(profile[:, None, 1:], (*plane.shape[:2], 1))
    vertices = np.concatenate([plane, height], axis=-1).reshape(-1, 3)
    return Mesh(vertices, _strip(len(profile), sides))


def bowl(radius: float, height: float) -> Mesh:
    """A bowl open on top, its foot on z = 0 and its axis on z; radius of the rim."""
    foot, wall = 0.5 * radius, 0.06 * radius
    angle = np.linspace(0.0, np.pi / 2.0, 14)
    r = foot + (radius - foot) * np.sin(angle)
    z = 0.1 * height + 0.9 * height * (1.0 - np.cos(angle))
    outer = np.stack([r, z], axis=-1)
    inner = np.stack([np.maximum(r - wall, 0.0), np.minimum(z + wall, height)], axis=-1)[::-1]
    return lathe(np.vstack([[0.0, 0.0], [foot, 0.0], outer, inner, [0.0, inner[-1, 1]]]))


def ring(radius: float, thickness: float) -> Mesh:
    """A torus about the z axis, lying on z = 0; `radius` to the middle of its tube."""
    angle = np.linspace(0.0, 2.0 * np.pi, 13)
    half = thickness / 2.0
    return lathe(np.stack([radius + half * np.cos(angle), half * (1.0 + np.sin(angle))], axis=-1))


def disc(radius: float, thickness: float) -> Mesh:
    """A flat disc about the z axis, lying on z = 0."""
    return lathe([[radius, 0.0], [radius, thickness], [0.0, thickness]], sides=32)


def tube(path: ArrayLike, thickness: float, sides: int = 6) -> Mesh:
    """A tube along a path (m, 3) of at least two points, neighbours different."""
    path = np.asarray(path, dtype=float)
    tangent = np.gradient(path, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-12)
    across = np.empty_like(path)
    side = np.eye(3)[np.abs(tangent[0]).argmin()]
    for i, t in enumerate(tangent):
        side = side - t * (side @ t)
        side = side / max(float(np.linalg.norm(side)), 1e-12)
        across[i] = side
    upward = np.cross(tangent, across)
    angle = np.arange(sides) * 2.0 * np.pi / sides
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    vertices = path[:, None] + thickness / 2.0 * (c * across[:, None] + s * upward[:, None])
    return Mesh(vertices.reshape(-1, 3), _strip(len(path), sides))


def rectangles(lower: ArrayLike, upper: ArrayLike, z: float) -> Mesh:
    """Upright-facing rectangles with corners (c, 2) at height z, four vertices each, in order."""
    (x0, y0), (x1, y1) = np.asarray(lower, dtype=float).T, np.asarray(upper, dtype=float).T
    corners = np.stack([x0, y0, x1, y0, x1, y1, x0, y1], axis=-1).reshape(-1, 2)
    vertices = np.column_stack([corners, np.full(len(corners), z)])
    first = 4 * np.arange(len(x0))[:, None, None]
    faces = (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
    return Mesh(vertices, faces.astype(np.int32))


def frame(lower: ArrayLike, upper: ArrayLike, z: float, line: float) -> Mesh:
    """The outline of a rectangle with corners (2,), `line` m wide, inside of it."""
    (x0, y0), (x1, y1) = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    low = [[x0, y0], [x0, y1 - line], [x0, y0 + line], [x1 - line, y0 + line]]
    high = [[x1, y0 + line], [x1, y1], [x0 + line, y1 - line], [x1, y1 - line]]
    return rectangles(low, high, z)


_SEGMENTS = {
    "a": ((0.0, 0.9), (0.5, 1.0)),
    "b": ((0.4, 0.5), (0.5, 1.0)),
    "c": ((0.4, 0.0), (0.5, 0.5)),
    "d": ((0.0, 0.0), (0.5, 0.1)),
    "e": ((0.0, 0.0), (0.1, 0.5)),
    "f": ((0.0, 0.5), (0.1, 1.0)),
    "g": ((0.0, 0.45), (0.5, 0.55)),
}
_DIGITS = ("abcdef", "bc", "abged", "abgcd", "fgbc", "afgcd", "afgecd", "abc", "abcdefg", "abcdfg")


def number(value: int, height: float) -> Mesh:
    """A number >= 0 in the strokes of a pocket calculator, flat on z = 0 and centred.

    It reads from left to right along x, its top towards y.
    """
    digits = str(value)
    strokes = [
        np.array(_SEGMENTS[stroke]) + np.array([0.75 * i, 0.0])
        for i, digit in enumerate(digits)
        for stroke in _DIGITS[int(digit)]
    ]
    middle = np.array([(0.75 * (len(digits) - 1) + 0.5) / 2.0, 0.5])
    corners = (np.array(strokes) - middle) * height
    return rectangles(corners[:, 0], corners[:, 1], 0.0)


def _strip(rows: int, sides: int) -> NDArray[np.int32]:
    """Triangles between neighbouring rows of a closed band of vertices."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(sides), indexing="ij")
    a, b = i * sides + j, i * sides + (j + 1) % sides
    faces = np.stack([a, b, b + sides, a, b + sides, a + sides], axis=-1)
    return faces.reshape(-1, 3).astype(np.int32)
