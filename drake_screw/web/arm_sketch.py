"""The arm as a stick figure, from above and from the side: a picture that needs no renderer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from drake_screw.robot import ObjectConfig, ObstacleConfig, TableConfig, ToolConfig
from drake_screw.screws import sclerp_position
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array
from drake_screw.visualization.attempt import FAILED, Attempt
from drake_screw.visualization.linkage import Linkage
from drake_screw.visualization.outlines import convex_outline, outlines, widened
from drake_screw.visualization.palette import INK, STATUS_COLORS

_WOOD, _CLAY, _STONE, _STEEL, _QUIET = "#e3d9c6", "#f4c95d", "#cdd1d8", "#a9c4e4", "#b9bcc8"

BESIDE = 0.3
"""m, that obstacles are shown of beyond all else."""

UPRIGHT = np.cos(0.02)
"""Cosine of the tilt from which on an object is drawn as the cylinder it is."""


def arm_sketch(
    attempt: Attempt,
    linkage: Linkage,
    area: WorkArea,
    objects: Sequence[ObjectConfig],
    table: TableConfig | None,
    obstacles: Sequence[ObstacleConfig] = (),
    tool: ToolConfig | None = None,
) -> Markup:
    """Two views as SVG: the arm at its start, on its way, and where the plan ended.

    What it holds is drawn at both ends where it has a shape.
    """
    around = (area, objects, table, obstacles)
    held = _held(attempt, tool)
    chosen = attempt.samples(7)
    q = attempt.plan.q[chosen]
    joints = np.stack([linkage.joint_frames(j, q)[:, :3, 3] for j in range(attempt.arm.n)], axis=1)
    end = attempt.arm.pose(q)[:, None, :3, 3]
    bodies = np.concatenate([joints, end], axis=1)
    above = _view(attempt, bodies, held, *around, np.array([[0, -1, 0], [-1, 0, 0]]))
    side = _view(attempt, bodies, held, *around, np.array([[1, 0, 0], [0, 0, -1]]))
    return Markup(
        f'<figure class="sketch">{above}<figcaption>from above</figcaption></figure>'
        f'<figure class="sketch">{side}<figcaption>from its right side</figcaption></figure>'
    )


def _view(
    attempt: Attempt,
    bodies: Array,
    held: Sequence[Array],
    area: WorkArea,
    objects: Sequence[ObjectConfig],
    table: TableConfig | None,
    obstacles: Sequence[ObstacleConfig],
    P: Array,
) -> str:
    """One view; P (2, 3) takes a point in W to the drawing's right and down, in m.

    `held` are corners (v, 3) in W of the tool, wherever it is to be drawn.
    """
    parts: list[str] = []
    corners = [bodies.reshape(-1, 3), attempt.guides[:, :3, 3], attempt.X_WO[:, :3, 3]]
    upright = abs(P[1, 2]) > 0.5
    if table is not None:
        half = np.array(table.size) / 2.0
        low = np.array([*(np.array(table.center) - half), table.top - table.thickness])
        high = np.array([*(np.array(table.center) + half), table.top])
        parts.append(_box(P @ low, P @ high, _WOOD, "none"))
        corners.append(np.array([low, high]))
    things = outlines(obstacles, P)
    parts += [_polygon(seen.corners, _STONE) for seen in things]
    if not upright:
        for i, item in enumerate(area.objects):
            low, high = np.array([*item.lower[:2], 0.0]), np.array([*item.upper[:2], 0.0])
            X_WP = area.X_WP(i)
            low, high = (X_WP[:3, :3] @ p + X_WP[:3, 3] for p in (low, high))
            parts.append(_box(P @ low, P @ high, "none", INK))
    for shape, X in zip(objects, attempt.X_WO, strict=True):
        if X[2, 2] < UPRIGHT:
            parts.append(_polygon(convex_outline(_rims(shape, X) @ P.T), _CLAY))
            continue
        x, y = 1e3 * (P @ X[:3, 3])
        r, h = 1e3 * shape.radius, 1e3 * shape.height
        parts.append(
            f'<path d="M{x - r:.0f} {y - h:.0f}h{2 * r:.0f}l{-0.5 * r:.0f} {h:.0f}h{-r:.0f}z" '
            f'fill="{_CLAY}" stroke="{INK}" stroke-width="4"/>'
            if upright
            else f'<circle cx="{x:.0f}" cy="{y:.0f}" r="{r:.0f}" fill="{_CLAY}" stroke="{INK}" '
            'stroke-width="4"/>'
        )
    parts += [_polygon(convex_outline(p @ P.T), _STEEL) for p in held]
    parts += [_line(body @ P.T, _QUIET, 9, 0.6) for body in bodies[1:-1]]
    parts.append(_line(bodies[0] @ P.T, INK, 16))
    color = INK if attempt.plan.success else STATUS_COLORS[FAILED]
    parts.append(_line(bodies[-1] @ P.T, color, 16))
    for x, y in 1e3 * bodies[-1] @ P.T:
        parts.append(
            f'<circle cx="{x:.0f}" cy="{y:.0f}" r="13" fill="#fff" stroke="{color}" '
            'stroke-width="6"/>'
        )
    if attempt.failed_joint is not None:
        x, y = 1e3 * P @ bodies[-1, attempt.failed_joint]
        parts.append(
            f'<circle cx="{x:.0f}" cy="{y:.0f}" r="42" fill="none" stroke="{color}" '
            'stroke-width="12"/>'
        )
    s = np.linspace(0.0, 1.0, 21)
    for segment, status in enumerate(attempt.status):
        track = sclerp_position(attempt.starts[segment], attempt.guides[segment], s)
        parts.append(_line(track @ P.T, STATUS_COLORS[status], 10))
    flat = np.concatenate([*corners, *held]) @ P.T
    low, high = widened(flat.min(axis=0), flat.max(axis=0), things, BESIDE)
    (left, top), (right, bottom) = 1e3 * low - 60, 1e3 * high + 60
    return (
        f'<svg viewBox="{left:.0f} {top:.0f} {right - left:.0f} {bottom - top:.0f}">'
        f"{''.join(parts)}</svg>"
    )


def _held(attempt: Attempt, tool: ToolConfig | None) -> list[Array]:
    """Corners (v, 3) in W of what the end effector holds, at the start and where the plan ended."""
    if tool is None:
        return []
    X_ET = attempt.arm.held(tool.frame) @ tool.X_FT.GetAsMatrix4()
    p_TP = tool.shape.corners()
    X_WT = attempt.arm.pose(attempt.plan.q[[0, -1]]) @ X_ET
    return [p_TP @ X[:3, :3].T + X[:3, 3] for X in X_WT]


def _rims(shape: ObjectConfig, X_WO: Array) -> Array:
    """(48, 3) m, points of the rims of an object's cylinder in W."""
    angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    x, y = shape.radius * np.cos(angle), shape.radius * np.sin(angle)
    rims = [np.stack([x, y, np.full_like(x, z)], axis=-1) for z in (0.0, shape.height)]
    return np.concatenate(rims) @ X_WO[:3, :3].T + X_WO[:3, 3]


def _line(points: Array, color: str, width: float, opacity: float = 1.0) -> str:
    text = " ".join(f"{x:.0f},{y:.0f}" for x, y in 1e3 * points)
    return (
        f'<polyline points="{text}" fill="none" stroke="{color}" stroke-width="{width:g}" '
        f'stroke-linejoin="round" stroke-linecap="round" opacity="{opacity:g}"/>'
    )


def _polygon(corners: Array, fill: str) -> str:
    text = " ".join(f"{x:.0f},{y:.0f}" for x, y in 1e3 * corners)
    return f'<polygon points="{text}" fill="{fill}" stroke="{INK}" stroke-width="5"/>'


def _box(first: Array, second: Array, fill: str, stroke: str) -> str:
    (x, y), (u, v) = 1e3 * np.minimum(first, second), 1e3 * np.maximum(first, second)
    return (
        f'<rect x="{x:.0f}" y="{y:.0f}" width="{u - x:.0f}" height="{v - y:.0f}" fill="{fill}" '
        f'stroke="{stroke}" stroke-width="5"/>'
    )
