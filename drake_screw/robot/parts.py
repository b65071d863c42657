"""What a workcell is made of, and how it comes into a Drake plant: robot, table and objects."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pydrake.geometry import Box, Cylinder, SceneGraph, Shape
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FixedOffsetFrame, ModelInstanceIndex, RigidBody, SpatialInertia

from drake_screw.errors import ModelError
from drake_screw.robot.addresses import add_packages
from drake_screw.robot.arm import Arm
from drake_screw.robot.base import fix_base, set_defaults, without_furniture
from drake_screw.robot.directives import model_files
from drake_screw.robot.mimic import Mimic, follow, mimics_in
from drake_screw.robot.model_file import ModelFile, model_file
from drake_screw.robot.names import check_apart, find_frame
from drake_screw.robot.obstacles import ObstacleConfig, add_obstacle
from drake_screw.robot.packages import ModelPlace
from drake_screw.robot.shapes import register
from drake_screw.robot.tool import ToolConfig, add_tool, let_touch

WOOD = np.array([0.76, 0.68, 0.56, 1.0])
CLAY = np.array([0.93, 0.93, 0.90, 1.0])


_LOG = logging.getLogger(__name__)


@dataclass(frozen=True)
class RobotConfig:
    """Which arm of which model, how it starts, and what it holds.

    Of a robot with several arms that are planned for, the others are parked where they rest, with
    what they hold.
    """

    model: str
    joints: tuple[str, ...]
    end_effector: str
    start: tuple[float, ...]
    base: str = "base"
    parked: Mapping[str, float] = field(default_factory=dict)
    tool: ToolConfig | None = None
    velocity_limits: Mapping[str, float] = field(default_factory=dict)
    ignore_collisions: tuple[tuple[str, str], ...] = ()
    end_effector_rotation: tuple[float, float, float] | None = None
    packages: Mapping[str, Path] = field(default_factory=dict)
    xacro: Mapping[str, object] = field(default_factory=dict)
    srdf: str | None = None
    others_hold: tuple[ToolConfig, ...] = ()

    @property
    def tools(self) -> tuple[ToolConfig, ...]:
        """What all arms hold, by name: in the same order whichever of them is planned for."""
        held = () if self.tool is None else (self.tool,)
        return tuple(sorted((*held, *self.others_hold), key=lambda tool: tool.name))

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
    """An upright round object, a bowl; its frame is at the centre of its bottom. In m and kg.

    As a free body it is a solid cylinder; `friction` is Coulomb's coefficient of what slides.
    """

    name: str
    radius: float
    height: float
    mass: float = 0.3
    friction: float = 0.6


class RobotInPlant(NamedTuple):
    """A robot that was added to a plant.

    Attributes:
        config: what it is.
        plant: that it was added to.
        model: its model, as the user has it and as Drake reads it.
        models: all models that the file adds; names are looked up in these.
        instances: those that are the robot. A model without joints that stands by itself, a table
            that directives add beside an arm, is none of it.
        tool: the body of what it holds, if that has a shape.
        tools: of what all its arms hold, as its configuration has them.
        held: names of its joints that were replaced by welds.
        mimics: which of its joints follow another one.
    """

    config: RobotConfig
    plant: MultibodyPlant
    model: ModelFile
    models: tuple[ModelInstanceIndex, ...]
    instances: tuple[ModelInstanceIndex, ...]
    tool: RigidBody | None
    tools: tuple[RigidBody, ...]
    held: tuple[str, ...]
    mimics: tuple[Mimic, ...]

    def let_tools_touch(self, scene_graph: SceneGraph) -> None:
        """Let what is held touch what it may, once the plant is finalized.

        Raises:
            ModelError: there is no such body, or more than one.
        """
        for body, tool in zip(self.tools, self.config.tools, strict=True):
            let_touch(self.plant, scene_graph, body, tool)

    def arm(self) -> Arm:
        """The arm, once the plant is finalized.

        Raises:
            ModelError: as `Arm` does.
        """
        parked = {k: v for k, v in self.config.parked.items() if k not in self.held}
        config = self.config
        return Arm(
            self.plant,
            config.joints,
            config.frame,
            parked=parked,
            robot=self.models,
            velocity_limits=config.velocity_limits,
        )


def add_robot(parser: Parser, robot: RobotConfig) -> RobotInPlant:
    """Read the robot's model into a plant and fix it so that its base is at the world's origin.

    This is the one way in for a robot, whoever wants it. What it holds becomes a body of its first
    model. Parked joints are at rest by default, with those that mimic them.

    Raises:
        ModelError: the model or the tool's mesh cannot be read, the model lacks a name, has a
            collision shape that Drake would not take as it is, or cannot be fixed as wanted.
    """
    plant = parser.plant()
    place = ModelPlace(robot.model, robot.packages)
    shapes = plant.geometry_source_is_registered()
    model = model_file(place, robot.xacro, shapes=shapes)
    file = model.file
    add_packages(parser.package_map(), model.read, place.packages, meshes=shapes)
    files = model_files(model.read, parser.package_map())
    models = _read(parser, model)
    _LOG.debug("read %s", file)
    mimics = tuple(mimic for name, one in files for mimic in mimics_in(one, name))
    try:
        set_defaults(plant, models, robot.parked)
        follow(plant, models, mimics, joints=robot.joints, parked=robot.parked)
        held = fix_base(plant, models, robot.base, robot.joints, model=file.name.split(".")[0])
        instances = without_furniture(plant, models)
        if robot.end_effector_rotation is not None:
            _turn_end_effector(plant, models, robot)
    except ModelError as error:
        raise ModelError(error.message, remedy=error.remedy, file=error.file or file) from error
    tools = tuple(add_tool(plant, models, tool) for tool in robot.tools)
    tool = None if robot.tool is None else tools[robot.tools.index(robot.tool)]
    return RobotInPlant(robot, plant, model, models, instances, tool, tools, held, mimics)


def _read(parser: Parser, model: ModelFile) -> tuple[ModelInstanceIndex, ...]:
    try:
        models = tuple(parser.AddModels(str(model.read)))
    except (RuntimeError, ValueError, SystemExit) as error:
        raise ModelError(f"Drake cannot read this model: {error}", file=model.file) from error
    if not models:
        raise ModelError(
            "there is no model in this file",
            remedy="Directives name the robot's models, each in an add_model.",
            file=model.file,
        )
    return models


def _turn_end_effector(
    plant: MultibodyPlant, models: Sequence[ModelInstanceIndex], robot: RobotConfig
) -> None:
    """Add the frame `robot.frame`, turned against the end effector's by roll, pitch and yaw."""
    named = find_frame(plant, robot.end_effector, models)
    X_NE = RigidTransform(RollPitchYaw(robot.end_effector_rotation), [0.0, 0.0, 0.0])
    name = turned_frame(named.name())
    if plant.HasFrameNamed(name, named.model_instance()):
        raise ModelError(
            f"the model has a frame '{name}', as the turned end effector would be called",
            remedy="Take that frame as the end effector, without a rotation.",
        )
    plant.AddFrame(FixedOffsetFrame(name, named, X_NE))


