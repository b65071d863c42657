"""Where plans fail: the work area from above, as a person sees it who looks at the robot.

The robot is at the top: x grows downwards, away from it, and y to the right, its left, as in the
3-D view and on the pages' maps.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.patheffects import withStroke

from drake_screw.planning import Cause
from drake_screw.tasks import Regions
from drake_screw.typing import Array
from drake_screw.visualization.cell_text import MARK, write_estimates
from drake_screw.visualization.cells import Axes as PlaneAxes
from drake_screw.visualization.cells import Cells, cells
from drake_screw.visualization.outlines import Outline, draw_outlines, outline_handle, widened
from drake_screw.visualization.palette import (
    ACCENT,
    INK,
    OUTCOME_COLORS,
    OUTCOME_NAMES,
    PAPER,
    failure_color,
    failure_map,
    failure_norm,
)
from drake_screw.visualization.rounds import Round, Sample, sample

MOST_DOTS = 1500
SHAPES = {
    Cause.SUCCESS: ("o", 2.0),
    Cause.JOINT_LIMIT: ("X", 4.2),
    Cause.UNREACHABLE: ("^", 4.0),
    Cause.COLLISION: ("s", 3.4),
    Cause.NOT_TRIED: ("D", 3.0),
    Cause.EXECUTION: ("v", 4.0),
}
GRID = "#b9b4c6"
_ROBOT = 9.0
"""Points that the robot's mark and name take up above a map."""
EDGE = np.array([-1e-9, 1e-9])
"""m, that the numbers of a place at the edge of the area may be beyond it by rounding."""


def draw_heat_map(
    ax: Axes,
    event: Round,
    regions: Regions,
    *,
    dots: int = MOST_DOTS,
    text: bool = True,
    things: Sequence[Outline] = (),
    axes: PlaneAxes | None = None,
    mean: bool = False,
    frame: tuple[Array, Array] | None = None,
) -> Sample:
    """Draw one round into `ax`: estimates, instances, demonstrations, weakest region, suggestion.

    Cells are coloured by estimated failure probability, always on the scale from 0 to 1. Where
    several regions lie above one another a cell shows the worst of them, or the mean.

    Args:
        ax: gets limits, an equal aspect and axis labels.
        event: the round.
        regions: those of the run.
        dots: most instances to draw; more are thinned to a random sample.
        text: write estimates and counts into the cells, numbers at the demonstrations, and names of
            obstacles.
        things: obstacles in the work area or near it; drawn where they lie in the same plane.
        axes: of the plane, `usual_axes` if None.
        mean: show the mean of the regions above one another, not the worst.
        frame: corners (2,) in m or rad of what `ax` shows; `extent` if None.

    Returns:
        The instances that were drawn.
    """
    drawn = cells(regions, event.verdict.estimates, axes)
    shown = sample(event.evaluation, dots)
    _frame(ax, drawn, extent(drawn, things) if frame is None else frame)
    _draw_cells(ax, drawn, event, mean)
    _draw_instances(ax, drawn, shown)
    if text:
        write_estimates(ax, drawn, event, mean=mean)
    if drawn.in_world:
        draw_outlines(ax, things, text=text)
        _draw_robot(ax, text)
    _draw_demonstrations(ax, drawn, event, text)
    if event.suggestion is not None:
        x, y = drawn.place(event.suggestion.coordinates)
        look = _marker("*", ACCENT, 19.0 if text else 11.0, INK)
        ax.plot(y, x, **look, clip_on=False, zorder=8, gid="suggestion")
    return shown


def add_colour_bar(figure: Figure, ax: Axes) -> None:
    """The scale of failure probability, 0 to 1, filling `ax`."""
    ticks = [0.0, 0.01, 0.05, 0.1, 0.2, 0.5, 1.0]
    scale = ScalarMappable(failure_norm(), failure_map())
    bar = figure.colorbar(scale, cax=ax, ticks=ticks, format="{x:g}")
    bar.set_label("failure probability", fontsize=9, color=INK)
    ax.tick_params(labelsize=8)


def legend_handles(
    event: Round, shown: Sample, things: Sequence[Outline] = ()
) -> list[Line2D | Patch]:
    """Legend entries of what a heat map of this round contains."""
    handles: list[Line2D | Patch] = [
        Line2D([], [], **_dot(cause), label=name)
        for cause, name in OUTCOME_NAMES.items()
        if shown.count(cause)
    ]
    if event.verdict.weakest is not None:
        handles.append(Patch(fill=False, edgecolor=INK, linewidth=2.2, label="weakest region"))
    if event.demonstrations:
        handles.append(Line2D([], [], **_marker("o", PAPER, 10.0, INK), label="demonstration"))
    if event.suggestion is not None:
        handles.append(
            Line2D([], [], **_marker("*", ACCENT, 14.0, INK), label="next demonstration")
        )
    if things:
        handles.append(outline_handle())
    return handles


