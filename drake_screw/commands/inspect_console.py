"""A run's attempts as seen in a terminal, beside the browser or a page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from drake_screw.commands.countdown import Countdown
from drake_screw.commands.output import print_table
from drake_screw.runs.reader import RunReader
from drake_screw.runs.run import open_run
from drake_screw.steps import Step
from drake_screw.visualization.attempt import Attempt, headline
from drake_screw.visualization.palette import OUTCOME_NAMES
from drake_screw.web.inspector_page import save_page, serve
from drake_screw.web.inspector_panel import where
from drake_screw.web.selection import Selection, select
from drake_screw.web.server import warning


def inspect_run(
    run: Path,
    console: Console,
    *,
    round: int | None = None,
    instance: int | None = None,
    html: Path | None = None,
    host: str = "localhost",
    port: int | None = None,
) -> None:
    """Look at a run: in the terminal, and in the browser or on a page.

    Args:
        run: its directory, finished or not.
        console: to write to.
        round: counted from 1; if None the last one that asked for a demonstration.
        instance: a row of the round's instances, from 0; if None the suggested one, or the
            earliest failing.
        html: a page to write, with its numbers beside it; if None, serve until interrupted.
        host, port: as in `serve`.

    Raises:
        RunDirectoryError: the directory is damaged, of another version, or has no round yet.
        ScenarioError: there is no such round or instance.
        DrakeScrewError: the page cannot be served there, or written.
    """
    with Countdown(console) as shown:
        shown(Step("reading the run"))
        reader = open_run(run).reader
        first = select(reader, reader.check_round(round), instance)
        if html is not None:
            shown(Step("drawing the instance"))
            page = save_page(reader, first, html)
    if html is not None:
        print_instance(reader, first, console)
        console.print(f"written: {page}, its numbers beside it (.csv, .json)", soft_wrap=True)
        return
    risk = warning(host)

    def announce(text: str) -> None:
        if text == risk:
            console.print(text, style="yellow", highlight=False, soft_wrap=True)
        else:
            console.print(text, soft_wrap=True)

    def on_selection(selection: Selection) -> None:
        show = print_instance if selection is first else _print_place
        show(reader, selection, console)

    serve(reader, first, host=host, port=port, announce=announce, on_selection=on_selection)


def print_instance(reader: RunReader, selection: Selection, console: Console) -> None:
    """An instance and all its attempts in words and as a table."""
    if selection.instance is None:
        console.print("this round has no instances")
        return
    attempts = reader.attempts(selection.round, selection.instance)
    _print_place(reader, selection, console)
    print_table(console, instance_table(attempts))
    for tried in attempts:
        text = f"demonstration {tried.number + 1} {headline(tried)}"
        console.print(Text(text), soft_wrap=True)


def instance_table(attempts: Sequence[Attempt]) -> Table:
    """All demonstrations of an instance side by side."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    at_fault = "bodies" if any(a.bodies for a in attempts) else "joint"
    if at_fault == "bodies" and any(a.failed_joint is not None for a in attempts):
        at_fault = "joint or bodies"
    for name in ("", "demonstration", "outcome", "segment", at_fault, "along it", "least margin"):
        right = name in ("", "segment", "along it", "least margin")
        table.add_column(name, justify="right" if right else "left")
    for tried in attempts:
        joint, margin = tried.tightest
        names, failed, at = tried.arm.joint_names, tried.failed_segment, tried.failed_joint
        table.add_row(
            str(tried.number + 1),
            tried.demonstration.name,
            Text(OUTCOME_NAMES[tried.cause], style="green" if tried.plan.success else "yellow"),
            "" if failed is None else f"{failed + 1} of {len(tried.guides)}",
            names[at] if at is not None else ", ".join(tried.bodies[0]) if tried.bodies else "",
            "" if failed is None else f"{float(tried.plan.outcome.fraction):.1%}",
            f"{margin:.3f} ({names[joint]})" if np.isfinite(margin) else "no limits",
        )
    return table


def _print_place(reader: RunReader, selection: Selection, console: Console) -> None:
    if selection.instance is not None:
        coordinates = reader.event(selection.round).evaluation.coordinates[selection.instance]
        place = where(reader.setup.area, coordinates)
        words = f"round {selection.round + 1}, instance {selection.instance}: {place}"
        console.print(Text(words), soft_wrap=True)
