"""The ``drake-screw`` command. Every verb is one call into the library."""

from __future__ import annotations

import logging
import sys
from contextlib import suppress
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


DemonstrationsOption = Annotated[
    Path | None,
    typer.Option(metavar="DIR", help="Ask this folder of recordings, not a simulated teacher."),
]
SeedOption = Annotated[int | None, typer.Option(help="Seed of all random draws.")]
RunArgument = Annotated[Path, typer.Argument(metavar="RUN", help="A run's directory.")]
InstanceOption = Annotated[
    tuple[float, float] | None,
    typer.Option(metavar="X Y", help="Just this place of the object, in m."),
]


def _given(scenario: str | None) -> str:
    if scenario is None:
        raise DrakeScrewError("no scenario", remedy="Give one, as in: drake-screw run pouring")
    return scenario


def _changes(changes: list[str] | None, seed: int | None, demonstrations: Path | None) -> list[str]:
    all_changes = [*(changes or []), *([f"seed={seed}"] if seed is not None else [])]
    if demonstrations is not None:
        folder = demonstrations.resolve()
        all_changes += ["teacher={kind: recorded}", f"teacher.folder={folder}"]
    return all_changes


def _load(scenario: str, changes: list[str] | None, model: Path | None) -> Scenario:
    from drake_screw.scenario.loader import load_scenario

    loaded = load_scenario(scenario, changes or [])
    if model is None:
        return loaded
    from drake_screw.assembly.swap_model import swap_model

    return swap_model(loaded, model)


class _Terminal(logging.Handler):
    """Prints to what is the standard error then: a progress bar may have taken its place."""

    def emit(self, record: logging.LogRecord) -> None:
        print(self.format(record), file=sys.stderr)


@app.callback()
def _set_up_logging() -> None:
    # Importing pydrake sets its logger's level, so it has to be lowered afterwards.
    import pydrake.common  # noqa: F401

    logging.getLogger("drake").setLevel(logging.WARNING)
    own = logging.getLogger("drake_screw")
    own.setLevel(logging.INFO)
    if not own.handlers:
        own.addHandler(_Terminal())


@app.command(epilog="Example:  drake-screw run pouring --seed 7 --set coverage.beta=0.9")
def run(
    scenario: Annotated[
        str | None,
        typer.Argument(metavar="SCENARIO", help="A shipped scenario's name, or a YAML file."),
    ] = None,
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
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print just the end.")] = False,
) -> None:
    """Acquire demonstrations until every region is covered.

    Exit code 0: certified. 1: ended without a certificate. 2: bad input.
    130: interrupted; --resume carries the run on.
    """
    if quiet:
        logging.getLogger("drake_screw").setLevel(logging.WARNING)
    from drake_screw.acquisition import Finished
    from drake_screw.commands.console import RunConsole, show_certificate
    from drake_screw.runs.run import new_run, open_run, resumable
    from drake_screw.web.run_pages import RunPages

    console = Console()

    def announce(text: str) -> None:
        console.print(text, soft_wrap=True, markup=False)

    if resume is not None:
        given = [scenario, demonstrations, model, seed, output, set_]
        if any(value is not None for value in given):
            raise DrakeScrewError(
                "--resume goes alone: a run is carried on as it was begun",
                remedy="Give just: drake-screw run --resume RUN",
            )
        loaded = resumable(open_run(resume)).setup.scenario
    else:
        loaded = _load(_given(scenario), _changes(set_, seed, demonstrations), model)
    with RunPages(loaded, watched=meshcat, host=host, port=port, announce=announce) as pages:
        job = (
            new_run(loaded, output, **pages.parts)
            if resume is None
            else open_run(resume, **pages.parts)
        )
        pages.open(job.setup)
        try:
            with RunConsole(console, job.setup.regions, quiet=quiet) as shown:
                *_, finished = job.events([*pages.listeners, shown])
        except KeyboardInterrupt:
            command = f"drake-screw run --resume {job.directory.path}"
            console.print(f"interrupted; carry on with: {command}", soft_wrap=True)
            raise typer.Exit(130) from None
        assert isinstance(finished, Finished)
        show_certificate(job, console)
        if pages.live is not None and console.is_terminal:
            with suppress(EOFError, KeyboardInterrupt):
                console.input("the page stays until you press Enter ")
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
    from drake_screw.commands.evaluate import evaluate as carry_out

    loaded = _load(scenario, set_, model)
    Console().print(carry_out(loaded, demonstrations, instances, output), highlight=False)


@app.command(epilog="Example:  drake-screw check my_scenario.yaml")
def check(scenario: ScenarioArgument, model: ModelOption = None, set_: SetOption = None) -> None:
    """Check a scenario and its files; tell what would run."""
    from drake_screw.commands.check import check as carry_out

    Console().print(carry_out(_load(scenario, set_, model)), highlight=False)


