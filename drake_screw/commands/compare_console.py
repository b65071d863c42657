"""Runs side by side in a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from drake_screw.commands.console import certificate_panel
from drake_screw.commands.output import Output
from drake_screw.runs.common_regions import RegionTable
from drake_screw.runs.comparison import ComparedRun, Comparison, without_sentences
from drake_screw.scenario.differences import Difference

_ROWS = 24
_LONGEST = 60
"""Characters of a value."""


def show_comparison(comparison: Comparison, output: Output) -> None:
    """All of a comparison, the longest tables cut short."""
    output.print_table(_overview(comparison.runs))
    for note in comparison.notes:
        output.say(f"note: {note}")
    count = len(comparison.runs)
    for title, found in (
        ("scenarios", comparison.scenario),
        ("what runs were made with", comparison.made_with),
    ):
        if found:
            _heading(output, f"{title}, where they differ")
            output.print_table(_differences(found, count))
        else:
            _heading(output, f"{title}: no difference")
    _heading(output, "demonstrations")
    output.print_table(_demonstrations(comparison.runs))
    for table in comparison.regions:
        _heading(output, _title(table))
        output.print_table(_regions(table))
    _heading(output, "instances of the last round, by their best attempts")
    output.print_table(_outcomes(comparison.runs))
    for shared in comparison.shared:
        for line in shared.lines:
            output.say(line)
    _heading(output, "certificates")
    stated = without_sentences(comparison.certificates)
    if stated:
        output.print_table(_differences(stated, count))
    for number, run in enumerate(comparison.runs, start=1):
        panel = certificate_panel(run.summary.statement, certified=run.summary.certified)
        panel.title = f"run {number}: {panel.title}"
        output.console.print(panel)


def _heading(output: Output, text: str) -> None:
    output.console.print()
    output.console.print(Text(text, style="bold"), soft_wrap=True)


def _table(*columns: str, numbers: Sequence[str] = ()) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for name in columns:
        table.add_column(name, overflow="fold")
    for name in numbers:
        table.add_column(name, justify="right", no_wrap=True)
    return table


def _overview(runs: Sequence[ComparedRun]) -> Table:
    table = _table(
        "run",
        "directory",
        "scenario",
        "status",
        numbers=("seed", "demonstrations", "rounds", "regions", "success", "in the weakest"),
    )
    for number, run in enumerate(runs, start=1):
        summary = run.summary
        table.add_row(
            str(number),
            Text(str(summary.directory)),
            Text(summary.scenario),
            summary.status,
            str(summary.seed),
            str(len(run.demonstrations)),
            str(len(summary.rounds)),
            "-" if run.regions is None else f"{run.regions:,}",
            _share(run.success),
            _share(run.success_in_weakest),
        )
    return table


def _differences(found: Sequence[Difference], count: int) -> Table:
    table = _table("key", *(f"run {number + 1}" for number in range(count)))
    for difference in found:
        words = (_short(text) if text else "-" for text in difference.words)
        table.add_row(Text(difference.key), *map(Text, words))
    return table


def _demonstrations(runs: Sequence[ComparedRun]) -> Table:
    table = _table("run", "", "name", "also in run", "kept")
    for number, run in enumerate(runs, start=1):
        for place, lesson in enumerate(run.demonstrations, start=1):
            also = ", ".join(map(str, lesson.also_in)) or "-"
            kept = "; ".join(lesson.kept)
            table.add_row(str(number), str(place), Text(lesson.name), also, Text(kept))
    return table


def _title(table: RegionTable) -> str:
    title = f"regions of runs {', '.join(map(str, table.runs))}: share that fails, and at most"
    if len(table.regions) > _ROWS:
        title += f"; {_ROWS} of {len(table.regions):,}, those that differ or fail most"
    return title


def _regions(table: RegionTable) -> Table:
    shown = _table("region", "where")
    for number in table.runs:
        for name in (f"run {number}", "rate", "at most"):
            shown.add_column(name, justify="right", no_wrap=True)
    shown.add_column("")
    for row in table.telling(_ROWS):
        cells = []
        for k in range(len(table.runs)):
            rate = row.failure_rate[k]
            cells += [
                f"{row.failures[k]:,} / {row.samples[k]:,}",
                "-" if rate is None else f"{rate:.4f}",
                f"{row.at_most[k]:.4f}",
            ]
        differs = "differ" if row.apart else ""
        shown.add_row(
            str(row.region), row.name, *cells, differs, style="bold" if row.apart else None
        )
    return shown


def _outcomes(runs: Sequence[ComparedRun]) -> Table:
    causes = list(dict.fromkeys(cause for run in runs for cause in run.outcomes))
    table = _table("run", numbers=("instances", *causes))
    for number, run in enumerate(runs, start=1):
        counts = (f"{run.outcomes.get(cause, 0):,}" for cause in causes)
        table.add_row(str(number), f"{run.instances:,}", *counts)
    return table


def _share(value: float | None) -> str:
    return "-" if value is None else f"{value:.2%}"


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 4]} ..."
