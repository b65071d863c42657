"""A robot model whose collision shapes are meshes, from one whose shapes are primitives."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

from drake_screw.typing import Array

DRAKE = "drake.mit.edu"
"""The namespace of what SDF has from Drake."""

POINTS = 502
"""Of a mesh: a closed one of triangles has 2 (POINTS - 2) of these."""

EDGES = 16.0
"""Norm whose unit ball stands for a box; its edges are round, and all its points corners."""


def mesh_arm(model: Path, folder: Path) -> Path:
    """Write a model (SDF) with a mesh of 1,000 triangles in place of every collision shape.

    A mesh lies within the shape, and comes near it.
    """
    ET.register_namespace("drake", DRAKE)
    tree = ET.parse(model)
    for number, collision in enumerate(tree.iter("collision")):
        geometry = collision.find("geometry")
        assert geometry is not None
        points = _points(geometry[0])
        if points is None:
            continue
        file = folder / f"shape_{number}.obj"
        _write(file, points)
        geometry.clear()
        ET.SubElement(ET.SubElement(geometry, "mesh"), "uri").text = file.name
    written = folder / model.name
    tree.write(written)
    return written


def _points(shape: ET.Element) -> Array | None:
    """Points (POINTS, 3) in m of a shape's surface; None of what is no primitive."""

    def number(name: str) -> float:
        return float(shape.findtext(name, ""))

    i = np.arange(POINTS) + 0.5
    z, turn = 1.0 - 2.0 * i / POINTS, np.pi * (1.0 + 5.0**0.5) * i
    way = np.column_stack([np.cos(turn) * (1 - z * z) ** 0.5, np.sin(turn) * (1 - z * z) ** 0.5, z])
    across = np.hypot(way[:, 0], way[:, 1])
    match shape.tag.removeprefix(f"{{{DRAKE}}}"):
        case "sphere":
            return way * number("radius")
        case "box":
            size = np.array(shape.findtext("size", "").split(), dtype=float)
            return way / np.linalg.norm(way, ord=EDGES, axis=1)[:, None] * size / 2.0
        case "cylinder":
            norm = (across**EDGES + abs(way[:, 2]) ** EDGES) ** (1.0 / EDGES)
            radius = number("radius")
            return way / norm[:, None] * [radius, radius, number("length") / 2.0]
        case "capsule":
            ends = np.sign(way[:, 2:]) * [0.0, 0.0, number("length") / 2.0]
            return way * number("radius") + ends
        case "ellipsoid":
            radii = np.array(shape.findtext("radii", "").split(), dtype=float)
            return way * radii
        case _:
            return None


def _write(file: Path, points: Array) -> None:
    """The convex hull of points as an .obj file, its triangles seen from outside."""
    hull = ConvexHull(points)
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points]
    for face, equation in zip(hull.simplices, hull.equations, strict=True):
        a, b, c = points[face]
        outward = np.cross(b - a, c - a) @ equation[:3] > 0.0
        lines.append("f " + " ".join(str(k + 1) for k in (face if outward else face[::-1])))
    file.write_text("\n".join(lines) + "\n")
