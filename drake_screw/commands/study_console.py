"""A study as seen in a terminal: a bar for each number of regions, then the table."""

from __future__ import annotations

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from drake_screw.commands.output import print_table
from drake_screw.sharing import Workers
from drake_screw.studies.findings import Findings, findings
from drake_screw.studies.study import Study


def show_study(study: Study, console: Console, *, workers: Workers = None) -> Findings:
    """Carry a study out, showing how far it is and what it found.

    Args:
        study: new or opened.
        console: to write to; live bars only where it is a terminal.
        workers: processes, as many as processors if None; or a cluster.
    """
    live = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[mean]}"),
        TimeRemainingColumn(),
        console=console,
        transient=True,
        disable=not console.is_terminal,
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
    found = findings(study)
    print_table(console, findings_table(found))
    console.print(Text(f"study directory: {found.directory}"), soft_wrap=True)
    return found


def findings_table(found: Findings) -> Table:
    """A line for each K: runs, certified, and how many demonstrations those needed."""
    table = Table(title="demonstrations until the certificate", box=None, padding=(0, 1, 0, 0))
    for name in ("K", "runs", "certified", "mean", "at most"):
        table.add_column(name, justify="right")
    table.add_column("distribution", no_wrap=False)
    for of_K in found.regions:
        shares = (f"{n}: {count / of_K.runs:.1%}" for n, count in of_K.counts.items())
        table.add_row(
            str(of_K.K),
            f"{of_K.runs:,}",
            f"{of_K.certified:,}",
            f"{of_K.mean:.2f}",
            str(of_K.most),
            ", ".join(shares),
        )
    return table
