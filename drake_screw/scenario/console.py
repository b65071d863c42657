"""A run as seen in a terminal: live progress, a table for each round, the certificate."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.panel import Panel
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from drake_screw.acquisition import (
    DemonstrationRequested,
    Event,
    Finished,
    RegionsEvaluated,
    RoundFinished,
    RoundStarted,
    Status,
)
from drake_screw.bandits import Verdict
from drake_screw.scenario.certificate import certificate, statement
from drake_screw.scenario.live import LiveView
from drake_screw.scenario.narration import describe
from drake_screw.scenario.runner import Run
from drake_screw.scenario.teaching import desk_of
from drake_screw.tasks import Regions

_ROWS = 24


def show(
    run: Run, console: Console, *, quiet: bool = False, view: LiveView | None = None
) -> Finished:
    """Carry a run out, showing its events as they happen.

    Args:
        run: new or resumed.
        console: to write to; a live display only where it is a terminal.
        quiet: nothing but the certificate.
        view: hears of everything, too; so does the desk of an interactive teacher.

    Returns:
        The run's last event.
    """
    regions, desk = run.setup.regions, desk_of(run.setup)
    live = _progress(console, hidden=quiet)
    with live:
        task = live.add_task("starting", total=None, detail="")
        if desk is not None:
            desk.announce = lambda text: live.console.print(Text(text), soft_wrap=True)

        def progress(event: RegionsEvaluated) -> None:
            rates = event.failures / np.maximum(event.samples, 1)
            worst = int(np.argmax(rates))
            detail = f"{event.samples.sum():>9,} instances, "
            if len(rates) == 1:
                detail += f"{event.failures[0]:,} failures"
            else:
                detail += f"highest failure rate {rates[worst]:6.2%} in region {worst}"
            live.update(task, detail=detail)
            if view is not None:
                view.progress(event)

        for event in run.events(progress):
            if view is not None:
                view.hear(event)
            if desk is not None:
                desk.hear(event)
            if isinstance(event, DemonstrationRequested):
                words = f"waiting for demonstration {event.number + 1}"
                live.update(task, description=words, detail="")
            if isinstance(event, RoundStarted):
                live.update(task, description=describe(event, regions), detail="")
            elif not quiet and not isinstance(event, Finished):
                live.console.print(Text(describe(event, regions)))
            if isinstance(event, RoundFinished) and not quiet:
                live.console.print(round_table(event.verdict, event.regions))
            finished = event
        live.update(task, visible=False)
    assert isinstance(finished, Finished)
    show_certificate(run, finished, console)
    return finished


def tell(run: Run, events: Iterable[Event], console: Console) -> None:
    """Show events that have happened before."""
    for event in events:
        if isinstance(event, Finished):
            show_certificate(run, event, console)
        elif not isinstance(event, RoundStarted):
            console.print(Text(describe(event, run.setup.regions)))
            if isinstance(event, RoundFinished):
                console.print(round_table(event.verdict, event.regions))


def show_certificate(run: Run, finished: Finished, console: Console) -> None:
    """The statement a finished run makes, and where to find the rest."""
    stated = certificate(run.setup, finished, run.directory.record["rounds"])
    certified = finished.status is Status.CERTIFIED
    console.print(
        Panel(
            Text("\n".join(statement(stated, finished.reason))),
            title="certificate" if certified else "no certificate",
            border_style="green" if certified else "yellow",
            title_align="left",
        )
    )
    console.print(Text(f"run directory: {run.directory.path}"), soft_wrap=True)


def round_table(verdict: Verdict, regions: Regions) -> Table:
    """Regions of a round with their counts; with many regions, the worst of them."""
    shown = np.arange(regions.K)
    title = None
    if regions.K > _ROWS:
        shown = np.argsort(-np.nan_to_num(verdict.estimates), kind="stable")[:_ROWS]
        title = f"the {_ROWS} regions that fail most, of {regions.K}"
    table = Table(title=title, box=None, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column("region", justify="right", no_wrap=True)
    table.add_column("where", overflow="fold", min_width=24)
    for name in ("samples", "failures", "rate", "at most"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    for j in shown.tolist():
        weakest = j == verdict.region
        table.add_row(
            str(j),
            regions.name(j),
            f"{verdict.samples[j]:,}",
            f"{verdict.failures[j]:,}",
            f"{verdict.estimates[j]:.4f}",
            f"{verdict.upper[j]:.4f}",
            _bar(verdict.estimates, j) + (" <" if weakest else ""),
            style="bold" if weakest else None,
        )
    return table


def _bar(estimates: NDArray[np.float64], region: int) -> str:
    share = float(np.nan_to_num(estimates[region]))
    return "█" * int(np.ceil(8 * share)) if share > 0 else ""


def _progress(console: Console, *, hidden: bool) -> Progress:
    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(bar_width=12),
        TextColumn("{task.fields[detail]}"),
        TimeElapsedColumn(),
        console=console,
        transient=True,
        disable=hidden or not console.is_terminal,
    )
