"""Pictures of a study: how many demonstrations runs needed, and what few regions hide."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import PercentFormatter

from drake_screw.tasks import GridRegions
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
from drake_screw.visualization.palette import INK, PAPER, failure_map
from drake_screw.visualization.rounds import Round

DOTS = 700


@dataclass(frozen=True)
class Distribution:
    """How many demonstrations the runs with one K needed.

    Attributes:
        numbers: of demonstrations, one for each run that was certified.
        without: runs that ended without a certificate.
    """

    numbers: tuple[int, ...]
    without: int = 0

    @property
    def runs(self) -> int:
        """All runs."""
        return len(self.numbers) + self.without

    @property
    def counts(self) -> dict[int, int]:
        """Certified runs by their number of demonstrations, rising."""
        return dict(sorted(Counter(self.numbers).items()))

    @property
    def mean(self) -> float:
        """Mean number of demonstrations of certified runs, NaN where there are none."""
        return float(np.mean(self.numbers)) if self.numbers else float("nan")

    @property
    def most(self) -> int:
        """Largest number of demonstrations of certified runs, 0 where there are none."""
        return max(self.numbers, default=0)


def draw_distribution(ax: Axes, distribution: Distribution) -> None:
    """Draw into `ax` the share of all runs that were certified with each number of demonstrations.

    A dashed line marks the mean; the share that was not certified is written.
    """
    found = distribution.counts
    shares = [count / distribution.runs for count in found.values()]
    bars = ax.bar(list(found), shares, width=0.8, color=failure_map()(0.75))
    labels = [f"{share:.1%}" if share < 0.0995 else f"{share:.0%}" for share in shares]
    halo = [withStroke(linewidth=2.5, foreground=PAPER)]
    ax.bar_label(bars, labels, fontsize=7, padding=1, color=INK, zorder=3, path_effects=halo)
    text = []
    if found:
        ax.axvline(distribution.mean, color=INK, linestyle="--", linewidth=1.0, gid="mean")
        text.append(f"mean {distribution.mean:.2f}, at most {distribution.most}")
    if distribution.without:
        text.append(f"{distribution.without:,} not certified")
    place = {"transform": ax.transAxes, "ha": "right", "va": "top", "fontsize": 8.5}
    ax.text(0.99, 0.94, "\n".join(text), color=INK, **place)
    ax.set_ylim(0.0, 1.22 * max(shares, default=1.0))
    ax.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    ax.tick_params(labelsize=8)
    ax.spines[["top", "right"]].set_visible(False)


def distributions_figure(
    distributions: Mapping[int, Distribution], *, scenario: str = ""
) -> Figure:
    """The distributions by number of regions K, below one another on one scale.

    Args:
        distributions: by K; at least one.
        scenario: its name, for the title.
    """
    rows = len(distributions)
    figure = Figure(figsize=(7.0, 1.3 * rows + 1.0), layout="constrained")
    axes = figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0]
    most = max(1, *(found.most for found in distributions.values()))
    for ax, (K, found) in zip(axes, distributions.items(), strict=True):
        draw_distribution(ax, found)
        ax.set_ylabel(f"K = {K}", fontsize=9, color=INK)
        ax.set_xlim(0.4, most + 0.6)
        ax.set_xticks(range(1, most + 1))
    axes[-1].set_xlabel("demonstrations until the certificate", fontsize=9, color=INK)
    runs = sorted({found.runs for found in distributions.values()})
    count = f"{runs[0]:,}" if len(runs) == 1 else f"{runs[0]:,} to {runs[-1]:,}"
    title = f"{scenario}: " if scenario else ""
    title += f"{count} runs for each number of regions K"
    figure.suptitle(title, fontsize=11, fontweight="bold", color=INK, x=0.01, ha="left")
    return figure


def save_distributions(
    distributions: Mapping[int, Distribution], stem: str | Path, *, scenario: str = ""
) -> tuple[Path, ...]:
    """Write `distributions_figure` as ``<stem>.png`` and ``<stem>.svg``."""
    return save_figure(distributions_figure(distributions, scenario=scenario), stem, svg=True)


def comparison_figure(
    rounds: tuple[Round, Round],
    regions: tuple[GridRegions, GridRegions],
    *,
    scenario: str = "",
    note: str = "",
    things: Sequence[Outline] = (),
) -> Figure:
    """Two evaluations of the same demonstrations side by side: with few regions, with many.

    Args:
        rounds: with few regions, and with many.
        regions: of each.
        scenario: its name, for the title.
        note: written below the title.
        things: obstacles in the work area or near it.
    """
    seen = cells(regions[0], rounds[0].verdict.estimates)
    room = room_above(seen)
    lower, upper = extent(seen, things)
    depth, width = upper - lower
    height = float(np.clip(4.8 * depth / max(width, 1e-9), 1.6, 4.8))
    figure = Figure(figsize=(11.0, height + 1.9 + room / 72.0), layout="constrained")
    grid = figure.add_gridspec(1, 3, width_ratios=[1, 1, 0.03])
    handles: dict[object, Line2D | Patch] = {}
    for i, (event, parts) in enumerate(zip(rounds, regions, strict=True)):
        ax = figure.add_subplot(grid[i])
        figure.get_layout_engine().execute(figure)
        shown = draw_heat_map(ax, event, parts, dots=DOTS, things=things)
        handles |= {h.get_label(): h for h in legend_handles(event, shown, things)}
        style = {"fontsize": 10, "color": INK, "loc": "left", "pad": 6.0 + room}
        ax.set_title(_headline(event, parts), **style)
    add_colour_bar(figure, figure.add_subplot(grid[2]))
    count = len(rounds[0].demonstrations)
    title = f"{scenario}: " if scenario else ""
    title += f"the same {count} demonstrations, seen with few regions and with many"
    text = f"{title}\n" + fill(note, 130) if note else title
    figure.suptitle(text, fontsize=9.5, color=INK, x=0.01, ha="left")
    figure.legend(
        handles=list(handles.values()),
        loc="outside lower center",
        ncols=7,
        frameon=False,
        fontsize=8.5,
        title=f"at most {DOTS} instances each, drawn at random",
        title_fontsize=8.5,
    )
    return figure


def save_comparison(
    rounds: tuple[Round, Round],
    regions: tuple[GridRegions, GridRegions],
    stem: str | Path,
    *,
    scenario: str = "",
    note: str = "",
    things: Sequence[Outline] = (),
) -> tuple[Path, ...]:
    """Write `comparison_figure` as ``<stem>.png`` and ``<stem>.svg``."""
    figure = comparison_figure(rounds, regions, scenario=scenario, note=note, things=things)
    return save_figure(figure, stem, svg=True)


def _headline(event: Round, regions: GridRegions) -> str:
    verdict = event.verdict
    done = "certified" if verdict.certified else "not certified"
    worst = verdict.estimates[verdict.region]
    name = "" if regions.K == 1 else f", weakest region fails {worst:.1%}"
    return f"K = {regions.K}: {done}{name}"
