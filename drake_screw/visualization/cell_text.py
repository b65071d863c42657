"""Numbers in the cells of a heat map."""

from __future__ import annotations

from itertools import product

import numpy as np
from matplotlib.axes import Axes

from drake_screw.typing import Array
from drake_screw.visualization.cells import Cells
from drake_screw.visualization.palette import failure_color, ink_on
from drake_screw.visualization.rounds import Round

LEAST_TEXT = 4.0
LEAST_COUNTS = 5.0
"""Points: smaller, nobody reads the counts, and the estimate has their room."""
MARK = 11.0
"""Diameter in points of the mark of a demonstration."""


def write_estimates(ax: Axes, drawn: Cells, event: Round, *, mean: bool = False) -> None:
    """Write estimate and counts into each cell, as large as it has room for, or nothing.

    Args:
        ax: with its limits and aspect set.
        drawn: the cells.
        event: the round. Text makes way for its demonstrations and its suggestion.
        mean: write the mean of the regions above one another, which has no counts.
    """
    ax.apply_aspect()
    marks = marked_places(drawn, event)
    verdict = event.verdict
    points = 72.0 / ax.get_figure().dpi
    for cell, region in enumerate(drawn.region):
        corners = ax.transData.transform([drawn.lower[cell][::-1], drawn.upper[cell][::-1]])
        width, height = np.abs(corners[1] - corners[0]) * points
        size = min(0.26 * height, 0.17 * width, 15.0)
        below = 0.6 * size >= LEAST_COUNTS and not mean
        if not below:
            size = min(0.4 * height, 0.2 * width, 15.0)
        if size < LEAST_TEXT:
            continue
        text = np.array([(1.1 if below else 0.65) * size / height, 1.95 * size / width])
        gap = text + MARK / 2.0 / np.array([height, width])
        x, y = clear_spot(drawn.lower[cell], drawn.upper[cell], marks, text, gap)
        value = float(drawn.mean[cell] if mean else verdict.estimates[region])
        background = failure_color(value)
        behind = {"boxstyle": "round,pad=0.1", "fc": tuple(background), "lw": 0, "alpha": 0.9}
        style = {"color": ink_on(background), "ha": "center", "zorder": 6, "bbox": behind}
        known = not np.isnan(value) and (mean or verdict.samples[region] > 0)
        estimate = f"{value:.3f}" if known else "?"
        align = "bottom" if below else "center"
        ax.text(y, x, estimate, fontsize=size, fontweight="bold", va=align, **style)
        if below:
            counts = f"{verdict.failures[region]:,} / {verdict.samples[region]:,}"
            ax.text(y, x, counts, fontsize=0.6 * size, va="top", **style)


def marked_places(drawn: Cells, event: Round) -> Array:
    """(m, 2) x, y of what must not lie under text."""
    places = [drawn.place_of(d.X_WO) for d in event.demonstrations]
    if event.suggestion is not None:
        places.append(drawn.place(event.suggestion.coordinates))
    return np.array(places).reshape(-1, 2)


def clear_spot(lower: Array, upper: Array, marks: Array, text: Array, gap: Array) -> Array:
    """x, y for the text of a cell: its middle, or another place if a mark is too near.

    Args:
        lower, upper: (2,) corners of the cell.
        marks: (m, 2) what to keep away from.
        text: (2,) half the extent of the text, as a share of the cell's.
        gap: (2,) the least distance to marks, in one axis or the other, as such a share.
    """
    room = np.clip(0.48 - text, 0.0, 0.25)
    spots = 0.5 + room * list(product((0, 1, -1), repeat=2))
    places = (marks - lower) / (upper - lower)
    if len(places) == 0:
        return (lower + upper) / 2.0
    clear = (np.abs(places - spots[:, None]) / gap).max(axis=2).min(axis=1)
    return lower + spots[np.minimum(clear, 1.0).argmax()] * (upper - lower)
