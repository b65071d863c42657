"""Charts of a look at a recording: distances, deviations from the screws, joints, over time."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from drake_screw.demonstrations import Look
from drake_screw.planning import Cause
from drake_screw.screws.endless import drawn_range
from drake_screw.typing import Array
from drake_screw.visualization.palette import INK, OBJECT_COLORS, OUTCOME_COLORS, QUIET

WIDTH = 9.6  # inches, of every chart
LEFT, RIGHT = 0.115, 0.865  # of the width: charts one below the other share their time axis
LIMIT = OUTCOME_COLORS[Cause.JOINT_LIMIT]
_HATCH = "////"


def distance_figure(look: Look) -> Figure:
    """Distance of the end effector from each object, with its region of interest shaded.

    The dashed line is the region's radius. Visits to it that are left out are hatched; the ticks
    below are guiding poses.
    """
    figure, (ax,) = _charts(1, 2.7)
    for i, name in enumerate(look.shown.names):
        color = object_color(i)
        ax.plot(look.t, look.distance[:, i], color=color, linewidth=1.6, label=name, gid="distance")
        if look.shown.regions.task[i]:
            radius = float(look.radius[i])
            ax.axhline(radius, color=color, linestyle="--", linewidth=1.0, gid="radius")
            _beside(ax, radius, f"region of interest\n{radius:.3f} m", color=color)
    _shade(ax, look)
    if look.demonstration is not None:
        for i in np.unique(look.demonstration.objects):
            at = look.t[look.demonstration.kept[look.demonstration.objects == i]]
            place = {"transform": ax.get_xaxis_transform(), "clip_on": False, "gid": "guides"}
            ax.plot(at, np.full(len(at), 0.03), "|", color=object_color(i), ms=9, mew=1.8, **place)
    ax.set_ylim(0.0, None)
    ax.set_ylabel("distance (m)")
    _legend(ax, look)
    return figure


def deviation_figure(look: Look) -> Figure:
    """How far the samples kept are from the screws, in place and in turn, with the tolerances.

    What is not kept is grey; vertical lines are guiding poses.
    """
    figure, axes = _charts(2, 3.6)
    for ax, scale, tolerance, word, unit in zip(
        axes,
        (1e3, 1.0),
        look.tolerances,
        ("position", "rotation"),
        ("mm", "rad"),
        strict=True,
    ):
        highest = scale * tolerance
        for near in look.deviations:
            values = scale * (near.position if scale > 1.0 else near.rotation)
            for run in _unbroken(near.samples):
                color = object_color(near.object)
                ax.plot(look.t[near.samples[run]], values[run], color=color, linewidth=1.4)
            highest = max(highest, float(values.max(initial=0.0)))
        ax.axhline(scale * tolerance, color=INK, linestyle="--", linewidth=1.0, gid="tolerance")
        _beside(ax, scale * tolerance, f"tolerance\n{scale * tolerance:.3g} {unit}")
        for stretch in look.dropped:
            ax.axvspan(stretch.start, stretch.end, color=QUIET, alpha=0.16, linewidth=0)
        _mark_guides(ax, look)
        ax.set_ylim(0.0, 1.25 * highest)
        ax.set_ylabel(f"{word} ({unit})")
    if not look.deviations:
        for ax in axes:
            ax.text(0.5, 0.4, "not used", transform=ax.transAxes, ha="center", color=INK)
    return figure


def joint_figure(look: Look) -> Figure:
    """Each joint between its limits, with its region of interest shaded and where it is tightest.

    The lines at the top and at the bottom of a chart are the limits, if the joint has any.
    """
    names = look.recording.joint_names
    figure, axes = _charts(len(names), 0.55 + 0.92 * len(names))
    least, greatest = drawn_range(look.lower, look.upper, look.q)
    for j, ax in enumerate(axes):
        lower, upper = float(least[j]), float(greatest[j])
        nearest, limited = int(look.margin[:, j].argmin()), np.isfinite(look.margin[0, j])
        _shade(ax, look)
        ax.plot(look.t, look.q[:, j], color=INK, linewidth=1.3, gid="joint")
        if limited:
            ax.plot(look.t[nearest], look.q[nearest, j], "o", color=LIMIT, ms=4.5, gid="tightest")
            for limit in (lower, upper):
                ax.axhline(limit, color=LIMIT, linewidth=1.1, gid="limit")
        ax.set_ylim(lower - 0.06 * (upper - lower), upper + 0.06 * (upper - lower))
        ax.set_yticks([lower, upper], [f"{lower:.2f}", f"{upper:.2f}"])
        margin = f"least margin\n{look.margin[nearest, j]:.3f} {look.units[j]}"
        _beside(ax, 0.5 * (lower + upper), margin if limited else "no limits")
        ax.set_ylabel(f"{names[j]}\n({look.units[j]})", rotation=0, ha="right", va="center")
        ax.yaxis.set_label_coords(-0.052, 0.5)
    return figure


def object_color(index: int) -> str:
    """The colour of an object, by its place in the scenario."""
    return OBJECT_COLORS[index % len(OBJECT_COLORS)]


def _charts(count: int, height: float) -> tuple[Figure, Sequence[Axes]]:
    """Charts one below the other over the same time."""
    figure = Figure(figsize=(WIDTH, height))
    axes = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    figure.subplots_adjust(
        left=LEFT, right=RIGHT, top=1.0 - 0.12 / height, bottom=0.45 / height, hspace=0.16
    )
    for ax in axes:
        ax.tick_params(labelsize=8, colors=INK)
        ax.yaxis.label.set_size(8.5)
        ax.spines[["top", "right"]].set_visible(False)
        ax.margins(x=0.0)
    axes[-1].set_xlabel("time (s)", fontsize=8.5)
    return figure, axes


def _beside(ax: Axes, height: float, words: str, *, color: str = INK) -> None:
    """Words to the right of a chart, at a height of its scale."""
    place = {"xycoords": ax.get_yaxis_transform(), "textcoords": "offset points"}
    ax.annotate(words, (1.0, height), (6, 0), va="center", fontsize=8, color=color, **place)


def _shade(ax: Axes, look: Look) -> None:
    """The time spent in the regions of interest."""
    regions = look.shown.regions
    for visit in (*regions.visits, *regions.left_out):
        kept = visit in regions.visits
        style = {"color": object_color(visit.object), "linewidth": 0, "alpha": 0.14}
        if not kept:
            style |= {"fill": False, "hatch": _HATCH, "alpha": 0.3}
        span = (look.t[visit.start], look.t[visit.stop - 1])
        ax.axvspan(*span, **style, gid="visit" if kept else "left out")


def _mark_guides(ax: Axes, look: Look) -> None:
    if look.demonstration is not None:
        for at in look.t[look.demonstration.kept]:
            ax.axvline(at, color=INK, linewidth=0.6, alpha=0.35, gid="guide")


def _legend(ax: Axes, look: Look) -> None:
    handles, labels = ax.get_legend_handles_labels()
    if look.shown.regions.visits:
        handles.append(Patch(color=QUIET, alpha=0.3, linewidth=0))
        labels.append("in the region of interest")
    if look.shown.regions.left_out:
        handles.append(Patch(fill=False, hatch=_HATCH, edgecolor=QUIET, linewidth=0))
        labels.append("another visit, left out")
    ax.legend(handles, labels, fontsize=8, frameon=False, loc="upper center", ncols=len(handles))
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.14 * (high - low))


def _unbroken(samples: Array) -> list[slice]:
    """Runs of samples that follow on each other."""
    breaks = [0, *(np.flatnonzero(np.diff(samples) > 1) + 1).tolist(), len(samples)]
    return [slice(a, b) for a, b in pairwise(breaks) if a < b]
