"""Where plans fail: the work area from above, as a person behind the robot's head sees it.

x grows upwards, away from the robot; y grows to the left, as it does for the robot.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.patheffects import withStroke

from drake_screw.planning import Cause
from drake_screw.tasks import Regions
from drake_screw.typing import Array
from drake_screw.visualization.cell_text import MARK, write_estimates
from drake_screw.visualization.figure_files import save_figure
from drake_screw.visualization.outlines import Outline, draw_outlines, outline_handle, widened
from drake_screw.visualization.palette import (
    ACCENT,
    INK,
    OUTCOME_COLORS,
    OUTCOME_NAMES,
    PAPER,
    failure_color,
    failure_map,
)
from drake_screw.visualization.rounds import Cells, Round, Sample, cells, details, headline, sample

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
) -> Sample:
    """Draw one round into `ax`: estimates, instances, demonstrations, weakest region, suggestion.

    Cells are coloured by estimated failure probability, always on the scale from 0 to 1. Where
    several regions lie above one another a cell shows the worst of them.

    Args:
        ax: gets limits, an equal aspect and axis labels.
        event: the round.
        regions: those of the run.
        dots: most instances to draw; more are thinned to a random sample.
        text: write estimates and counts into the cells, numbers at the demonstrations, and names of
            obstacles.
        things: obstacles in the work area or near it.

    Returns:
        The instances that were drawn.
    """
    drawn = cells(regions, event.verdict.estimates)
    shown = sample(event.evaluation, dots)
    _frame(ax, drawn, things)
    _draw_cells(ax, drawn, event)
    _draw_instances(ax, drawn, shown)
    if text:
        write_estimates(ax, drawn, event)
    draw_outlines(ax, things, text=text)
    _draw_robot(ax, text)
    _draw_demonstrations(ax, drawn, event, text)
    if event.suggestion is not None:
        x, y = event.suggestion.x_y_yaw[drawn.object, :2]
        look = _marker("*", ACCENT, 19.0 if text else 11.0, INK)
        ax.plot(y, x, **look, zorder=8, gid="suggestion")
    return shown


def heat_map_figure(
    event: Round,
    regions: Regions,
    *,
    scenario: str = "",
    dots: int = MOST_DOTS,
    things: Sequence[Outline] = (),
) -> Figure:
    """A figure of one round with title, colour bar and legend; not registered with pyplot."""
    drawn = cells(regions, event.verdict.estimates)
    lower, upper = extent(drawn, things)
    depth, width = upper - lower
    height = float(np.clip(7.6 * depth / max(width, 1e-9), 2.2, 7.6))
    caption = fill(_caption(event, regions, drawn), 120)
    height += 0.2 * caption.count("\n") + (0.3 if things else 0.0)
    figure = Figure(figsize=(9.6, height + 1.6), layout="constrained")
    ax = figure.add_subplot()
    figure.get_layout_engine().execute(figure)
    shown = draw_heat_map(ax, event, regions, dots=dots, things=things)
    title = f"{scenario}: {headline(event)}" if scenario else headline(event)
    blank = "\n" * (1 + caption.count("\n"))
    ax.set_title(title + blank, fontsize=12, fontweight="bold", loc="left", color=INK)
    offset = {"xytext": (0, 6), "textcoords": "offset points", "va": "bottom"}
    ax.annotate(caption, (0, 1), xycoords="axes fraction", fontsize=8.5, color=INK, **offset)
    add_colour_bar(figure, ax.inset_axes((1.015, 0.0, 0.02, 1.0)))
    figure.legend(
        handles=legend_handles(event, shown, things),
        title=shown.statement,
        title_fontsize=8.5,
        fontsize=8.5,
        loc="outside lower center",
        ncols=7,
        frameon=False,
        columnspacing=1.4,
        handletextpad=0.4,
    )
    return figure


def save_heat_map(
    event: Round,
    regions: Regions,
    stem: str | Path,
    *,
    scenario: str = "",
    dots: int = MOST_DOTS,
    things: Sequence[Outline] = (),
) -> tuple[Path, Path]:
    """Write `heat_map_figure` as ``<stem>.png`` and ``<stem>.svg``, the same bytes every time.

    Returns:
        The two files.
    """
    figure = heat_map_figure(event, regions, scenario=scenario, dots=dots, things=things)
    return save_figure(figure, stem)


def add_colour_bar(figure: Figure, ax: Axes) -> None:
    """The scale of failure probability, 0 to 1, filling `ax`."""
    bar = figure.colorbar(ScalarMappable(Normalize(0.0, 1.0), failure_map()), cax=ax)
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
    """Least and greatest x, y (2,) in m that a picture of cells and of things near them shows."""
    return widened(drawn.lower.min(axis=0), drawn.upper.max(axis=0), things)


def _caption(event: Round, regions: Regions, drawn: Cells) -> str:
    objects = regions.area.objects
    parts = [details(event, regions)]
    if drawn.stack > 1:
        most = "" if drawn.stack * len(drawn.region) == regions.K else "up to "
        parts.append(f"each cell shows the worst of {most}{drawn.stack} regions")
    if len(objects) > 1:
        parts.append(f"places of {objects[drawn.object].name}")
    return "; ".join(parts)


def _frame(ax: Axes, drawn: Cells, things: Sequence[Outline]) -> None:
    lower, upper = extent(drawn, things)
    pad = np.where(upper > lower, 0.0, 0.05)
    ax.set_xlim(upper[1] + pad[1], lower[1] - pad[1])
    ax.set_ylim(lower[0] - pad[0], upper[0] + pad[0])
    ax.set_aspect("equal")
    ax.set_xlabel("← to the robot's left      y in m", fontsize=9, color=INK)
    ax.set_ylabel("x in m      away from the robot →", fontsize=9, color=INK)
    ax.tick_params(labelsize=8)


def _draw_cells(ax: Axes, drawn: Cells, event: Round) -> None:
    estimates = event.verdict.estimates
    for cell, region in enumerate(drawn.region):
        (x0, y0), (x1, y1) = drawn.lower[cell], drawn.upper[cell]
        box = {"xy": (y0, x0), "width": y1 - y0, "height": x1 - x0}
        color = tuple(failure_color(estimates[region]))
        ax.add_patch(Rectangle(**box, facecolor=color, edgecolor=GRID, gid=f"cell{cell}"))
    (x0, y0), (x1, y1) = drawn.outlines[event.verdict.region]
    for edge, line, gid in ((PAPER, 5.0, "halo"), (INK, 2.4, "weakest")):
        style = {"edgecolor": edge, "linewidth": line, "gid": gid}
        frame = Rectangle((y0, x0), y1 - y0, x1 - x0, **style, fill=False, zorder=5)
        frame.set_clip_on(False)
        ax.add_patch(frame)


def _draw_instances(ax: Axes, drawn: Cells, shown: Sample) -> None:
    for cause in SHAPES:
        x, y = shown.x_y_yaw[shown.cause == cause, drawn.object, :2].T
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
        x, y = demonstration.X_WO[drawn.object, :2, 3]
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
    towards = (3, 0, np.degrees(np.arctan2(-y, -x)))
    look = {"marker": towards, "markersize": 9 if text else 5, "color": INK}
    ax.plot(y, x, zorder=7, clip_on=False, gid="robot", **look)
    if text:
        offset = {"xytext": (8, 4), "textcoords": "offset points"}
        halo = [withStroke(linewidth=2.0, foreground=PAPER)]
        ax.annotate("robot", (y, x), fontsize=8, color=INK, zorder=7, path_effects=halo, **offset)
