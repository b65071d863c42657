"""A study as seen in a terminal: a bar for each number of regions, then the table."""

from __future__ import annotations

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from drake_screw.studies.study import Study


def show_study(
    study: Study, console: Console, *, workers: int | None = None, quiet: bool = False
) -> None:
    """Carry a study out, showing how far it is, and tell what it found.

    Args:
        study: new or opened.
        console: to write to; live bars only where it is a terminal.
        workers: processes; as many as processors if None.
        quiet: nothing but the result.
    """
    live = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[mean]}"),
        TimeRemainingColumn(),
        console=console,
        transient=True,
        disable=quiet or not console.is_terminal,
    )
    total = dict.fromkeys(study.regions, 0)
    with live:
        bars = {K: live.add_task(f"K = {K}", total=study.runs, mean="") for K in study.regions}
        for run in study.finished_runs():
            total[run.K] += run.demonstrations
            live.advance(bars[run.K])
        for run in study.carry_out(workers):
            total[run.K] += run.demonstrations
            live.advance(bars[run.K])
            done = live.tasks[bars[run.K]].completed
            live.update(bars[run.K], mean=f"{total[run.K] / done:.2f} demonstrations")
    console.print(summary_table(study))
    console.print(Text(f"study directory: {study.path}"), soft_wrap=True)


def summary_table(study: Study) -> Table:
    """A line for each K: runs, certified, and how many demonstrations those needed."""
    table = Table(title="demonstrations until the certificate", box=None, padding=(0, 1, 0, 0))
    for name in ("K", "runs", "certified", "mean", "at most"):
        table.add_column(name, justify="right")
    table.add_column("distribution", no_wrap=False)
    for K, found in study.summary().items():
        shares = (f"{n}: {count / found.runs:.1%}" for n, count in found.counts.items())
        table.add_row(
            str(K),
            f"{found.runs:,}",
            f"{len(found.numbers):,}",
            f"{found.mean:.2f}",
            str(found.most),
            ", ".join(shares),
        )
    return table
