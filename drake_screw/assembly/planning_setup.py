"""The part of a scenario that planning is about: workcell, work area and planner."""

from __future__ import annotations

import logging
from functools import cached_property
from pathlib import Path

import numpy as np

from drake_screw.assembly.executing import ExecutedTries
from drake_screw.assembly.sanity import (
    check_reach,
    check_shapes,
    check_start,
    check_start_is_free,
    kept_within,
)
from drake_screw.assembly.symmetries import symmetries
from drake_screw.assembly.workcell_parts import (
    object_configs,
    obstacle_configs,
    robot_config,
    table_config,
    work_area,
)
from drake_screw.errors import ModelError
from drake_screw.execution.noise import Noise
from drake_screw.planning import BatchPlanner, Symmetries
from drake_screw.planning.approach import seeds
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.robot import (
    MeshShape,
    ObjectConfig,
    ObstacleConfig,
    RobotConfig,
    TableConfig,
    Workcell,
    build_workcell,
)
from drake_screw.robot.srdf import srdf_of
from drake_screw.scenario.schema import Scenario
from drake_screw.tasks import GridRegions, WorkArea

_log = logging.getLogger(__name__)


class PlanningSetup:
    """Workcell, work area and planner of a scenario, each built when it is first asked for.

    Args:
        scenario: the description.
    """

    passed_in: tuple[str, ...] = ()

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario

    @cached_property
    def robot(self) -> RobotConfig:
        """Which arm of which model, and what it holds."""
        return robot_config(self.scenario)

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
            ScenarioError: the start is outside the limits, or not free of obstacles, the work area
                is out of reach, or collision shapes are missing.
        """
        try:
            workcell = build_workcell(
                self.robot, table=self.table, objects=self.objects, obstacles=self.obstacles
            )
        except ModelError as error:
            file = error.file or self.scenario.source
            raise ModelError(error.message, remedy=error.remedy, file=file) from error
        check_shapes(self.scenario, workcell)
        check_start(self.scenario, workcell)
        check_start_is_free(self.scenario, workcell)
        check_reach(self.scenario, workcell.arm, self.area)
        return workcell

    @property
    def srdf(self) -> dict[str, Path]:
        """The robot's SRDF file, by its place in the scenario, if it has one."""
        file = srdf_of(self.robot)
        return {} if file is None else {"robot.srdf": file}

    @property
    def meshes(self) -> dict[str, Path]:
        """Files of the meshes in the workcell, by their places in the scenario."""
        tool = self.robot.tool
        shapes = {f"obstacles.{item.name}": item.shape for item in self.obstacles}
        shapes |= {} if tool is None else {"robot.tool": tool.shape}
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
        return GridRegions(self.area, np.array(self.scenario.cells))

    @cached_property
    def batch_planner(self) -> BatchPlanner:
        """The planner that watches joint limits and reach."""
        block = self.scenario.planner
        chain = kept_within(self.scenario, self.workcell.arm)
        return BatchPlanner(
            chain,
            tolerance=block.tolerance,
            symmetries=self.symmetries,
            seeds=seeds(chain, block.ik_seeds) if block.approach == "free" else None,
            redundancy=block.redundancy,
            free_axis=block.roll_axis,
        )

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

    @cached_property
    def symmetries(self) -> Symmetries:
        """Turns of objects and of what the end effector holds, which leave the task as it is.

        Raises:
            ModelError: the tool's frame is not one that the end effector carries.
        """
        return symmetries(self.scenario, self.workcell.arm)

    @cached_property
    def careful_planner(self) -> CollisionFreePlanner:
        """Plans what is to be executed, whether or not the scenario looks at collisions."""
        if self.workcell.model.incomplete:
            _log.warning(
                "collision checks are incomplete: shapes are missing of %s",
                ", ".join(self.workcell.model.incomplete),
            )
        return CollisionFreePlanner(
            self.batch_planner, self.workcell, self.scenario.planner.clearance
        )
