"""What a workcell is made of, and how it comes into a Drake plant: robot, table and objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pydrake.geometry import Box, Cylinder
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FixedOffsetFrame, ModelInstanceIndex, RigidBody, SpatialInertia

from drake_screw.errors import ModelError, unknown
from drake_screw.resources import MODEL_SUFFIXES, find_resource
from drake_screw.robot.arm import find_frame
from drake_screw.robot.model_text import check_collision_shapes
from drake_screw.robot.names import check_apart
from drake_screw.robot.obstacles import ObstacleConfig, add_obstacle
from drake_screw.robot.shapes import register
from drake_screw.robot.tool import ToolConfig, add_tool

WOOD = np.array([0.76, 0.68, 0.56, 1.0])
CLAY = np.array([0.93, 0.93, 0.90, 1.0])


@dataclass(frozen=True)
class RobotConfig:
    """Which arm of which model, how it starts, and what it holds."""

    model: str
    joints: tuple[str, ...]
    end_effector: str
    start: tuple[float, ...]
    base: str = "base"
    parked: Mapping[str, float] = field(default_factory=dict)
    tool: ToolConfig | None = None
    end_effector_rotation: tuple[float, float, float] | None = None

    @property
    def frame(self) -> str:
        """The frame E in the plant: the end effector's, or that turned by its rotation."""
        turned = self.end_effector_rotation is not None
        return turned_frame(self.end_effector) if turned else self.end_effector


def turned_frame(end_effector: str) -> str:
    """The name of an end effector's frame once it is turned by `end_effector_rotation`."""
    return f"{end_effector}_turned"


@dataclass(frozen=True)
class TableConfig:
    """A box: centre (x, y) and size (x, y) in m, height of its top in W and thickness in m."""

    center: tuple[float, float]
    size: tuple[float, float]
    top: float
    thickness: float = 0.04


@dataclass(frozen=True)
class ObjectConfig:
    """An upright round object, a bowl; its frame is at the centre of its bottom. In m."""

    name: str
    radius: float
    height: float


class RobotInPlant(NamedTuple):
    """A robot that was added to a plant: its model's file, its instance, and the body it holds."""

    file: Path
    instance: ModelInstanceIndex
    tool: RigidBody | None


def add_robot(parser: Parser, robot: RobotConfig) -> RobotInPlant:
    """Read the robot's model into a plant and fix its base to the world where it is free.

    What it holds becomes a body of the same model instance.

    Raises:
        ModelError: the model or the tool's mesh cannot be read, the model lacks a name, or has a
            collision shape that Drake would not take as it is.
    """
    plant = parser.plant()
    file = find_resource("models", robot.model, MODEL_SUFFIXES)
    check_collision_shapes(file)
    try:
        instance = parser.AddModels(str(file))[0]
    except (RuntimeError, ValueError, SystemExit) as error:
        raise ModelError(f"Drake cannot read this model: {error}", file=file) from error
    names = [plant.get_body(i).name() for i in plant.GetBodyIndices(instance)]
    if robot.base not in names:
        message, remedy = unknown("link", robot.base, f"model '{file.stem}'", names)
        raise ModelError(message, remedy=remedy, file=file)
    welded = {
        plant.get_joint(i).child_body().name()
        for i in plant.GetJointIndices(instance)
        if plant.get_joint(i).parent_body().name() == "world"
    }
    if robot.base not in welded:
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(robot.base, instance))
    if robot.end_effector_rotation is not None:
        _turn_end_effector(plant, robot, file)
    tool = None if robot.tool is None else add_tool(plant, instance, robot.tool)
    return RobotInPlant(file, instance, tool)


def _turn_end_effector(plant: MultibodyPlant, robot: RobotConfig, file: Path) -> None:
    """Add the frame `robot.frame`, turned against the end effector's by roll, pitch and yaw."""
    check_apart(plant, "the turned end effector", [robot.frame])
    try:
        named = find_frame(plant, robot.end_effector)
    except ModelError as error:
        raise ModelError(error.message, remedy=error.remedy, file=file) from error
    X_NE = RigidTransform(RollPitchYaw(robot.end_effector_rotation), [0.0, 0.0, 0.0])
    plant.AddFrame(FixedOffsetFrame(robot.frame, named, X_NE))


def add_surroundings(
    plant: MultibodyPlant,
    table: TableConfig | None,
    objects: Sequence[ObjectConfig] = (),
    obstacles: Sequence[ObstacleConfig] = (),
) -> tuple[tuple[RigidBody, ...], tuple[RigidBody, ...]]:
    """Add what stands around a robot; returns the bodies of the obstacles and of the objects.

    Raises:
        ModelError: two things have one name, or a mesh cannot be read.
    """
    if table is not None:
        add_table(plant, table)
    check_apart(plant, "an obstacle", [item.name for item in obstacles])
    fixed = tuple(add_obstacle(plant, item) for item in obstacles)
    check_apart(plant, "an object", [item.name for item in objects])
    return fixed, tuple(add_object(plant, item) for item in objects)


def add_table(plant: MultibodyPlant, table: TableConfig) -> None:
    """Add the table as a box fixed to the world."""
    box = Box(*table.size, table.thickness)
    X_WT = RigidTransform([*table.center, table.top - table.thickness / 2.0])
    body = plant.AddRigidBody("table", plant.AddModelInstance("table"), SpatialInertia.Zero())
    plant.WeldFrames(plant.world_frame(), body.body_frame(), X_WT)
    register(plant, body, box, RigidTransform(), WOOD)


def add_object(plant: MultibodyPlant, item: ObjectConfig) -> RigidBody:
    """Add an object as a free body with a visual and a collision shape."""
    inertia = SpatialInertia.SolidCylinderWithMass(0.3, item.radius, item.height, [0, 0, 1])
    body = plant.AddRigidBody(item.name, plant.AddModelInstance(item.name), inertia)
    X_OC = RigidTransform([0.0, 0.0, item.height / 2.0])
    register(plant, body, Cylinder(item.radius, item.height), X_OC, CLAY)
    return body
