"""Arguments and options that several verbs have, and the scenario they choose."""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drake_screw.commands.log import set_up_logging
from drake_screw.errors import DrakeScrewError, counted

if TYPE_CHECKING:
    from drake_screw.commands.output import Output
    from drake_screw.scenario.schema import Scenario
    from drake_screw.sharing import Executor, Workers

_log = logging.getLogger(__name__)


def _listen(verbose: bool) -> bool:
    if verbose:
        set_up_logging(verbose=True)
        _log.debug("%s", " ".join(sys.argv))
    return verbose


_SCENARIO = typer.Argument(
    metavar="SCENARIO", help="A shipped scenario's name, or a YAML file.", show_default=False
)

ScenarioArgument = Annotated[str, _SCENARIO]
ScenarioUnlessResumed = Annotated[str | None, _SCENARIO]
RunArgument = Annotated[Path, typer.Argument(metavar="RUN", help="A run's directory.")]

SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key, as in coverage.beta=0.9."),
]
ModelOption = Annotated[
    str | None,
    typer.Option(metavar="FILE", help="Another robot model with the same joint names."),
]
DemonstrationsOption = Annotated[
    Path | None,
    typer.Option(metavar="DIR", help="Ask this folder of recordings, not a simulated teacher."),
]
SeedOption = Annotated[int | None, typer.Option(help="Seed of all random draws.")]
WorkersOption = Annotated[
    int | None, typer.Option(help="Processes. Default: all processors.", min=1)
]
SchedulerOption = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS", help="Share the work out on a Dask cluster, as in tcp://HOST:8786."
    ),
]
JsonOption = Annotated[
    str | None,
    typer.Option(
        "--json",
        metavar="FILE",
        help="Write the result as JSON, too; - writes just that to standard output.",
    ),
]
VerboseOption = Annotated[
    bool,
    typer.Option(
        "--verbose",
        "-v",
        help="Log what is done, with times, to standard error.",
        callback=_listen,
    ),
]


def chosen_scenario(
    scenario: str | None,
    changes: Sequence[str] | None = None,
    model: str | None = None,
    *,
    seed: int | None = None,
    demonstrations: Path | None = None,
) -> Scenario:
    """The scenario that a command line describes.

    Args:
        scenario: a shipped one's name, or a file.
        changes: values of ``--set``.
        model: takes the place of the scenario's robot model.
        seed: takes the place of the scenario's.
        demonstrations: a folder that is asked in place of the scenario's teacher.

    Raises:
        DrakeScrewError: something in it cannot be used.
    """
    from drake_screw.assembly.swap_model import swap_model
    from drake_screw.scenario.loader import load_scenario

    if scenario is None:
        raise DrakeScrewError(
            "no scenario", remedy="Give a YAML file, or a name that drake-screw list shows."
        )
    overrides = [*(changes or ()), *([] if seed is None else [f"seed={seed}"])]
    if demonstrations is not None:
        folder = str(demonstrations.resolve()).replace("'", "''")
        overrides = ["teacher={kind: recorded}", f"teacher.folder='{folder}'", *overrides]
    loaded = load_scenario(scenario, overrides)
    _log.debug("scenario %s", loaded.source)
    return loaded if model is None else swap_model(loaded, model)


@contextmanager
def chosen_workers(workers: int | None, scheduler: str | None, out: Output) -> Iterator[Workers]:
    """A context with those that a command line shares work out on.

    Args:
        workers: how many processes of this machine; all processors if None.
        scheduler: the address of a Dask scheduler, whose workers are taken then.
        out: is told how many they are.

    Raises:
        DrakeScrewError: both are given, or the cluster cannot be used.
    """
    if scheduler is not None and workers is not None:
        raise DrakeScrewError(
            "--workers are processes of this machine, and --scheduler brings its own",
            remedy="Give one of them.",
        )
    with chosen_cluster(scheduler, out) as cluster:
        yield workers if cluster is None else cluster


@contextmanager
def chosen_cluster(scheduler: str | None, out: Output) -> Iterator[Executor | None]:
    """A context with the workers of a Dask scheduler; None where none is given.

    Args:
        scheduler: its address.
        out: is told how many they are.

    Raises:
        DrakeScrewError: the cluster cannot be used.
    """
    if scheduler is None:
        yield None
        return
    from drake_screw.sharing.cluster import cluster

    with cluster(scheduler) as joined:
        out.say(f"shared out on {counted(joined.width, 'worker thread')} at {scheduler}")
        yield joined


def check_resumed_alone(kind: str, *others: object) -> None:
    """Refuse whatever is given beside ``--resume``.

    Args:
        kind: "run" or "study".
        others: values of the options that it excludes; None where they were not given.

    Raises:
        DrakeScrewError: one was given.
    """
    if any(value is not None for value in others):
        raise DrakeScrewError(
            f"--resume goes alone: a {kind} is carried on as it was begun",
            remedy=f"Give just: drake-screw {kind} --resume {kind.upper()}",
        )
