"""A selection of recordings as seen in a terminal: progress, then what to keep and by how much."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table
from rich.text import Text

from drake_screw.acquisition import InstancesExecuted, RegionsEvaluated
from drake_screw.commands.console import certificate_panel, detail, round_table
from drake_screw.commands.countdown import Countdown, Pace
from drake_screw.commands.output import Output, print_table
from drake_screw.runs.selection import RegionRate, Selection
from drake_screw.runs.selection_events import Tried
from drake_screw.steps import Step


class SelectConsole:
    """A listener that shows a selection in a terminal: a bar, and a table for each attempt.

    To be used as a context manager, in which the bar is alive.

    Args:
        console: to write to; a live display only where it is a terminal.
    """

    def __init__(self, console: Console) -> None:
        self._console, self._shown = console, Countdown(console)
        self._attempt, self._pace = "", Pace()

    def __enter__(self) -> SelectConsole:
        self._shown.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._shown.__exit__()

    def __call__(self, event: Step | RegionsEvaluated | InstancesExecuted | Tried) -> None:
        """Show an event."""
        match event:
            case Step():
                self._attempt = event.words
                self._shown(event)
            case InstancesExecuted():
                self._shown(Step(f"{self._attempt}, executed", event.done, event.total))
            case RegionsEvaluated():
                self._shown.detail(self._attempt, detail(event, self._pace))
            case Tried():
                self._console.print(Text(_tried(event)))
                print_table(self._console, round_table(event.verdict, event.regions))


def show_selection(found: Selection, budget: int, output: Output) -> None:
    """What to keep, how it compares with other sets, and the certificate.

    Args:
        found: the selection.
        budget: the scenario's, most demonstrations.
        output: to write to.
    """
    for recording in found.passed_over:
        output.say(f"not used: {recording.name}: {recording.reason}")
    each, without = found.table.instances_per_region, ", and what those kept solve without it"
    output.say(
        f"what each recording solves of {each:,} instances in each region"
        f"{without if found.chosen else ''}:"
    )
    output.print_table(recordings_table(found))
    if found.short:
        output.say("where another demonstration is needed, as even all recordings together fail:")
        output.print_table(short_table(found.short))
    for sentence in found.margin:
        output.say(sentence)
    output.console.print(certificate_panel(found.statement, certified=found.certified))
    if found.certified:
        output.say(f"for a scenario that starts from them:\n\n{found.snippet(budget)}")


def recordings_table(found: Selection) -> Table:
    """A line for each recording: what it solves of the table, and what is lost without it."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("recording", no_wrap=True)
    names = ("solves", "weakest region", "", "without it", "weakest region")
    for name in names if found.chosen else names[:2]:
        table.add_column(name, justify="right", no_wrap=True)
    for one in found.recordings:
        cells = [one.name, f"{one.alone:.1%}", f"{one.alone_in_weakest:.1%}"]
        if one.without is not None and one.without_in_weakest is not None:
            cells += ["kept", f"{one.without:.1%}", f"{one.without_in_weakest:.1%}"]
        table.add_row(*cells, style="bold" if one.chosen else None)
    return table


def short_table(short: tuple[RegionRate, ...]) -> Table:
    """The regions that are too much for all recordings together."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("region", justify="right", no_wrap=True)
    table.add_column("where", overflow="fold", min_width=24)
    for name in ("instances", "failures", "rate"):
        table.add_column(name, justify="right", no_wrap=True)
    for one in short:
        rate = one.failures / one.samples
        table.add_row(
            str(one.region), one.name, f"{one.samples:,}", f"{one.failures:,}", f"{rate:.4f}"
        )
    return table


def _tried(event: Tried) -> str:
    tried, verdict = event.attempt, event.verdict
    weakest = verdict.estimates[verdict.region]
    return (
        f"attempt {event.number}: {', '.join(tried.recordings)}; {tried.instances:,} instances; "
        f"weakest region {verdict.region} ({event.regions.name(verdict.region)}) fails "
        f"{weakest:.2%}; {tried.reason}"
    )
