"""Meshes into Meshcat, in the colours of the palette."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from pydrake.geometry import Meshcat, Rgba

from drake_screw.visualization import meshes
from drake_screw.visualization.meshes import Mesh

AXES = ("#d81b60", "#2e9e4f", "#1e6fd9")
"""Of the x, y and z axis of a frame."""


def draw(meshcat: Meshcat, path: str, mesh: Mesh, color: str, opacity: float = 1.0) -> None:
    """Put a mesh at a path of the scene tree."""
    meshcat.SetTriangleMesh(path, mesh.vertices.T, mesh.faces.T, rgba(color, opacity))


def draw_frames(meshcat: Meshcat, path: str, X_WF: ArrayLike, *, size: float = 0.035) -> None:
    """Frames (f, 4, 4) as triads with arms of `size` m."""
    X_WF = np.asarray(X_WF, dtype=float)
    for axis, color in enumerate(AXES):
        arms = [meshes.tube([X[:3, 3], X[:3, 3] + size * X[:3, axis]], size / 7.0) for X in X_WF]
        if arms:
            draw(meshcat, f"{path}/{'xyz'[axis]}", meshes.join(arms), color)


def rgba(color: str, opacity: float = 1.0) -> Rgba:
    """A colour as Meshcat's materials take it."""
    from matplotlib.colors import to_rgb  # takes long to import

    return Rgba(*to_rgb(color), opacity)
