"""One plan of a run as a trajectory file that the robot can play."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.assembly.placing import InstanceLike, placed
from drake_screw.assembly.ranked_plans import RankedPlan
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations.baxter_csv import COLUMNS as BAXTER_COLUMNS
from drake_screw.errors import RunDirectoryError, ScenarioError, counted
from drake_screw.execution.setting import Setting
from drake_screw.files import WRITABLE_OUTPUT, write_bytes, write_files, writing
from drake_screw.outputs import check_writable
from drake_screw.plugins import find, names
from drake_screw.robot import Arm
from drake_screw.runs.run import open_run
from drake_screw.typing import Array, PathLike


@dataclass(frozen=True)
class Trajectory:
    """A written trajectory; as text it is what ``drake-screw export`` prints.

    Attributes:
        output: the file, or the folder of a format of several files.
        format: of the file, a name that `plugins.find` knows as an exporter.
        demonstration: name of the one whose plan it is.
        arm: that moves, where the robot has several that are planned for.
        segments: of the plan.
        duration: s.
        turned: rad, by which symmetric objects are turned, by their names.
        margin: how near a joint comes to a limit, in parts of its range.
        tightest: that joint.
        outside: whether the instance lies outside the work area.
        assumed: what is taken for what the robot's model does not state, a line each.
    """

    output: Path
    format: str
    demonstration: str
    segments: int
    duration: float
    turned: dict[str, float]
    margin: float
    tightest: str
    outside: bool
    assumed: tuple[str, ...] = ()
    arm: str | None = None

    def __str__(self) -> str:
        lines = ["note: the instance lies outside the work area"] if self.outside else []
        lines += [f"note: {line}" for line in self.assumed]
        return "\n".join(
            [
                *lines,
                f"planned with {self.demonstration}{self._of_arm()}{_words(self.turned)}: "
                f"{counted(self.segments, 'segment')}, {self.duration:.1f} s; "
                f"{self.tightest} comes nearest to a limit, {self.margin:.1%} of its range away",
                f"written to {self.output}",
            ]
        )

    def _of_arm(self) -> str:
        return "" if self.arm is None else f" for arm {self.arm}"


def write_trajectory(
    run: PathLike, instance: InstanceLike, format: str, output: PathLike
) -> Trajectory:
    """Plan one instance with a run's demonstrations and write the timed plan.

    Args:
        run: its directory.
        instance: {object: (x, y[, yaw])}, or the numbers of all objects in their order, as `placed`
            takes them.
        format: of the file, a name that `plugins.find` knows as an exporter.
        output: file to write; it is replaced. So is a folder that an earlier export wrote.

    Raises:
        DrakeScrewError: there is no such format or it is of another robot, the instance is not
            one or has no plan, or the file or the run cannot be used; nothing is written then.
    """
    writer = find("exporters", format)
    opened = open_run(run)
    setup = opened.setup
    for one in setup.arms:
        _check_robot(format, one.arm)
    coordinates = placed(setup.area, instance)
    best = setup.plan(opened.demonstrations, coordinates, most=1)
    output = Path(output)
    with writing(output, WRITABLE_OUTPUT):
        content = _content(writer, best, setup, coordinates)
        if isinstance(content, bytes):
            check_writable(output, WRITABLE_OUTPUT, RunDirectoryError)
            write_bytes(output, content)
        else:
            write_files(output, content)
    return Trajectory(
        output=output,
        format=format,
        demonstration=best.demonstration.name,
        segments=len(best.timed.segments),
        duration=best.timed.duration,
        turned={turn.body: turn.angle for turn in best.turned},
        margin=best.margin,
        tightest=best.tightest,
        outside=not setup.area.contains(coordinates),
        assumed=best.arm.assumptions,
        arm=best.arm_name,
    )


def _content(
    writer: Callable[..., Any], best: RankedPlan, setup: Setup, coordinates: Array
) -> bytes | Mapping[str, bytes]:
    """What an exporter makes of a plan; one that asks for the setting is given it."""
    content: bytes | Mapping[str, bytes]
    plan, arm = best.timed, best.arm
    if "setting" not in signature(writer).parameters:
        content = writer(plan, arm)
        return content
    X_WO = setup.area.X_WO(coordinates[None])[0]
    scenario = setup.scenario
    content = writer(
        plan,
        arm,
        setting=Setting(
            base=str(scenario.robot.base),
            X_WO={item.name: X for item, X in zip(setup.area.objects, X_WO, strict=True)},
            robot=Path(str(scenario.robot.model)).stem,
            task=scenario.description or scenario.name,
        ),
    )
    return content


def _words(turned: dict[str, float]) -> str:
    each = (f", with the {body} turned by {np.degrees(a):+.0f}°" for body, a in turned.items())
    return "".join(each).replace("-", "−")


def _check_robot(format: str, arm: Arm) -> None:
    foreign = [name for name in arm.joint_names if name not in BAXTER_COLUMNS]
    if format == "baxter-csv" and foreign:
        others = " or ".join(f"--format {name}" for name in names("exporters") if name != format)
        raise ScenarioError(
            f"the format {format} is for Baxter, which has no joint '{foreign[0]}'",
            remedy=f"Give {others}.",
        )
