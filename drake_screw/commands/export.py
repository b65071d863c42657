"""``drake-screw export``: a plan as a file for the robot."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drake_screw.commands.instance_option import instance_option, parse_instance
from drake_screw.commands.options import RunArgument, VerboseOption
from drake_screw.commands.output import Output

EXAMPLE = "drake-screw export runs/pouring/TIME --instance bowl=0.9,0.3 --output plan.csv"


def export(
    run: RunArgument,
    instance: Annotated[list[str], instance_option("Where the objects stand.")],
    output: Annotated[
        Path,
        typer.Option(
            metavar="FILE", help="Where to write the trajectory; ros2-bag and lerobot are folders."
        ),
    ],
    format: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="ros-trajectory, moveit-trajectory, npz, baxter-csv, ros2-bag or lerobot; the "
            "last two need the extras ros and lerobot.",
        ),
    ] = "baxter-csv",
    verbose: VerboseOption = False,
) -> None:
    """Write a plan as a trajectory that the robot can play."""
    place = parse_instance(instance)
    from drake_screw.commands.countdown import Countdown
    from drake_screw.steps import Step

    out = Output()
    with Countdown(out.console) as shown:
        from drake_screw.runs.trajectory import write_trajectory

        shown(Step("planning"))
        written = write_trajectory(run, place, format, output)
    out.present(written)
