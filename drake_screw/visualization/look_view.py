"""A look at a recording in three dimensions, as a picture that needs no renderer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d.axes3d import Axes3D

from drake_screw.demonstrations import Look
from drake_screw.robot import ObjectConfig
from drake_screw.screws import screw_between
from drake_screw.typing import Array
from drake_screw.visualization.drawing import AXES
from drake_screw.visualization.look_figures import WIDTH, object_color
from drake_screw.visualization.palette import INK, QUIET
from drake_screw.visualization.screw_drawing import AXIS, looks_straight, screw_track

TRIAD = 0.03
"""m, arms of a guiding pose."""


def view_figure(look: Look, objects: Sequence[ObjectConfig]) -> Figure:
    """The end effector's path, the objects, the guiding poses, and the screws with their axes.

    Beside it, from the first guiding pose to the last, the same from nearby.

    Args:
        look: at the recording.
        objects: how they look, in their order.
    """
    figure = Figure(figsize=(WIDTH, 5.0))
    p_WE = look.X_WE[:, :3, 3]
    left = 0.0 if look.screws else 0.25
    whole = figure.add_axes((left, 0.1, 0.46, 0.9), **_AXES)
    _draw(whole, look, p_WE, np.concatenate([p_WE, look.X_WO[:, :3, 3]]))
    for item, X in zip(objects, look.X_WO, strict=True):
        _draw_bowl(whole, item, X)
    titles = {"y": 0.96, "ha": "center", "va": "top", "fontsize": 9, "color": INK}
    figure.text(left + 0.25, s="as a whole", **titles)
    if look.screws:
        figure.text(0.74, s="from the first guiding pose to the last", **titles)
        near = figure.add_axes((0.5, 0.1, 0.46, 0.9), **_AXES)
        first, last = look.screws[0].start, look.screws[-1].end
        p_near = p_WE[(look.t >= first) & (look.t <= last)]
        _draw(near, look, p_near, np.concatenate([p_near, look.guides[:, :3, 3]]))
    figure.legend(handles=_handles(look), loc="lower center", ncols=8, frameon=False, fontsize=8.5)
    return figure


_AXES = {"projection": "3d", "computed_zorder": False}


def _draw(ax: Axes3D, look: Look, p_WE: Array, points: Array) -> None:
    """A part of the path (m, 3), the screws and the guiding poses; with room for `points`."""
    low, high = points.min(axis=0) - 0.05, points.max(axis=0) + 0.05
    _frame(ax, low, high)
    ax.plot(*p_WE.T, color=QUIET, linewidth=1.0, gid="path")
    for segment in look.screws:
        track = screw_track(segment.X_WA, segment.X_WB)
        ax.plot(*track.T, color=object_color(segment.object), linewidth=2.4, gid="screw")
        _draw_axis(ax, segment.X_WA, segment.X_WB, low, high)
    for X in look.guides:
        for axis, color in enumerate(AXES):
            arm = np.stack([X[:3, 3], X[:3, 3] + TRIAD * X[:3, axis]])
            ax.plot(*arm.T, color=color, linewidth=1.4)
    ends = {"markersize": 6, "markeredgecolor": INK, "linestyle": ""}
    ax.plot(*p_WE[:1].T, marker="o", color="white", gid="start", **ends)
    ax.plot(*p_WE[-1:].T, marker="s", color=INK, gid="end", **ends)


def _draw_bowl(ax: Axes3D, item: ObjectConfig, X_WO: Array) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 49)
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
    for radius, height in ((0.5, 0.0), (0.8, 0.4), (1.0, 1.0)):
        ring = circle * radius * item.radius + [0.0, 0.0, height * item.height]
        ax.plot(*(ring @ X_WO[:3, :3].T + X_WO[:3, 3]).T, color=INK, linewidth=1.1)
    ax.text(*(X_WO[:3, 3] - [0.0, 0.0, 0.09]), item.name, fontsize=9, color=INK, ha="center")


def _draw_axis(ax: Axes3D, X_WA: Array, X_WB: Array, low: Array, high: Array) -> None:
    """The axis of a screw beside the end effector, unless it is outside the picture."""
    screw = screw_between(X_WA, X_WB)
    begin = screw.point + screw.axis * (screw.axis @ (X_WA[:3, 3] - screw.point))
    if looks_straight(X_WA, X_WB) or ((begin < low) | (begin > high)).any():
        return
    reach = np.array([-0.06, 0.08])[:, None] * screw.axis
    ax.plot(*(begin + reach).T, color=AXIS, linewidth=1.0, gid="axis")
    ax.plot(*(begin + reach[1:]).T, marker=".", color=AXIS, markersize=5)


def _frame(ax: Axes3D, low: Array, high: Array) -> None:
    """Equal scales, seen from in front of the robot and from its left."""
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    ax.set_box_aspect(high - low, zoom=0.86)
    ax.view_init(elev=22.0, azim=-35.0)
    ax.set_xlabel("x (m)", fontsize=8.5)
    ax.set_ylabel("y (m)", fontsize=8.5)
    ax.set_zlabel("z (m)", fontsize=8.5)
    ax.tick_params(labelsize=7.5)
    ax.locator_params(nbins=5)


def _handles(look: Look) -> list[Line2D]:
    ring = {"marker": "o", "color": "white", "markeredgecolor": INK, "linestyle": ""}
    handles = [Line2D([], [], color=QUIET, label="path as recorded")]
    for i in dict.fromkeys(segment.object for segment in look.screws):
        label = f"screws of the {look.shown.names[i]}"
        handles.append(Line2D([], [], color=object_color(i), linewidth=2.6, label=label))
    if look.screws:
        handles.append(Line2D([], [], color=AXIS, marker=".", label="screw axis"))
    handles.append(Line2D([], [], **ring, label="start"))
    handles.append(Line2D([], [], **(ring | {"marker": "s", "color": INK}), label="end"))
    return handles
