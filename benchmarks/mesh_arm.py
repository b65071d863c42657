"""A robot model whose collision shapes are meshes, from one whose shapes are primitives."""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

from drake_screw.typing import Array

DRAKE = "drake.mit.edu"
"""The namespace of what SDF has from Drake."""

BULGE = 0.01
"""Of a shape's size, by which flat faces bulge, so that all points of a mesh are corners."""

ROUND = 1.005
"""Of a circle's radius, at which corners stand that it lies within."""


def mesh_arm(model: Path, folder: Path) -> Path:
    """Write a model (SDF) with a mesh of 1,000 triangles in place of every collision shape.

    A shape lies within its mesh, which is larger by a hundredth at most.
    """
    ET.register_namespace("drake", DRAKE)
    tree = ET.parse(model)
    for number, collision in enumerate(tree.iter("collision")):
        geometry = collision.find("geometry")
        assert geometry is not None
        points = _points(geometry[0])
        if points is None:
            continue
        file = write_obj(folder / f"shape_{number}.obj", points)
        geometry.clear()
        ET.SubElement(ET.SubElement(geometry, "mesh"), "uri").text = file.name
    written = folder / model.name
    tree.write(written)
    return written


def _points(shape: ET.Element) -> Array | None:
    """Points (p, 3) in m about a shape's surface; None of what is no primitive."""

    def number(name: str) -> float:
        return float(shape.findtext(name, ""))

    match shape.tag.removeprefix(f"{{{DRAKE}}}"):
        case "sphere":
            return _ball() * number("radius")
        case "box":
            size = np.array(shape.findtext("size", "").split(), dtype=float)
            return _bulging(_cube()) * size / 2.0
        case "cylinder":
            radius = ROUND * number("radius")
            return _bulging(_can()) * [radius, radius, number("length") / 2.0]
        case "capsule":
            way = _ball()
            ends = np.sign(way[:, 2:]) * [0.0, 0.0, number("length") / 2.0]
            return way * number("radius") + ends
        case "ellipsoid":
            radii = np.array(shape.findtext("radii", "").split(), dtype=float)
            return _ball() * radii
        case _:
            return None


def _ball() -> Array:
    """Points about a sphere of radius 1, evenly spread on a spiral."""
    i = np.arange(502) + 0.5
    z, turn = 1.0 - 2.0 * i / 502, np.pi * (1.0 + 5.0**0.5) * i
    across = np.sqrt(1.0 - z * z)
    return ROUND * np.column_stack([across * np.cos(turn), across * np.sin(turn), z])


def _cube() -> Array:
    """Points of the surface of a cube from -1 to 1."""
    p = np.array(list(itertools.product(np.linspace(-1.0, 1.0, 10), repeat=3)))
    return p[np.abs(p).max(axis=1) == 1.0]


def _can() -> Array:
    """Points of the surface of a cylinder of radius 1 from -1 to 1."""
    rings = [(1.0, z, 36) for z in np.linspace(-1.0, 1.0, 11)]
    rings += [(r, z, n) for z in (-1.0, 1.0) for r, n in ((0.35, 12), (0.7, 24))]
    turns = [(r, z, 2.0 * np.pi * np.arange(n) / n) for r, z, n in rings]
    return np.concatenate(
        [np.column_stack([r * np.cos(a), r * np.sin(a), np.full(len(a), z)]) for r, z, a in turns]
    )


def _bulging(p: Array) -> Array:
    """Points farther out, the more the nearer they are to the middle of a face."""
    return p * (1.0 + BULGE * (3.0 - (p * p).sum(axis=1, keepdims=True)) / 2.0)


def write_obj(file: Path, points: Array) -> Path:
    """A mesh of the convex hull of points (c, 3), its triangles seen from outside."""
    hull = ConvexHull(points)
    lines = [f"v {x} {y} {z}" for x, y, z in points]
    for face, equation in zip(hull.simplices, hull.equations, strict=True):
        a, b, c = points[face]
        outward = np.cross(b - a, c - a) @ equation[:3] > 0.0
        lines.append("f " + " ".join(str(k + 1) for k in (face if outward else face[::-1])))
    file.write_text("\n".join(lines) + "\n")
    return file
