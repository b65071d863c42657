"""``drake-screw study``: how many demonstrations a certificate takes, by number of regions."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from drake_screw.commands.options import (
    DemonstrationsOption,
    JsonOption,
    ModelOption,
    ScenarioUnlessResumed,
    SchedulerOption,
    SeedOption,
    SetOption,
    VerboseOption,
    WorkersOption,
    check_resumed_alone,
    chosen_scenario,
    chosen_workers,
)
from drake_screw.commands.output import Output
from drake_screw.commands.signals import INTERRUPTED

EXAMPLE = "drake-screw study pouring --regions 1,4,16 --runs 200"


def study(
    scenario: ScenarioUnlessResumed = None,
    regions: Annotated[
        str, typer.Option(metavar="K,K,...", help="Numbers of regions to compare.")
    ] = "1,2,4,8,16",
    runs: Annotated[int, typer.Option(help="Runs for each number of regions.", min=1)] = 1000,
    demonstrations: DemonstrationsOption = None,
    model: ModelOption = None,
    seed: SeedOption = None,
    output: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="The study directory. Default: studies/SCENARIO/TIME."),
    ] = None,
    resume: Annotated[
        Path | None, typer.Option(metavar="STUDY", help="Carry an interrupted study on.")
    ] = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
    set_: SetOption = None,
    json: JsonOption = None,
    verbose: VerboseOption = False,
) -> None:
    """Measure how many demonstrations a certificate takes.

    For several numbers of regions; every run has fresh samples. Runs are shared out among
    processes, or on a cluster (docs/cluster.md), which makes no difference to the result.
    """
    if resume is not None:
        check_resumed_alone("study", scenario, demonstrations, model, seed, output, set_)
    out = Output(json)
    from drake_screw.commands.study_console import show_study
    from drake_screw.studies.experiment import numbers_of_regions
    from drake_screw.studies.study import new_study, open_study

    if resume is None:
        numbers = numbers_of_regions(regions)
        loaded = chosen_scenario(scenario, set_, model, seed=seed, demonstrations=demonstrations)
        begin = partial(new_study, loaded, numbers, runs, output)
    else:
        begin = partial(open_study, resume)
    with chosen_workers(workers, scheduler, out) as shared:
        job = begin()
        try:
            found = show_study(job, out.console, workers=shared)
        except KeyboardInterrupt:
            out.say(f"interrupted; carry on with: drake-screw study --resume {job.path}")
            raise typer.Exit(INTERRUPTED) from None
    out.write(found)
