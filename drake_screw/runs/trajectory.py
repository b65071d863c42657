"""One plan of a run as a trajectory file that the robot can play."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drake_screw.demonstrations.baxter_csv import COLUMNS as BAXTER_COLUMNS
from drake_screw.errors import ScenarioError
from drake_screw.execution import time_plan
from drake_screw.files import WRITABLE_OUTPUT, write_bytes, writing
from drake_screw.plugins import find, names
from drake_screw.robot import Arm
from drake_screw.runs.executions import (
    collision_free_planner,
    known_demonstrations,
    why_not,
)
from drake_screw.runs.placing import InstanceLike, placed
from drake_screw.runs.run import open_run
from drake_screw.typing import PathLike


@dataclass(frozen=True)
class Trajectory:
    """A written trajectory; as text it is what ``drake-screw export`` prints.

    Attributes:
        output: the file.
        format: of the file, a name that `plugins.find` knows as an exporter.
        demonstration: name of the one whose plan it is.
        segments: screw segments of the plan.
        duration: s.
        turned: how symmetric objects are turned, in words; empty where there is none.
        outside: whether the instance lies outside the work area.
    """

    output: Path
    format: str
    demonstration: str
    segments: int
    duration: float
    turned: str
    outside: bool

    def __str__(self) -> str:
        lines = ["note: the instance lies outside the work area"] if self.outside else []
        return "\n".join(
            [
                *lines,
                f"planned with {self.demonstration}: {self.segments} screw segments, "
                f"{self.duration:.1f} s{self.turned and f', with {self.turned}'}",
                f"written to {self.output}",
            ]
        )


def write_trajectory(
    run: PathLike, instance: InstanceLike, format: str, output: PathLike
) -> Trajectory:
    """Plan one instance with a run's demonstrations and write the timed plan.

    Args:
        run: its directory.
        instance: {object: (x, y[, yaw])}, or the numbers of all objects in their order, as `placed`
            takes them.
        format: of the file, a name that `plugins.find` knows as an exporter.
        output: file to write; it is replaced.

    Raises:
        DrakeScrewError: there is no such format or it is of another robot, the instance is not
            one or has no plan, or the file or the run cannot be used; nothing is written then.
    """
    writer = find("exporters", format)
    opened = open_run(run)
    setup = opened.setup
    _check_robot(format, setup.workcell.arm)
    demonstrations = known_demonstrations(opened)
    x_y_yaw = placed(setup.area, instance)
    X_WO = setup.area.X_WO(x_y_yaw)
    planner = collision_free_planner(setup)
    outcomes = planner.any_success(demonstrations, X_WO[None], setup.workcell.start)[0]
    arm = setup.workcell.arm
    if not outcomes.any_success:
        why = why_not(outcomes, demonstrations, X_WO, planner, setup)
        raise ScenarioError(
            f"no demonstration of this run gives a plan there: {why}",
            remedy="Choose another instance, or carry the run on with more demonstrations.",
        )
    chosen = demonstrations[int(outcomes.best_attempt)]
    variant = int(outcomes.best.variant)
    plan = planner.plan(chosen, X_WO, setup.workcell.start, variant)
    timed = time_plan(plan, np.concatenate([arm.pose(plan.q[:1]), plan.guides]), arm)
    named = [o.name for o in setup.area.objects]
    turned = setup.symmetries.named(chosen, X_WO, plan.angles, named)
    output = Path(output)
    with writing(output, WRITABLE_OUTPUT):
        write_bytes(output, writer(timed, arm))
    return Trajectory(
        output=output,
        format=format,
        demonstration=chosen.name,
        segments=len(timed.segments),
        duration=timed.duration,
        turned=" and ".join(map(str, turned)),
        outside=not setup.area.contains(x_y_yaw),
    )


def _check_robot(format: str, arm: Arm) -> None:
    foreign = [name for name in arm.joint_names if name not in BAXTER_COLUMNS]
    if format == "baxter-csv" and foreign:
        others = " or ".join(f"--format {name}" for name in names("exporters") if name != format)
        raise ScenarioError(
            f"the format {format} is for Baxter, which has no joint '{foreign[0]}'",
            remedy=f"Give {others}.",
        )
