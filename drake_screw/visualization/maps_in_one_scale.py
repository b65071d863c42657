"""Heat maps of different runs, in one scale of colour and of length."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from drake_screw.tasks import Regions
from drake_screw.typing import Array
from drake_screw.visualization.cells import Cells, cells
from drake_screw.visualization.heat_map import (
    add_colour_bar,
    draw_heat_map,
    extent,
    legend_handles,
    room_above,
)
from drake_screw.visualization.outlines import Outline
from drake_screw.visualization.palette import INK
from drake_screw.visualization.round_figure import beyond_the_plane
from drake_screw.visualization.rounds import Round

DOTS = 250
WIDTH, LEFT, RIGHT, BOTTOM, TOP = 5.6, 0.7, 0.85, 1.4, 0.6  # inches
LEGEND = 0.5  # inches from the map down to it
MOST_HEIGHT = 5.6  # inches


@dataclass(frozen=True)
class MapOf:
    """What is drawn of a run: a round, the regions it is of, and obstacles near them."""

    event: Round
    regions: Regions
    things: Sequence[Outline] = ()


def maps_in_one_scale(maps: Sequence[MapOf], titles: Sequence[str]) -> list[Figure]:
    """A figure of each, not registered with pyplot.

    Colours always stand for failure probabilities from 0 to 1. Those along the same axes of objects
    of the same name show the same part of the plane, equally large; see `planes_shared`.
    """
    drawn = [cells(each.regions, each.event.verdict.estimates) for each in maps]
    planes = [_plane(each) for each in drawn]
    figures = []
    for one, seen, plane, title in zip(maps, drawn, planes, titles, strict=True):
        ends = [
            extent(other, each.things)
            for other, each, known in zip(drawn, maps, planes, strict=True)
            if known == plane
        ]
        frame = (
            np.min([lower for lower, _ in ends], axis=0),
            np.max([upper for _, upper in ends], axis=0),
        )
        figures.append(_figure(one, seen, frame, title))
    return figures


def planes_shared(maps: Sequence[MapOf]) -> bool:
    """Whether all are along the same axes, and so in the same scale."""
    return len({_plane(cells(m.regions, m.event.verdict.estimates)) for m in maps}) <= 1


def _plane(drawn: Cells) -> tuple[Any, ...]:
    names = [(drawn.area.objects[i].name, drawn.area.axes[j]) for i, j in drawn.axes]
    return (*names, drawn.area.objects[drawn.object].on)


def _figure(one: MapOf, drawn: Cells, frame: tuple[Array, Array], title: str) -> Figure:
    """Of a fixed layout, so that equal frames are drawn equally large."""
    width = WIDTH - LEFT - RIGHT
    depth, across = frame[1] - frame[0]
    height = 0.6 * width
    if drawn.from_above:
        height = float(np.clip(width * depth / max(across, 1e-9), 1.5, MOST_HEIGHT))
    total = height + BOTTOM + TOP
    figure = Figure(figsize=(WIDTH, total))
    ax = figure.add_axes((LEFT / WIDTH, BOTTOM / total, width / WIDTH, height / total), anchor="SW")
    shown = draw_heat_map(
        ax, one.event, one.regions, dots=DOTS, things=one.things, axes=drawn.axes, frame=frame
    )
    words, room = beyond_the_plane(drawn, one.regions), room_above(drawn)
    ax.set_title(title, fontsize=11, fontweight="bold", loc="left", color=INK, pad=18.0 + room)
    if words:
        place = {"xytext": (0, 5 + room), "textcoords": "offset points", "va": "bottom"}
        ax.annotate(words, (0, 1), xycoords="axes fraction", fontsize=8, color=INK, **place)
    add_colour_bar(figure, ax.inset_axes((1.02, 0.0, 0.03, 1.0)))
    figure.legend(
        handles=legend_handles(one.event, shown, one.things),
        title=shown.statement,
        title_fontsize=8,
        fontsize=8,
        loc="upper center",
        bbox_to_anchor=(0.5, (BOTTOM - LEGEND) / total),
        ncols=3,
        frameon=False,
        columnspacing=1.2,
        handletextpad=0.4,
    )
    return figure
