"""``drake-screw report``: a finished run, shown and drawn again from its directory."""

from __future__ import annotations

from typing import Annotated

import typer

from drake_screw.commands.options import JsonOption, RunArgument, VerboseOption
from drake_screw.commands.output import Output

EXAMPLE = "drake-screw report runs/pouring/2026-11-22_10-15-00"


def report(
    run: RunArgument,
    svg: Annotated[
        bool, typer.Option("--svg", help="Draw the pictures as SVG, too, to be printed large.")
    ] = False,
    axes: Annotated[
        str | None,
        typer.Option(
            metavar="AXIS,AXIS",
            help="Axes of the heat maps, upwards and sideways, as in cup.x,bowl.y. Default: x,y of "
            "the first object that may move in both.",
        ),
    ] = None,
    json: JsonOption = None,
    verbose: VerboseOption = False,
) -> None:
    """Show a finished run, and write report.html.

    Draws all of its pictures again, too.
    """
    output = Output(json)
    from drake_screw.commands.console import show_event, show_summary
    from drake_screw.commands.countdown import Countdown
    from drake_screw.steps import Step

    with Countdown(output.console) as shown:
        from drake_screw.runs.pictures import plane_of
        from drake_screw.runs.redrawing import redraw
        from drake_screw.runs.run import open_run
        from drake_screw.runs.summary import summarize_run
        from drake_screw.web.report_page import write_report

        shown(Step("reading the run"))
        job = open_run(run)
        plane = None if axes is None else plane_of(job.setup, axes.split(","))
        events = list(job.replay())
        summary = summarize_run(job)
        for event in events:
            show_event(event, job.setup.regions, output.console)
        show_summary(summary, output.console)
        redraw(job.reader, plane, svg=svg, tell=shown)
        written = write_report(job.reader, tell=shown)
    output.say(f"written: {written}")
    output.write(summary)
