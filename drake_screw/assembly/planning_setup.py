"""The part of a scenario that planning is about: workcell, work area and planner."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

import numpy as np

from drake_screw.acquisition.nearest_arm import nearest_first
from drake_screw.assembly.arm_setup import ArmSetup
from drake_screw.assembly.executing import ExecutedTries
from drake_screw.assembly.work_area_checks import check_reach, check_room
from drake_screw.assembly.workcell_parts import (
    object_configs,
    obstacle_configs,
    robot_configs,
    table_config,
    work_area,
)
from drake_screw.execution.noise import Noise
from drake_screw.planning import BatchPlanner, Outcomes, Planner, Symmetries
from drake_screw.planning.arms import ArmsPlanner
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.robot import (
    MeshShape,
    ObjectConfig,
    ObstacleConfig,
    RobotConfig,
    TableConfig,
    Workcell,
)
from drake_screw.robot.srdf import srdf_of
from drake_screw.scenario.schema import Scenario
from drake_screw.tasks import GridRegions, WorkArea
from drake_screw.typing import Array


class PlanningSetup:
    """Workcell, work area and planner of a scenario, each built when it is first asked for.

    What is of an arm is that of the first one, which is the only one as a rule; `arms` has the
    others.

    Args:
        scenario: the description.
    """

    passed_in: tuple[str, ...] = ()

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario

    @cached_property
    def arms(self) -> tuple[ArmSetup, ...]:
        """Each arm that is planned for, in the order in which they are tried."""
        around = self.table, self.objects, self.obstacles
        return tuple(
            ArmSetup(self.scenario, number, robot, *around)
            for number, robot in enumerate(robot_configs(self.scenario))
        )

    @property
    def robot(self) -> RobotConfig:
        """Which arm of which model, and what it holds."""
        return self.arms[0].robot

    @cached_property
    def table(self) -> TableConfig | None:
        """The table, if there is one."""
        return table_config(self.scenario)

    @cached_property
    def objects(self) -> tuple[ObjectConfig, ...]:
        """Shapes of the objects."""
        return object_configs(self.scenario)

    @cached_property
    def obstacles(self) -> tuple[ObstacleConfig, ...]:
        """Other things that stand around."""
        return obstacle_configs(self.scenario)

    @cached_property
    def workcell(self) -> Workcell:
        """The Drake diagram.

        Raises:
            ModelError: the model lacks a name, or a mesh cannot be read.
            ScenarioError: a start is outside the limits, or not free of obstacles, the work area
                is out of reach, a region has no room for objects that must not overlap, or
                collision shapes are missing.
        """
        check_reach(self.scenario, [one.arm for one in self.arms], self.area)
        workcell = self.arms[0].workcell
        check_room(self.scenario, self.regions)
        return workcell

    @property
    def workcells(self) -> tuple[Workcell, ...]:
        """That of each arm."""
        return self.workcell, *(one.workcell for one in self.arms[1:])

    @cached_property
    def start(self) -> Array:
        """Where all arms start, rad or m, those of one after those of another: for `Planner`."""
        return np.concatenate([one.start for one in self.arms])

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What is taken for what the model does not state of the arms, a line each."""
        lines = (line for one in self.arms for line in one.arm.assumptions)
        return tuple(dict.fromkeys(lines))

    @property
    def shoulders(self) -> Array:
        """p_WS (A, 3) m, of each arm."""
        return np.stack([one.arm.screw_chain().shoulder for one in self.arms])

    def nearest_arm(self, coordinates: Array) -> ArmSetup:
        """The arm whose shoulder is nearest to the first object of an instance (k, c)."""
        return self.arms[int(nearest_first(self.shoulders, self.area.X_WO(coordinates))[0])]

    @property
    def srdf(self) -> dict[str, Path]:
        """The robot's SRDF file, by its place in the scenario, if it has one."""
        file = srdf_of(self.robot)
        return {} if file is None else {"robot.srdf": file}

    @property
    def meshes(self) -> dict[str, Path]:
        """Files of the meshes in the workcell, by their places in the scenario."""
        shapes = {f"obstacles.{item.name}": item.shape for item in self.obstacles}
        shapes |= {tool.place: tool.shape for tool in self.robot.tools}
        return {
            place: shape.solid.file
            for place, shape in shapes.items()
            if isinstance(shape.solid, MeshShape)
        }

    @cached_property
    def area(self) -> WorkArea:
        """Where the objects may stand."""
        return work_area(self.scenario)

    @cached_property
    def regions(self) -> GridRegions:
        """The bandit's arms; a single one, from which they start, where they are adaptive."""
        counts = np.array(self.scenario.cells)[:, : len(self.area.axes)]
        return GridRegions(self.area, counts)

    @property
    def batch_planner(self) -> BatchPlanner:
        """The planner that watches joint limits and reach."""
        return self.arms[0].batch_planner

    @cached_property
    def executing(self) -> ExecutedTries | None:
        """What executes the plans of instances; None where a plan is a success.

        Raises:
            ModelError: the model lacks inertia.
            ScenarioError: an object has nothing to stand on, or a planner was passed in, whose
                plans are not those that would be executed.
        """
        if self.scenario.coverage.success == "plan":
            return None
        tries = ExecutedTries(self, Noise(**dict(self.scenario.execution.noise)))
        tries.check()
        return tries

    @property
    def symmetries(self) -> Symmetries:
        """Turns of objects and of what the end effector holds, which leave the task as it is.

        Raises:
            ModelError: the tool's frame is not one that the end effector carries.
        """
        return self.arms[0].symmetries

    @property
    def careful_planner(self) -> CollisionFreePlanner:
        """Plans what is to be executed, whether or not the scenario looks at collisions."""
        return self.arms[0].careful_planner

    def arm_of(self, outcome: Outcomes) -> ArmSetup:
        """The arm that an outcome of shape () is of."""
        return self.arms[int(outcome.arm)]

    def arm_name(self, outcome: Outcomes) -> str | None:
        """Its name, where there are several."""
        return self.arm_of(outcome).name if self.arms[0].among_several else None

    def planner_of_all(self, *, careful: bool) -> Planner:
        """The planner for whichever arm can; that of the only one where there is no other.

        Args:
            careful: watches collisions, too.
        """
        _ = self.workcell
        each = [one.careful_planner if careful else one.batch_planner for one in self.arms]
        return each[0] if len(each) == 1 else ArmsPlanner(each)