def add_surroundings(
    plant: MultibodyPlant,
    table: TableConfig | None,
    objects: Sequence[ObjectConfig] = (),
    obstacles: Sequence[ObstacleConfig] = (),
    looks: Sequence[Shape] | None = None,
) -> tuple[tuple[RigidBody, ...], tuple[RigidBody, ...]]:
    """Add what stands around a robot; returns the bodies of the obstacles and of the objects.

    Objects look as `looks` say, each in its own frame, or like their collision shapes.

    Raises:
        ModelError: two things have one name, or a mesh cannot be read.
    """
    if table is not None:
        add_table(plant, table)
    check_apart(plant, "an obstacle", [item.name for item in obstacles])
    fixed = tuple(add_obstacle(plant, item) for item in obstacles)
    check_apart(plant, "an object", [item.name for item in objects])
    seen = [None] * len(objects) if looks is None else looks
    pairs = zip(objects, seen, strict=True)
    return fixed, tuple(add_object(plant, item, look) for item, look in pairs)


def add_table(plant: MultibodyPlant, table: TableConfig) -> None:
    """Add the table as a box fixed to the world."""
    box = Box(*table.size, table.thickness)
    X_WT = RigidTransform([*table.center, table.top - table.thickness / 2.0])
    body = plant.AddRigidBody("table", plant.AddModelInstance("table"), SpatialInertia.Zero())
    plant.WeldFrames(plant.world_frame(), body.body_frame(), X_WT)
    register(plant, body, box, RigidTransform(), WOOD)


def add_object(plant: MultibodyPlant, item: ObjectConfig, look: Shape | None = None) -> RigidBody:
    """Add an object as a free body with a visual and a collision shape."""
    up = [0.0, 0.0, 1.0]
    about_middle = SpatialInertia.SolidCylinderWithMass(item.mass, item.radius, item.height, up)
    inertia = about_middle.Shift([0.0, 0.0, -item.height / 2.0])
    body = plant.AddRigidBody(item.name, plant.AddModelInstance(item.name), inertia)
    X_OC = RigidTransform([0.0, 0.0, item.height / 2.0])
    register(plant, body, Cylinder(item.radius, item.height), X_OC, CLAY, item.friction, look)
    return body
