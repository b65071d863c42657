"""Runs side by side on one page that needs no network, their heat maps in one scale."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from drake_screw.errors import DrakeScrewError
from drake_screw.files import write_text, writing
from drake_screw.outputs import writable
from drake_screw.planning import Cause
from drake_screw.runs.comparison import Comparison, last_rounds, without_sentences
from drake_screw.runs.run import Run
from drake_screw.visualization.figure_files import figure_address
from drake_screw.visualization.maps_in_one_scale import MapOf, maps_in_one_scale, planes_shared
from drake_screw.visualization.meshcat_page import render
from drake_screw.visualization.outlines import outlines
from drake_screw.visualization.palette import INK, OUTCOME_COLORS, failure_color, ink_on

ROWS = 100
"""Regions listed of each table; all are in the result as JSON."""


def write_compare_page(runs: Sequence[Run], comparison: Comparison, file: Path) -> Path:
    """Write a page.

    Args:
        runs: that were compared.
        comparison: what it found.
        file: to write.

    Returns:
        The page.

    Raises:
        DrakeScrewError: it cannot be written there.
    """
    text = compare_page(runs, comparison)
    with writing(file, writable("--html"), DrakeScrewError):
        write_text(file, text)
    return file


def compare_page(runs: Sequence[Run], comparison: Comparison) -> str:
    """The page's HTML."""
    rounds = last_rounds(runs)
    maps = [
        MapOf(event, event.regions, outlines(runs[number - 1].setup.obstacles))
        for number, event in rounds.items()
    ]
    titles = [f"run {number}, round {event.round + 1}" for number, event in rounds.items()]
    colors = [
        OUTCOME_COLORS[Cause.SUCCESS if run.summary.certified else Cause.JOINT_LIMIT]
        for run in comparison.runs
    ]
    page = render(
        "drake_screw.web",
        "compare.html.j2",
        comparison=comparison,
        runs=list(zip(comparison.runs, colors, strict=True)),
        certificates=without_sentences(comparison.certificates),
        causes=list(dict.fromkeys(cause for run in comparison.runs for cause in run.outcomes)),
        maps=list(zip(titles, map(figure_address, maps_in_one_scale(maps, titles)), strict=True)),
        one_scale=planes_shared(maps),
        most=ROWS,
        shade=_shade,
    )
    return str(page) + "\n"


def _shade(rate: float | None) -> str:
    """The style of a cell with a failure rate, in the colours of the maps."""
    if rate is None:
        return f"color: {INK}"
    color: Any = failure_color(rate)
    red, green, blue = (round(255 * float(part)) for part in color)
    return f"background: rgb({red}, {green}, {blue}); color: {ink_on(color)}"
