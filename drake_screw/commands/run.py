"""``drake-screw run``: demonstrations are acquired until every region is covered."""

from __future__ import annotations

import logging
from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from drake_screw.commands.options import (
    DemonstrationsOption,
    JsonOption,
    ModelOption,
    ScenarioUnlessResumed,
    SeedOption,
    SetOption,
    VerboseOption,
    check_resumed_alone,
    chosen_scenario,
)
from drake_screw.commands.output import Output
from drake_screw.commands.signals import INTERRUPTED

_log = logging.getLogger(__name__)

EXAMPLE = "drake-screw run pouring --seed 7 --set coverage.beta=0.9"


def run(
    scenario: ScenarioUnlessResumed = None,
    demonstrations: DemonstrationsOption = None,
    model: ModelOption = None,
    seed: SeedOption = None,
    output: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="The run directory. Default: runs/SCENARIO/TIME."),
    ] = None,
    resume: Annotated[
        Path | None, typer.Option(metavar="RUN", help="Carry an interrupted run on.")
    ] = None,
    set_: SetOption = None,
    meshcat: Annotated[
        bool, typer.Option("--meshcat", help="Show the run in the browser as it goes on.")
    ] = False,
    host: Annotated[
        str, typer.Option(help="Address on which the pages listen.", show_default=True)
    ] = "localhost",
    port: Annotated[
        int | None,
        typer.Option(
            help="Port of the page, and the next one if there are two. Default: free ones."
        ),
    ] = None,
    json: JsonOption = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print just the end.")] = False,
    verbose: VerboseOption = False,
) -> None:
    """Acquire demonstrations until every region is covered.

    Exit code 0: certified. 1: ended without a certificate. 2: bad input.
    130: interrupted; --resume carries the run on.
    """
    if quiet:
        logging.getLogger("drake_screw").setLevel(logging.WARNING)
    if resume is not None:
        check_resumed_alone("run", scenario, demonstrations, model, seed, output, set_)
    out = Output(json)
    from drake_screw.acquisition import Event
    from drake_screw.commands.console import RunConsole, show_summary
    from drake_screw.runs.narration import describe
    from drake_screw.runs.run import new_run, open_run, resumable
    from drake_screw.runs.summary import summarize_run
    from drake_screw.web.run_pages import RunPages

    if resume is None:
        loaded = chosen_scenario(scenario, set_, model, seed=seed, demonstrations=demonstrations)
    else:
        loaded = resumable(open_run(resume)).setup.scenario

    def log(event: Event) -> None:
        _log.debug("%s", describe(event, job.setup.regions))

    with RunPages(loaded, watched=meshcat, host=host, port=port, announce=out.say) as pages:
        job = (
            new_run(loaded, output, **pages.parts)
            if resume is None
            else open_run(resume, **pages.parts)
        )
        pages.open(job.setup, job.directory.path)
        if loaded.teacher.kind == "simulated" and not quiet:
            for line in job.setup.assumptions:
                out.say(f"note: {line}")
        try:
            with RunConsole(out.console, job.setup.regions, quiet=quiet) as shown:
                for _ in job.events([*pages.listeners, log, shown]):
                    pass
        except KeyboardInterrupt:
            out.say(f"interrupted; carry on with: drake-screw run --resume {job.directory.path}")
            raise typer.Exit(INTERRUPTED) from None
        summary = summarize_run(job)
        show_summary(summary, out.console)
        out.write(summary)
        if pages.live is not None and out.console.is_terminal:
            with suppress(EOFError, KeyboardInterrupt):
                out.console.input("the page stays until you press Enter ")
    raise typer.Exit(0 if summary.certified else 1)
