"""From a scenario's text to the objects that carry it out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drake_screw.acquisition import RecordedTeacher, Teacher
from drake_screw.acquisition.interactive_teacher import InteractiveTeacher
from drake_screw.acquisition.simulated import SimulatedTeacher
from drake_screw.bandits import CertifyOrSplit, Goal, Strategy, make_strategy
from drake_screw.demonstrations import Demonstration, Recording, SegmentationConfig
from drake_screw.errors import ScenarioError
from drake_screw.planning import BatchPlanner, Planner
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.robot import (
    ObjectConfig,
    RobotConfig,
    ScrewChain,
    TableConfig,
    Workcell,
    build_workcell,
)
from drake_screw.scenario.recorder import ForeignRecordings, Recorder
from drake_screw.scenario.schema import Scenario
from drake_screw.tasks import GridRegions, ObjectArea, WorkArea, free_axes

KEEP_OFF = 0.5
"""m. A hand is never farther than this from the object that it works on."""


@dataclass(frozen=True)
class Setup:
    """All that a scenario describes, each part built when it is first asked for.

    Attributes:
        scenario: the description.
    """

    scenario: Scenario

    @cached_property
    def robot(self) -> RobotConfig:
        """Which arm of which model."""
        block = self.scenario.robot
        return RobotConfig(
            str(block.model),
            block.joints,
            block.end_effector,
            block.start,
            block.base,
            block.parked,
        )

    @cached_property
    def table(self) -> TableConfig | None:
        """The table, if there is one."""
        block = self.scenario.table
        if block is None:
            return None
        return TableConfig(block.center, block.size, block.top, block.thickness)

    @cached_property
    def objects(self) -> tuple[ObjectConfig, ...]:
        """Shapes of the objects."""
        return tuple(ObjectConfig(o.name, o.radius, o.height) for o in self.scenario.objects)

    @cached_property
    def workcell(self) -> Workcell:
        """The Drake diagram.

        Raises:
            ModelError: the model lacks a name.
            ScenarioError: the start is outside the limits, or the work area out of reach.
        """
        workcell = build_workcell(self.robot, table=self.table, objects=self.objects)
        margin = workcell.arm.margin(workcell.start)
        if (margin <= 0.0).any():
            i = int(np.argmin(margin))
            arm = workcell.arm
            raise ScenarioError(
                f"robot.start: {arm.joint_names[i]} starts at {workcell.start[i]:.4f} rad, outside "
                f"its limits {arm.lower[i]:.4f} .. {arm.upper[i]:.4f}",
                remedy="Start from a configuration that is strictly inside all joint limits.",
                file=self.scenario.source,
            )
        self._check_reach(workcell.arm.screw_chain())
        return workcell

    @cached_property
    def area(self) -> WorkArea:
        """Where the objects may stand."""
        return WorkArea(
            tuple(
                ObjectArea(
                    o.name,
                    (o.x.lower, o.y.lower, o.yaw.lower),
                    (o.x.upper, o.y.upper, o.yaw.upper),
                    o.z,
                )
                for o in self.scenario.objects
            )
        )

    @cached_property
    def regions(self) -> GridRegions:
        """The bandit's arms; a single one, from which they start, where they are adaptive."""
        return GridRegions(self.area, np.array(self.scenario.cells))

    @cached_property
    def batch_planner(self) -> BatchPlanner:
        """The planner that watches joint limits and reach."""
        chain = self.workcell.arm.screw_chain()
        return BatchPlanner(chain, tolerance=self.scenario.planner.tolerance)

    @cached_property
    def planner(self) -> Planner:
        """The planner that decides; it watches collisions, too, where the scenario wants it."""
        if self.scenario.planner.collision:
            return CollisionFreePlanner(self.batch_planner, self.workcell)
        return self.batch_planner

    @cached_property
    def goal(self) -> Goal:
        """What is to be certified."""
        block = self.scenario.coverage
        return Goal(block.beta, block.epsilon, block.delta)

    @cached_property
    def strategy(self) -> Strategy:
        """The bandit of a grid."""
        block = self.scenario.coverage
        return make_strategy(block.strategy, self.goal, **block.options)

    @cached_property
    def tree(self) -> CertifyOrSplit | None:
        """The bandit of adaptive regions; None for a grid."""
        block = self.scenario.regions.adaptive
        if block is None:
            return None
        axes = int(free_axes(self.area).sum())
        return CertifyOrSplit(self.goal, axes, block.smallest, block.level)

    @property
    def bandit(self) -> Strategy | CertifyOrSplit:
        """The bandit of these regions."""
        return self.tree or self.strategy

    @cached_property
    def segmentation(self) -> SegmentationConfig:
        """How recordings are cut into screws."""
        block = self.scenario.segmentation
        return SegmentationConfig(
            block.spacing,
            block.position_tolerance,
            block.rotation_tolerance,
            block.min_progress,
            block.region_of_interest,
        )

    @cached_property
    def teacher(self) -> Teacher:
        """Who gives demonstrations."""
        block = self.scenario.teacher
        if block.kind == "interactive":
            from drake_screw.scenario.teaching import TeachingDesk  # it shows a Setup

            return InteractiveTeacher(TeachingDesk(self, inbox=block.folder))
        if block.folder is not None:
            recordings = self.recorder.library(block.folder)
            foreign = None
            if self.recorder.robot is not None:
                foreign = ForeignRecordings(
                    self.recorder, self.segmentation, self.planner, self.workcell.start
                )
            return RecordedTeacher(recordings, self.regions, foreign)
        return SimulatedTeacher(self.workcell, self.area, str(block.motion))

    @cached_property
    def initial(self) -> int | tuple[Recording, ...]:
        """Recordings to start from, or how many to ask for."""
        block = self.scenario.demonstrations.initial
        if isinstance(block, int):
            return block
        return tuple(self.recorder.read(folder) for folder in block)

    @cached_property
    def own_recorder(self) -> Recorder:
        """Recordings of the arm that is planned for."""
        return Recorder(self.workcell.arm, self.workcell.arm, self.area)

    @cached_property
    def recorder(self) -> Recorder:
        """Recordings that the scenario names: of another robot, if it says so.

        Raises:
            ModelError: that robot's model cannot be read, or lacks a name.
        """
        block = self.scenario.recorded_on
        if block is None:
            return self.own_recorder
        return Recorder.of_another(block, self.workcell.arm, self.area)

    def recorder_of(self, robot: str | None) -> Recorder:
        """That of a recording's `robot`."""
        return self.own_recorder if robot is None else self.recorder

    def learn(self, recording: Recording) -> Demonstration:
        """Turn a recording into a demonstration, by the kinematics of the arm it was made on."""
        return self.recorder_of(recording.robot).learn(recording, self.segmentation)

    def _check_reach(self, chain: ScrewChain) -> None:
        for i, item in enumerate(self.area.objects):
            nearest = np.clip(chain.shoulder[:2], item.lower[:2], item.upper[:2])
            away = float(np.linalg.norm(np.append(nearest, item.z) - chain.shoulder))
            if away > chain.reach + KEEP_OFF:
                raise ScenarioError(
                    f"objects.{i}: the work area of '{item.name}' is out of reach: its nearest "
                    f"point is {away:.2f} m from the shoulder, the hand gets {chain.reach:.2f} m",
                    remedy="Move the work area towards the robot; x, y and z are in metres, "
                    f"seen from '{self.scenario.robot.base}'.",
                    file=self.scenario.source,
                )
