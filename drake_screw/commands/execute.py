"""``drake-screw execute``: plans of a run, simulated with dynamics."""

from __future__ import annotations

from typing import Annotated

import typer

from drake_screw.commands.instance_option import instance_option, parse_instance
from drake_screw.commands.options import (
    JsonOption,
    RunArgument,
    SchedulerOption,
    VerboseOption,
    WorkersOption,
    chosen_workers,
)
from drake_screw.commands.output import Output
from drake_screw.errors import DrakeScrewError

EXAMPLE = "drake-screw execute runs/pouring/TIME --per-region 1"


def execute(
    run: RunArgument,
    per_region: Annotated[
        int | None, typer.Option(help="Instances to draw in every region. Default: 2.", min=1)
    ] = None,
    instance: Annotated[
        list[str] | None, instance_option("Just one, with the objects there.")
    ] = None,
    free_objects: Annotated[
        bool,
        typer.Option("--free-objects", help="Let objects be pushed, and report how far they are."),
    ] = False,
    live: Annotated[
        bool,
        typer.Option("--live", help="Serve a page to move the objects on while the arm plans."),
    ] = False,
    graphviz: Annotated[
        bool, typer.Option("--graphviz", help="Print the simulated diagram for dot, and stop.")
    ] = False,
    host: Annotated[str, typer.Option(help="Address on which that page listens.")] = "localhost",
    port: Annotated[int | None, typer.Option(help="Port of the page. Default: a free one.")] = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
    json: JsonOption = None,
    verbose: VerboseOption = False,
) -> None:
    """Simulate plans of a run, and check what the robot does.

    With the arm's dynamics and controllers. Reports joint limits, velocities, tracking, deviation
    from the screws and contacts; writes a table and a recording that plays in the browser. What
    is allowed is in the scenario's block execution. Objects are locked in place unless they are
    free; an object then has mass and friction, and stands on what is under it.
    With --live the diagram plans for itself, and follows objects that you move on its page
    until the hand is at them; nothing is written.

    Exit code 0: something was executed as planned. 1: nothing was. 2: bad input.
    """
    if graphviz and json is not None:
        raise DrakeScrewError(
            "--graphviz executes nothing, so there is no result for --json",
            remedy="Give one of them.",
        )
    if instance and per_region is not None:
        raise DrakeScrewError(
            "--instance names the one to execute, and --per-region draws others",
            remedy="Leave out --per-region to execute that one, or --instance to have some drawn.",
        )
    given = (
        ("--json", json),
        ("--per-region", per_region),
        ("--workers", workers),
        ("--scheduler", scheduler),
        ("--free-objects", free_objects or None),
    )
    if live and any(value is not None for _, value in given):
        named = next(name for name, value in given if value is not None)
        raise DrakeScrewError(
            f"--live simulates one execution as you watch, and has no use for {named}",
            remedy=f"Leave out {named}, or --live.",
        )
    output = Output(json)
    place = parse_instance(instance) if instance else None
    from drake_screw.commands.countdown import Countdown
    from drake_screw.runs import executions

    if graphviz:
        print(executions.station_graphviz(run, free_objects=free_objects, planning=live))
        return
    if live:
        from drake_screw.web.execution_page import execute_live

        done_live = execute_live(run, instance=place, host=host, port=port, announce=output.say)
        raise typer.Exit(0 if done_live else 1)
    count = 2 if per_region is None else per_region
    with (
        chosen_workers(workers, scheduler, output) as shared,
        Countdown(output.console, at_once=True) as countdown,
    ):
        done = executions.execute(
            run,
            per_region=count,
            instance=place,
            workers=shared,
            free_objects=free_objects,
            tell=countdown,
        )
    output.present(done)
    raise typer.Exit(0 if done.summary.flawless else 1)
