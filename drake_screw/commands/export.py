"""``drake-screw export``: a plan as a file for the robot."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drake_screw.commands.options import RunArgument, VerboseOption
from drake_screw.commands.output import Output

EXAMPLE = "drake-screw export runs/pouring/TIME --instance 0.9 0.3 --output plan.csv"


def export(
    run: RunArgument,
    instance: Annotated[
        tuple[float, float], typer.Option(metavar="X Y", help="Where the object stands, in m.")
    ],
    output: Annotated[Path, typer.Option(metavar="FILE", help="Where to write the trajectory.")],
    format: Annotated[str, typer.Option(help="baxter-csv, ros-trajectory or npz.")] = "baxter-csv",
    verbose: VerboseOption = False,
) -> None:
    """Write a plan as a trajectory that the robot can play."""
    from drake_screw.runs.trajectory import write_trajectory

    Output().present(write_trajectory(run, instance, format, output))
