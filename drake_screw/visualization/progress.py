"""A whole run in one figure: every round's heat map, and how the weakest region improved."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from drake_screw.errors import listed
from drake_screw.planning import Cause
from drake_screw.tasks import Regions
from drake_screw.visualization.cells import Axes as PlaneAxes
from drake_screw.visualization.cells import cells
from drake_screw.visualization.figure_files import save_figure
from drake_screw.visualization.heat_map import (
    add_colour_bar,
    draw_heat_map,
    extent,
    legend_handles,
    room_above,
)
from drake_screw.visualization.outlines import Outline
from drake_screw.visualization.palette import INK, OUTCOME_COLORS, failure_map
from drake_screw.visualization.rounds import Round, Sample, mean_failure

COLUMNS = 3
WIDTH = 11.0  # inches
DOTS = 400


def draw_progress(
    ax: Axes,
    events: Sequence[Round],
    regions: Sequence[Regions] | None = None,
    *,
    beta: float | None = None,
    narrow: bool = False,
) -> None:
    """Draw into `ax` the failure probability of each round, of the weakest region and of all.

    The line of the weakest is the largest estimate; its band reaches from the largest lower to the
    largest upper confidence bound of all regions, at the strategy's own level. All regions
    together are the mean of their estimates, each by its share of the work area.

    Args:
        ax: gets limits and axis labels.
        events: at least one round, in order.
        regions: those of each round; None if they are equally large.
        beta: coverage asked for; draws the line 1 - beta that must not be exceeded.
        narrow: `ax` has room for two columns of its legend only, which is above it.
    """
    numbers = [event.round + 1 for event in events]
    estimates, lower, upper = (
        np.array([np.nanmax(getattr(event.verdict, field), initial=0.0) for event in events])
        for field in ("estimates", "lower", "upper")
    )
    color = failure_map()(0.75)
    low, high = np.minimum(lower, estimates), np.maximum(upper, estimates)
    bars = np.array([estimates - low, high - estimates])
    ax.fill_between(numbers, low, high, color=color, alpha=0.2, linewidth=0)
    style = {"color": color, "marker": "o", "capsize": 3, "label": "weakest region"}
    ax.errorbar(numbers, estimates, bars, **style).lines[0].set_gid("weakest")
    means = [
        mean_failure(event.verdict, None if regions is None else regions[i])
        for i, event in enumerate(events)
    ]
    style = {"color": INK, "marker": ".", "linestyle": ":", "gid": "mean"}
    ax.plot(numbers, means, **style, label="all regions together")
    if beta is not None:
        words = f"asked for: at most {1.0 - beta:g}"
        ax.axhline(1.0 - beta, color=INK, linestyle="--", linewidth=1.0, gid="goal", label=words)
    done = [event.round + 1 for event in events if event.verdict.certified]
    if done:
        place = estimates[numbers.index(done[-1])]
        star = {"marker": "o", "markersize": 10, "color": OUTCOME_COLORS[Cause.SUCCESS]}
        star |= {"linestyle": "", "label": "certified"}
        ax.plot(done[-1], place, **star, zorder=4, gid="certified")
    legend = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "ncols": 2 if narrow else 4}
    ax.legend(fontsize=8, frameon=False, **legend)
    ax.set_xlim(min(numbers) - 0.5, max(numbers) + 0.5)
    ax.set_ylim(-0.04, 1.04)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    ax.set_xlabel("round", fontsize=9, color=INK)
    ax.set_ylabel("failure probability", fontsize=9, color=INK)
    ax.tick_params(labelsize=8)
    ax.spines[["top", "right"]].set_visible(False)


def run_figure(
    events: Sequence[Round],
    regions: Sequence[Regions],
    *,
    scenario: str = "",
    beta: float | None = None,
    things: Sequence[Outline] = (),
    axes: PlaneAxes | None = None,
) -> Figure:
    """Small heat maps of all rounds, and the progress of the weakest region.

    The progress fills what the last row of maps leaves, or has a row of its own.

    Args:
        events: at least one round, in order.
        regions: those of each round.
        scenario: its name, for the title.
        beta: coverage asked for.
        things: obstacles in the work area or near it.
        axes: of the heat maps, `usual_axes` if None.
    """
    drawn = cells(regions[0], events[0].verdict.estimates, axes)
    lower, upper = extent(drawn, things)
    depth, width = upper - lower
    shape = float(depth / max(width, 1e-9)) if drawn.from_above else 0.6
    columns = 2 if len(events) in (1, 2, 4) else COLUMNS
    rows, left = -(-len(events) // columns), -len(events) % columns
    row = float(np.clip((WIDTH - 1.4) / columns * shape, 0.9, 4.2)) + 0.65
    heights = [row] * (rows - 1) + ([max(row, 2.6)] if left else [row, 2.6])
    figure = Figure(figsize=(WIDTH, sum(heights) + 1.1), layout="constrained")
    grid = figure.add_gridspec(
        len(heights),
        columns + 1,
        height_ratios=heights,
        width_ratios=[1] * columns + [0.03],
    )
    shown: list[tuple[Round, Sample]] = []
    alone = len(events) == 1
    stacked, several = False, len(drawn.area.objects) > 1 and drawn.from_above
    for i, event in enumerate(events):
        ax = figure.add_subplot(grid[i // columns, i % columns])
        parts = regions[i]
        look = draw_heat_map(ax, event, parts, dots=DOTS, text=alone, things=things, axes=axes)
        stacked |= cells(parts, event.verdict.estimates, axes).stack > 1
        shown.append((event, look))
        count = len(event.demonstrations)
        title = f"round {event.round + 1}: {count} demonstration{'' if count == 1 else 's'}"
        ax.set_title(title, fontsize=9, color=INK, pad=6.0 + alone * room_above(drawn))
        ax.tick_params(labelsize=7)
        ax.set_xlabel(drawn.label(1), fontsize=7.5, color=INK)
        ax.set_ylabel(drawn.label(0), fontsize=7.5, color=INK)
    add_colour_bar(figure, figure.add_subplot(grid[:rows, columns]))
    place = grid[-1, columns - left : columns] if left else grid[rows, :]
    narrow = 0 < left * WIDTH / columns < 6.0
    draw_progress(figure.add_subplot(place), events, regions, beta=beta, narrow=narrow)
    if scenario:
        figure.suptitle(scenario, fontsize=13, fontweight="bold", color=INK, x=0.01, ha="left")
    seen = {h.get_label(): h for event, s in shown for h in legend_handles(event, s, things)}
    figure.legend(
        handles=list(seen.values()),
        loc="outside lower center",
        ncols=7,
        frameon=False,
        fontsize=8.5,
        title=f"at most {DOTS} instances of each round, drawn at random"
        + (f"; cells show their worst region over {listed(drawn.others)}" if stacked else "")
        + (f"; places of {drawn.area.objects[drawn.object].name}" if several else ""),
        title_fontsize=8.5,
    )
    return figure


def save_run_figure(
    events: Sequence[Round],
    regions: Sequence[Regions],
    stem: str | Path,
    *,
    scenario: str = "",
    beta: float | None = None,
    things: Sequence[Outline] = (),
    axes: PlaneAxes | None = None,
    svg: bool = False,
) -> tuple[Path, ...]:
    """Write `run_figure` as ``<stem>.png``, with `svg` as ``<stem>.svg``, too.

    They have the same bytes every time.

    Returns:
        The files.
    """
    figure = run_figure(events, regions, scenario=scenario, beta=beta, things=things, axes=axes)
    return save_figure(figure, stem, svg=svg)
