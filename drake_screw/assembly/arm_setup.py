"""Workcell and planners of one arm that a scenario plans for."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from drake_screw.assembly.sanity import check_shapes, check_start, check_start_is_free, kept_within
from drake_screw.assembly.symmetries import symmetries
from drake_screw.errors import ModelError
from drake_screw.planning import BatchPlanner, Symmetries
from drake_screw.planning.approach import seeds
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.robot import (
    Arm,
    ObjectConfig,
    ObstacleConfig,
    RobotConfig,
    TableConfig,
    Workcell,
    build_workcell,
)
from drake_screw.scenario.schema import Scenario
from drake_screw.typing import Array

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class ArmSetup:
    """One arm that is planned for, while the others of its robot rest where they start.

    Attributes:
        scenario: that describes it.
        number: of the arm, in the order in which arms are tried, from 0.
        robot: the arm, what it holds, and what else of the robot there is.
        table, objects, obstacles: of the workcell.
    """

    scenario: Scenario
    number: int
    robot: RobotConfig
    table: TableConfig | None
    objects: Sequence[ObjectConfig]
    obstacles: Sequence[ObstacleConfig]

    @property
    def name(self) -> str:
        """The arm's, as the scenario has it."""
        return self.scenario.robot.each_arm[self.number].name

    @property
    def among_several(self) -> bool:
        """Whether the scenario lists arms, so that it has to be said which one is meant."""
        return self.scenario.robot.arms is not None

    @property
    def arm(self) -> Arm:
        """Its kinematics and limits."""
        return self.workcell.arm

    @property
    def start(self) -> Array:
        """(n,) rad or m, where its plans start and where it rests."""
        return self.workcell.start

    @cached_property
    def workcell(self) -> Workcell:
        """The Drake diagram; that of another arm has the same bodies, in the same order.

        Raises:
            ModelError: the model lacks a name, or a mesh cannot be read.
            ScenarioError: the start is outside the limits, or not free of obstacles, or collision
                shapes are missing.
        """
        try:
            workcell = build_workcell(
                self.robot, table=self.table, objects=self.objects, obstacles=self.obstacles
            )
        except ModelError as error:
            file = error.file or self.scenario.source
            raise ModelError(error.message, remedy=error.remedy, file=file) from error
        place = self.scenario.robot.place(self.number)
        check_shapes(self.scenario, workcell)
        check_start(self.scenario, workcell, place)
        check_start_is_free(self.scenario, workcell, place)
        return workcell

    @cached_property
    def symmetries(self) -> Symmetries:
        """Turns of objects and of what the end effector holds, which leave the task as it is.

        Raises:
            ModelError: the tool's frame is not one that the end effector carries.
        """
        tool = self.scenario.robot.each_arm[self.number].tool
        return symmetries(self.scenario, self.arm, tool)

    @cached_property
    def batch_planner(self) -> BatchPlanner:
        """The planner that watches joint limits and reach."""
        block = self.scenario.planner
        chain = kept_within(self.scenario, self.arm)
        return BatchPlanner(
            chain,
            tolerance=block.tolerance,
            symmetries=self.symmetries,
            seeds=seeds(chain, block.ik_seeds) if block.approach == "free" else None,
            redundancy=block.redundancy,
            free_axis=block.roll_axis,
        )

    @cached_property
    def careful_planner(self) -> CollisionFreePlanner:
        """Plans what is to be executed, whether or not the scenario looks at collisions."""
        if self.workcell.model.incomplete and self.number == 0:
            _log.warning(
                "collision checks are incomplete: shapes are missing of %s",
                ", ".join(self.workcell.model.incomplete),
            )
        return CollisionFreePlanner(
            self.batch_planner, self.workcell, self.scenario.planner.clearance
        )
