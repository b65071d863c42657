"""The ``drake-screw`` command. Every verb is one call into the library."""

from __future__ import annotations

import logging
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from drake_screw.errors import DrakeScrewError

if TYPE_CHECKING:
    from drake_screw.scenario.schema import Scenario

app = typer.Typer(
    name="drake-screw",
    help="Manipulation plans from few demonstrations: measure how much of a work area they cover, "
    "and learn where to give the next one.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 80},
)

ScenarioArgument = Annotated[
    str, typer.Argument(metavar="SCENARIO", help="A shipped scenario's name, or a YAML file.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key, as in coverage.beta=0.9."),
]
ModelOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Another robot model with the same joint names."),
]


def _load(scenario: str, changes: list[str] | None, model: Path | None) -> Scenario:
    from drake_screw.scenario.loader import load_scenario

    loaded = load_scenario(scenario, changes or [])
    if model is None:
        return loaded
    from drake_screw.scenario.swap import swap_model

    return swap_model(loaded, model)


@app.callback()
def _quieten() -> None:
    # Importing pydrake sets its logger's level, so it has to be lowered afterwards.
    import pydrake.common  # noqa: F401

    logging.getLogger("drake").setLevel(logging.WARNING)


@app.command(epilog="Example:  drake-screw run pouring --seed 7 --set coverage.beta=0.9")
def run(
    scenario: Annotated[
        str | None,
        typer.Argument(metavar="SCENARIO", help="A shipped scenario's name, or a YAML file."),
    ] = None,
    demonstrations: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Ask this folder of recordings, not a simulated teacher."),
    ] = None,
    model: ModelOption = None,
    seed: Annotated[int | None, typer.Option(help="Seed of all random draws.")] = None,
    output: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="The run directory. Default: runs/SCENARIO/TIME."),
    ] = None,
    resume: Annotated[
        Path | None, typer.Option(metavar="RUN", help="Carry an interrupted run on.")
    ] = None,
    set_: SetOption = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print just the end.")] = False,
) -> None:
    """Acquire demonstrations until every region is covered, and certify it.

    Exit code 0: certified. 1: ended without a certificate. 2: bad input.
    130: interrupted; --resume carries the run on.
    """
    from drake_screw.scenario.console import show
    from drake_screw.scenario.runner import new_run, open_run, resumable

    console = Console()
    if resume is not None:
        given = [scenario, demonstrations, model, seed, output, set_]
        if any(value is not None for value in given):
            raise DrakeScrewError(
                "--resume goes alone: a run is carried on as it was begun",
                remedy="Give just: drake-screw run --resume RUN",
            )
        job = resumable(open_run(resume))
    elif scenario is None:
        raise DrakeScrewError(
            "no scenario", remedy="Give a scenario, as in: drake-screw run pouring"
        )
    else:
        changes = [*(set_ or []), *([f"seed={seed}"] if seed is not None else [])]
        if demonstrations is not None:
            folder = demonstrations.resolve()
            changes += ["teacher={kind: recorded}", f"teacher.folder={folder}"]
        job = new_run(_load(scenario, changes, model), output)
    try:
        finished = show(job, console, quiet=quiet)
    except KeyboardInterrupt:
        command = f"drake-screw run --resume {job.directory.path}"
        console.print(f"interrupted; carry on with: {command}", soft_wrap=True)
        raise typer.Exit(130) from None
    raise typer.Exit(0 if finished.status == "certified" else 1)


@app.command(
    epilog="Example:  drake-screw evaluate pouring --demonstrations demos --instances places.csv "
    "--output outcomes.csv"
)
def evaluate(
    scenario: ScenarioArgument,
    demonstrations: Annotated[
        Path, typer.Option(metavar="DIR", help="A folder of recordings.", show_default=False)
    ],
    instances: Annotated[
        Path, typer.Option(metavar="CSV", help="Columns x, y and perhaps yaw; m and rad.")
    ],
    output: Annotated[Path, typer.Option(metavar="CSV", help="Where to write the outcomes.")],
    model: ModelOption = None,
    set_: SetOption = None,
) -> None:
    """Plan every listed instance with every demonstration of a folder.

    The output has a column for each demonstration; its cells are 0:0 for success, s:j failed in
    screw segment s at the limit of joint j (both counted from 1), s:n unreachable, s:c collision.
    """
    from drake_screw.scenario.evaluate import evaluate as carry_out

    loaded = _load(scenario, set_, model)
    Console().print(carry_out(loaded, demonstrations, instances, output), highlight=False)


@app.command(epilog="Example:  drake-screw check my_scenario.yaml")
def check(scenario: ScenarioArgument, model: ModelOption = None, set_: SetOption = None) -> None:
    """Check a scenario and the files it names, and tell what would run."""
    from drake_screw.scenario.check import check as carry_out

    Console().print(carry_out(_load(scenario, set_, model)), highlight=False)


@app.command(epilog="Example:  drake-screw report runs/pouring/2026-11-22_10-15-00")
def report(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="A finished run's directory.")],
) -> None:
    """Tell a finished run again, and draw its pictures anew."""
    from drake_screw.scenario.console import tell
    from drake_screw.scenario.runner import open_run, redraw

    job, console = open_run(run), Console()
    tell(job, job.replay(), console)
    redraw(job)


def main() -> None:
    """Run the command; bad input prints one message and ends with exit code 2."""
    try:
        app()
    except DrakeScrewError as error:
        console = Console(stderr=True, soft_wrap=True)
        console.print(f"error: {error}", style="red", markup=False, highlight=False)
        sys.exit(2)


if __name__ == "__main__":
    main()
