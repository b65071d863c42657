"""A run as seen in a terminal: live progress, a table for each round, the certificate."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from drake_screw.acquisition import (
    DemonstrationRequested,
    Event,
    Finished,
    InstancesExecuted,
    RegionsEvaluated,
    RoundFinished,
    RoundStarted,
)
from drake_screw.bandits import Verdict
from drake_screw.commands.countdown import Pace, shown_progress
from drake_screw.commands.output import print_table
from drake_screw.runs.narration import describe
from drake_screw.runs.summary import RunSummary
from drake_screw.tasks import Regions

_log = logging.getLogger(__name__)

_ROWS = 24


class RunConsole:
    """A listener that shows a run in a terminal: a progress bar, and a table for each round.

    To be used as a context manager, in which the bar is alive.

    Args:
        console: to write to; a live display only where it is a terminal.
        regions: of the run, where they do not refine themselves.
        quiet: show nothing.
    """

    def __init__(self, console: Console, regions: Regions, *, quiet: bool = False) -> None:
        self._regions, self._quiet = regions, quiet
        self._live = shown_progress(console, hidden=quiet)
        self._task = self._live.add_task("starting", total=None, detail="")
        self._terminal, self._pace = console.is_terminal, Pace()

    def __enter__(self) -> RunConsole:
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.update(self._task, visible=False)
        self._live.stop()

    def __call__(self, event: Event) -> None:
        """Show an event."""
        match event:
            case RegionsEvaluated():
                self._live.update(self._task, detail=detail(event, self._pace))
            case InstancesExecuted():
                words = f"executed {self._pace.of(event.done, event.total)}"
                self._live.update(self._task, detail=words)
                if not self._terminal and not self._quiet and self._pace.due():
                    _log.info("round %d: %s", event.round + 1, words)
            case RoundStarted():
                words = describe(event, self._regions)
                self._live.update(self._task, description=words, detail="")
            case DemonstrationRequested():
                words = f"waiting for demonstration {event.number + 1}"
                self._live.update(self._task, description=words, detail="")
        if not self._quiet:
            show_event(event, self._regions, self._live.console)


def show_event(event: Event, regions: Regions, console: Console) -> None:
    """An event in words, and for a round its table; nothing where there is nothing to keep."""
    if isinstance(event, RegionsEvaluated | InstancesExecuted | RoundStarted | Finished):
        return
    console.print(Text(describe(event, regions)))
    if isinstance(event, RoundFinished):
        print_table(console, round_table(event.verdict, event.regions))


def show_summary(summary: RunSummary, console: Console) -> None:
    """The statement a finished run makes, and where to find the rest."""
    console.print(certificate_panel(summary.statement, certified=summary.certified))
    if summary.collisions is not None and summary.collisions.collisions:
        console.print(Text(f"in the last round {summary.collisions}"), soft_wrap=True)
    if summary.executions is not None:
        console.print(Text(f"in the last round {summary.executions}"), soft_wrap=True)
    console.print(Text(f"run directory: {summary.directory}"), soft_wrap=True)


def certificate_panel(statement: Sequence[str], *, certified: bool) -> Panel:
    """A statement's sentences in a frame."""
    return Panel(
        Text("\n".join(statement)),
        title="certificate" if certified else "no certificate",
        border_style="green" if certified else "yellow",
        title_align="left",
    )


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
        weakest = j == verdict.weakest
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


def detail(event: RegionsEvaluated, pace: Pace) -> str:
    """How far a round is, on one line; with the time left where its size is known."""
    rates = event.failures / np.maximum(event.samples, 1)
    done = int(event.samples.sum())
    drawn = f"{done:>9,} instances, " if event.total is None else f"{pace.of(done, event.total)}, "
    if len(rates) == 1:
        return f"{drawn}{event.failures[0]:,} failures"
    worst = int(np.argmax(rates))
    return f"{drawn}highest failure rate {rates[worst]:6.2%} in region {worst}"


def _bar(estimates: NDArray[np.float64], region: int) -> str:
    share = float(np.nan_to_num(estimates[region]))
    return "█" * int(np.ceil(8 * share)) if share > 0 else ""