@app.command(epilog="Example:  drake-screw report runs/pouring/2026-11-22_10-15-00")
def report(
    run: RunArgument,
) -> None:
    """Tell a finished run again, and draw its pictures anew."""
    from drake_screw.commands.console import show_certificate, show_event
    from drake_screw.runs.run import open_run, redraw
    from drake_screw.web.report_page import write_report

    job, console = open_run(run), Console()
    for event in list(job.replay()):
        show_event(event, job.setup.regions, console)
    show_certificate(job, console)
    redraw(job)
    console.print(f"written: {write_report(job.reader)}", soft_wrap=True)


@app.command(epilog="Example:  drake-screw study pouring --regions 1,4,16 --runs 200")
def study(
    scenario: Annotated[
        str | None,
        typer.Argument(metavar="SCENARIO", help="A shipped scenario's name, or a YAML file."),
    ] = None,
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
    workers: Annotated[
        int | None, typer.Option(help="Processes. Default: all processors.", min=1)
    ] = None,
    set_: SetOption = None,
) -> None:
    """Measure how many demonstrations a certificate takes.

    For several numbers of regions; every run has fresh samples and a random first demonstration.
    """
    from drake_screw.commands.study import show_study
    from drake_screw.studies.study import new_study, numbers_of_regions, open_study

    console = Console()
    if resume is not None:
        if any(v is not None for v in (scenario, demonstrations, model, seed, output, set_)):
            raise DrakeScrewError(
                "--resume goes alone: a study is carried on as it was begun",
                remedy="Give just: drake-screw study --resume STUDY",
            )
        job = open_study(resume)
    else:
        loaded = _load(_given(scenario), _changes(set_, seed, demonstrations), model)
        job = new_study(loaded, numbers_of_regions(regions), runs, output)
    try:
        show_study(job, console, workers=workers)
    except KeyboardInterrupt:
        command = f"drake-screw study --resume {job.path}"
        console.print(f"interrupted; carry on with: {command}", soft_wrap=True)
        raise typer.Exit(130) from None


@app.command(epilog="Example:  drake-screw inspect runs/pouring/TIME --html failing.html")
def inspect(
    run: RunArgument,
    round: Annotated[
        int | None, typer.Option(help="Round, from 1. Default: the last that asked.")
    ] = None,
    instance: Annotated[
        int | None, typer.Option(help="Row of the round's instances, from 0. Default: suggested.")
    ] = None,
    html: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a page instead of serving one.")
    ] = None,
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "localhost",
    port: Annotated[int | None, typer.Option(help="Port of the page. Default: a free one.")] = None,
) -> None:
    """See why an instance fails.

    In the terminal, and in Meshcat or on a page that can be kept. It begins with the last round
    that asked for a demonstration, at the instance where it did.
    """
    from drake_screw.commands.inspect import inspect_run as carry_out

    carry_out(run, Console(), round=round, instance=instance, html=html, host=host, port=port)


@app.command(epilog="Example:  drake-screw execute runs/pouring/TIME --per-region 1")
def execute(
    run: RunArgument,
    per_region: Annotated[int, typer.Option(help="Instances to draw in every region.", min=1)] = 2,
    instance: InstanceOption = None,
    graphviz: Annotated[
        bool, typer.Option("--graphviz", help="Print the simulated diagram for dot, and stop.")
    ] = False,
    workers: Annotated[
        int | None, typer.Option(help="Processes. Default: all processors.", min=1)
    ] = None,
) -> None:
    """Simulate plans of a run, and check what the robot does.

    With the arm's dynamics and controllers. Reports joint limits, velocities, tracking, deviation
    from the screws and contacts; writes a table and a recording that plays in the browser.
    """
    from drake_screw.runs.executions import execute as carry_out
    from drake_screw.runs.executions import station_graphviz

    if graphviz:
        print(station_graphviz(run))
        return

    text = carry_out(run, per_region=per_region, instance=instance, workers=workers)
    Console().print(text, highlight=False)


@app.command(
    epilog="Example:  drake-screw export runs/pouring/TIME --instance 0.9 0.3 --output plan.csv"
)
def export(
    run: RunArgument,
    instance: Annotated[
        tuple[float, float], typer.Option(metavar="X Y", help="Where the object stands, in m.")
    ],
    output: Annotated[Path, typer.Option(metavar="FILE", help="Where to write the trajectory.")],
    format: Annotated[str, typer.Option(help="baxter-csv, ros-trajectory or npz.")] = "baxter-csv",
) -> None:
    """Write a plan as a trajectory that the robot can play."""
    from drake_screw.commands.export import export as carry_out

    Console().print(carry_out(run, instance, format, output), highlight=False)


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
