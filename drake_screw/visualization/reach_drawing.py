"""How far an arm's wrist gets, in Meshcat."""

from __future__ import annotations

import numpy as np
from pydrake.geometry import Meshcat

from drake_screw.typing import Array
from drake_screw.visualization import meshes
from drake_screw.visualization.attempt import FAILED
from drake_screw.visualization.drawing import draw
from drake_screw.visualization.meshes import Mesh
from drake_screw.visualization.palette import ACCENT, INK, STATUS_COLORS
from drake_screw.visualization.screw_shapes import along
from drake_screw.visualization.unreachable import Unreachable

OPENING = 0.30
"""rad. Half the angle under which the part of the sphere of reach is seen from the shoulder."""


def draw_reach(meshcat: Meshcat, path: str, found: Unreachable) -> None:
    """Shoulder and wrist, the line between them, and what of the reach lies before the wrist.

    Under `path`: ``shoulder``, ``wrist`` and ``line``; ``sphere``, the part of the sphere of reach
    that is nearest to where the guiding pose asks for the wrist; ``asked``, that place, and
    ``gap``, the way to it. Nothing of an arm that has no wrist.

    Args:
        meshcat: drawn into.
        path: of the scene tree.
        found: what is known of the plan's end.
    """
    if found.wrist is None:
        return
    wrist, color = found.wrist, STATUS_COLORS[FAILED]
    p_WC, asked = found.p_WC
    draw(meshcat, f"{path}/shoulder", _ball(wrist.p_WS, 0.035), INK)
    draw(meshcat, f"{path}/wrist", _ball(p_WC, 0.030), color)
    draw(meshcat, f"{path}/line", meshes.tube([wrist.p_WS, p_WC], 0.014, sides=10), color)
    draw(meshcat, f"{path}/asked", _ball(asked, 0.030), ACCENT)
    if np.linalg.norm(asked - p_WC) > 1e-3:
        draw(meshcat, f"{path}/gap", meshes.tube([p_WC, asked], 0.014, sides=10), ACCENT)
    way = asked - wrist.p_WS
    radius = wrist.most if np.linalg.norm(way) > wrist.least else wrist.least
    draw(meshcat, f"{path}/sphere", _cap(wrist.p_WS, way, radius), color, 0.3)


def _ball(p: Array, radius: float) -> Mesh:
    angle = np.linspace(0.0, np.pi, 13)
    profile = np.stack([radius * np.sin(angle), -radius * np.cos(angle)], axis=-1)
    return meshes.lathe(profile, sides=24).moved(_at(p, np.array([0.0, 0.0, 1.0])))


def _cap(p: Array, way: Array, radius: float) -> Mesh:
    """The part of a sphere about p in a direction."""
    angle = np.linspace(OPENING, 0.0, 13)
    profile = radius * np.stack([np.sin(angle), np.cos(angle)], axis=-1)
    return meshes.lathe(profile).moved(_at(p, way / max(float(np.linalg.norm(way)), 1e-9)))


def _at(p: Array, direction: Array) -> Array:
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = along(direction), p
    return X
