"""A constant screw between two poses in Meshcat: the path along it, its axis, the turn about it."""

from __future__ import annotations

import numpy as np
from pydrake.geometry import Meshcat

from drake_screw.screws import sclerp_position, screw_between
from drake_screw.typing import Array
from drake_screw.visualization import meshes, screw_shapes
from drake_screw.visualization.drawing import draw

AXIS = "#5b3fa8"
FAR_AXIS = 1.0
"""m. A screw whose axis lies farther from the end effector than this looks straight."""
STRAIGHT = 0.02
"""rad. A screw that turns less than this looks straight, too."""


def axis_distance(X_WA: Array, X_WB: Array) -> float:
    """Distance in m of the way from pose A to pose B (4, 4) from the axis of its screw."""
    screw = screw_between(X_WA, X_WB)
    middle = (X_WA[:3, 3] + X_WB[:3, 3]) / 2.0
    return float(np.linalg.norm(np.cross(middle - screw.point, screw.axis)))


def looks_straight(X_WA: Array, X_WB: Array) -> bool:
    """Whether a screw looks like a translation: it hardly turns, or about a far axis."""
    return float(screw_between(X_WA, X_WB).angle) < STRAIGHT or axis_distance(X_WA, X_WB) > FAR_AXIS


def screw_track(X_WA: Array, X_WB: Array, first: float = 0.0, last: float = 1.0) -> Array:
    """Points (m, 3) in m on the path of the end effector, from one screw parameter to another."""
    if last <= first:
        return np.zeros((0, 3))
    p_WE = sclerp_position(X_WA, X_WB, np.linspace(first, last, 41))
    return p_WE[np.append(True, np.linalg.norm(np.diff(p_WE, axis=0), axis=1) > 1e-6)]


def draw_screw(meshcat: Meshcat, path: str, X_WA: Array, X_WB: Array, color: str) -> None:
    """The axis with a helix around it that shows angle, sense and pitch of the screw.

    A screw that looks straight gets an arrow beside the end effector's path instead.

    Args:
        meshcat: drawn into.
        path: of the scene tree.
        X_WA, X_WB: (4, 4) poses that the screw leads between.
        color: of the helix.
    """
    screw = screw_between(X_WA, X_WB)
    p_A, p_B = X_WA[:3, 3], X_WB[:3, 3]
    if looks_straight(X_WA, X_WB):
        lift = np.array([0.0, 0.0, 0.03])
        if np.linalg.norm(p_B - p_A) > 0.01:
            line = screw_shapes.arrow(p_A + lift, p_B + lift, 0.005)
            draw(meshcat, f"{path}/direction", line, AXIS)
        return
    axis, translation = screw.axis, float(screw.translation)
    begin = screw.point + axis * (axis @ (p_A - screw.point))
    low, high = min(translation, 0.0), max(translation, 0.0)
    line = screw_shapes.arrow(begin + (low - 0.11) * axis, begin + (high + 0.13) * axis, 0.006)
    draw(meshcat, f"{path}/axis", line, AXIS)
    across = p_A - begin
    length = float(np.linalg.norm(across))
    first = across / length if length > 1e-6 else screw_shapes.along(axis)[:, 0]
    helix = screw_shapes.turning(axis, begin, first, float(screw.angle), translation, 0.006)
    draw(meshcat, f"{path}/turn", helix, color)
    if length > screw_shapes.RADIUS:
        draw(meshcat, f"{path}/spoke", meshes.tube([begin, p_A], 0.002), AXIS, 0.4)