def extent(drawn: Cells, things: Sequence[Outline] = ()) -> tuple[Array, Array]:
    """Corners (2,) in m or rad of what a picture of cells and of things near them shows."""
    if not drawn.in_world:
        return drawn.lower.min(axis=0), drawn.upper.max(axis=0)
    return widened(drawn.lower.min(axis=0), drawn.upper.max(axis=0), things)


def room_above(drawn: Cells) -> float:
    """Points above a map that are kept free of text for the robot's mark and name."""
    return _ROBOT if drawn.in_world else 0.0


def _frame(ax: Axes, drawn: Cells, frame: tuple[Array, Array]) -> None:
    lower, upper = frame
    pad = np.where(upper > lower, 0.0, 0.05)
    ax.set_xlim(lower[1] - pad[1], upper[1] + pad[1])
    ax.set_ylim(lower[0] - pad[0], upper[0] + pad[0])
    if drawn.from_above:
        ax.set_aspect("equal")
        ax.invert_yaxis()
    sideways, along = drawn.label(1), drawn.label(0)
    if drawn.in_world:
        sideways, along = "y in m      to the robot's left →", "← away from the robot      x in m"
    ax.set_xlabel(sideways, fontsize=9, color=INK)
    ax.set_ylabel(along, fontsize=9, color=INK)
    ax.tick_params(labelsize=8)


def _draw_cells(ax: Axes, drawn: Cells, event: Round, mean: bool) -> None:
    estimates = drawn.mean if mean else event.verdict.estimates[drawn.region]
    for cell in range(len(drawn.region)):
        (x0, y0), (x1, y1) = drawn.lower[cell], drawn.upper[cell]
        box = {"xy": (y0, x0), "width": y1 - y0, "height": x1 - x0}
        color = tuple(failure_color(estimates[cell]))
        ax.add_patch(Rectangle(**box, facecolor=color, edgecolor=GRID, gid=f"cell{cell}"))
    region = event.verdict.weakest
    if region is None:
        return
    (x0, y0), (x1, y1) = drawn.outlines[region]
    for edge, line, gid in ((PAPER, 5.0, "halo"), (INK, 2.4, "weakest")):
        style = {"edgecolor": edge, "linewidth": line, "gid": gid}
        frame = Rectangle((y0, x0), y1 - y0, x1 - x0, **style, fill=False, zorder=5)
        frame.set_clip_on(False)
        ax.add_patch(frame)


def _draw_instances(ax: Axes, drawn: Cells, shown: Sample) -> None:
    for cause in SHAPES:
        x, y = drawn.place(shown.coordinates[shown.cause == cause]).T
        if len(x):
            ax.plot(y, x, **_dot(cause), alpha=0.9, zorder=3, gid=f"instances {cause.name}")


def _dot(cause: Cause) -> dict[str, Any]:
    marker, size = SHAPES[cause]
    color, edge = OUTCOME_COLORS[cause], 0.0 if cause == Cause.SUCCESS else 0.4
    return _marker(marker, color, size, PAPER) | {"markeredgewidth": edge}


def _marker(marker: str, color: str, size: float, edge: str) -> dict[str, Any]:
    face = {"markerfacecolor": color, "markeredgecolor": edge, "markeredgewidth": 1.1}
    return {"linestyle": "", "marker": marker, "markersize": size} | face


def _draw_demonstrations(ax: Axes, drawn: Cells, event: Round, text: bool) -> None:
    """Numbered rings: whole also at the edge of the area, and cut off beyond it."""
    look = _marker("o", PAPER, MARK if text else 5.0, INK)
    (y0, y1), (x0, x1) = (np.sort(ends) + EDGE for ends in (ax.get_xlim(), ax.get_ylim()))
    for number, demonstration in enumerate(event.demonstrations, start=1):
        x, y = drawn.place_of(demonstration.X_WO)
        clip = {"clip_on": not (y0 <= y <= y1 and x0 <= x <= x1)}
        ax.plot(y, x, **look, **clip, zorder=7, gid=f"demonstration {number}")
        if text:
            style = {"ha": "center", "va": "center_baseline", "fontsize": 7.5, "zorder": 7.5}
            ax.text(y, x, str(number), color=INK, fontweight="bold", **clip, **style)


def _draw_robot(ax: Axes, text: bool) -> None:
    """An arrow head on the edge nearest to the robot's base, the world's origin, if outside."""
    y = float(np.clip(0.0, *sorted(ax.get_xlim())))
    x = float(np.clip(0.0, *sorted(ax.get_ylim())))
    if x == 0.0 and y == 0.0:
        return
    towards = (3, 0, np.degrees(np.arctan2(y, x)))
    look = {"marker": towards, "markersize": 9 if text else 5, "color": INK}
    ax.plot(y, x, zorder=7, clip_on=False, gid="robot", **look)
    if text:
        offset = {"xytext": (8, 3), "textcoords": "offset points"}
        halo = [withStroke(linewidth=2.0, foreground=PAPER)]
        ax.annotate("robot", (y, x), fontsize=8, color=INK, zorder=7, path_effects=halo, **offset)
