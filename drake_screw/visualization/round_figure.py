"""A round's heat maps as a figure of its own: one map, or the worst and the mean of each plane."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drake_screw.errors import listed
from drake_screw.tasks import Regions, WorkArea
from drake_screw.visualization.cells import Axes as PlaneAxes
from drake_screw.visualization.cells import Cells, cells, usual_axes
from drake_screw.visualization.figure_files import save_figure
from drake_screw.visualization.heat_map import (
    MOST_DOTS,
    add_colour_bar,
    draw_heat_map,
    extent,
    legend_handles,
    room_above,
)
from drake_screw.visualization.outlines import Outline
from drake_screw.visualization.palette import INK
from drake_screw.visualization.rounds import Round, Sample, details, headline


def planes(area: WorkArea) -> tuple[PlaneAxes, ...]:
    """What a figure shows unless axes are chosen: x, y of each object that moves in both.

    Where none does, it is `usual_axes`.
    """
    found: list[PlaneAxes] = [
        ((int(i), 0), (int(i), 1)) for i in np.flatnonzero(area.free[:, :2].all(axis=1))
    ]
    return tuple(found) or (usual_axes(area),)


def heat_map_figure(
    event: Round,
    regions: Regions,
    *,
    scenario: str = "",
    dots: int = MOST_DOTS,
    things: Sequence[Outline] = (),
    axes: PlaneAxes | None = None,
) -> Figure:
    """A figure of one round with title, colour bar and legend; not registered with pyplot.

    There is a row for each of `planes`, or for the axes that are chosen. Where regions lie above
    one another in any of them, there are two maps in a row: of the worst, and of the mean.
    """
    chosen = planes(regions.area) if axes is None else (axes,)
    drawn = [cells(regions, event.verdict.estimates, plane) for plane in chosen]
    look: dict[str, Any] = {"dots": dots, "things": things}
    title = f"{scenario}: {headline(event)}" if scenario else headline(event)
    if len(drawn) == 1 and drawn[0].stack == 1:
        figure, shown = _one_map(event, regions, drawn[0], title, look)
    else:
        figure, shown = _several_maps(event, regions, drawn, title, look)
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
    axes: PlaneAxes | None = None,
    svg: bool = False,
) -> tuple[Path, ...]:
    """Write `heat_map_figure` as ``<stem>.png``, with `svg` as ``<stem>.svg``, too.

    They have the same bytes every time.

    Returns:
        The files.
    """
    look: dict[str, Any] = {"dots": dots, "things": things, "axes": axes}
    figure = heat_map_figure(event, regions, scenario=scenario, **look)
    return save_figure(figure, stem, svg=svg)


def _one_map(
    event: Round, regions: Regions, drawn: Cells, title: str, look: dict[str, Any]
) -> tuple[Figure, Sample]:
    things, height = look["things"], _height(drawn, look["things"], 7.6)
    caption = fill(_caption(event, regions, drawn), 120)
    height += 0.2 * caption.count("\n") + (0.3 if things else 0.0)
    room = room_above(drawn)
    figure = Figure(figsize=(9.6, height + 1.6 + room / 72.0), layout="constrained")
    ax = figure.add_subplot()
    figure.get_layout_engine().execute(figure)
    shown = draw_heat_map(ax, event, regions, **look, axes=drawn.axes)
    blank = "\n" * (1 + caption.count("\n"))
    look_of_title = {"fontsize": 12, "fontweight": "bold", "loc": "left", "color": INK}
    ax.set_title(title + blank, **look_of_title, pad=6.0 + room)
    offset = {"xytext": (0, 6 + room), "textcoords": "offset points", "va": "bottom"}
    ax.annotate(caption, (0, 1), xycoords="axes fraction", fontsize=8.5, color=INK, **offset)
    add_colour_bar(figure, ax.inset_axes((1.015, 0.0, 0.02, 1.0)))
    return figure, shown


def _several_maps(
    event: Round, regions: Regions, drawn: Sequence[Cells], title: str, look: dict[str, Any]
) -> tuple[Figure, Sample]:
    columns = 2 if any(each.stack > 1 for each in drawn) else 1
    heights = [_height(each, look["things"], 4.6) + 0.9 for each in drawn]
    width = 6.6 * columns + 0.6
    figure = Figure(figsize=(width, sum(heights) + 1.5), layout="constrained")
    text = fill(details(event, regions), int(16 * width))
    figure.suptitle(f"{title}\n{text}", fontsize=10.5, color=INK, x=0.01, ha="left")
    grid = figure.add_gridspec(
        len(drawn), columns + 1, height_ratios=heights, width_ratios=[1.0] * columns + [0.025]
    )
    shown: Sample | None = None
    for row, each in enumerate(drawn):
        stacked, over = each.stack > 1, listed(each.others)
        left = beyond_the_plane(each, regions)
        panel = figure.add_subplot(grid[row, 0])
        shown = _panel(panel, event, regions, each, left, look)
        if stacked:
            _panel(
                figure.add_subplot(grid[row, 1]),
                event,
                regions,
                each,
                f"the mean over {over}",
                look | {"mean": True},
            )
    add_colour_bar(figure, figure.add_subplot(grid[:, columns]))
    assert shown is not None
    return figure, shown


def beyond_the_plane(drawn: Cells, regions: Regions) -> str:
    """What a cell's colour stands for along the axes that are not drawn; "" if there are none."""
    if not drawn.others:
        return ""
    if drawn.stack == 1:
        return f"averaged over {listed(drawn.others)}"
    most = "" if drawn.stack * len(drawn.region) == regions.K else "up to "
    return f"the worst of {most}{drawn.stack} regions over {listed(drawn.others)}"


def _panel(
    ax: Axes, event: Round, regions: Regions, drawn: Cells, text: str, look: dict[str, Any]
) -> Sample:
    ax.get_figure().get_layout_engine().execute(ax.get_figure())
    shown = draw_heat_map(ax, event, regions, **look, axes=drawn.axes)
    names = list(dict.fromkeys(drawn.area.objects[i].name for i, _ in drawn.axes))
    place = f"{listed(names)}: " if len(drawn.area.objects) > 1 else ""
    style = {"fontsize": 9, "loc": "left", "color": INK, "pad": 6.0 + room_above(drawn)}
    ax.set_title(fill(place + text, 70), **style)
    return shown


def _height(drawn: Cells, things: Sequence[Outline], most: float) -> float:
    """Inches of a map that is as wide as the height is at most."""
    if not drawn.from_above:
        return 0.6 * most
    lower, upper = extent(drawn, things)
    depth, width = upper - lower
    return float(np.clip(most * depth / max(width, 1e-9), 2.2, most))


def _caption(event: Round, regions: Regions, drawn: Cells) -> str:
    objects = regions.area.objects
    parts = [details(event, regions)]
    if drawn.others:
        parts.append(beyond_the_plane(drawn, regions))
    if len(objects) > 1:
        seen = dict.fromkeys(objects[i].name for i, _ in drawn.axes)
        parts.append(f"places of {listed(list(seen))}")
    return "; ".join(parts)
