"""The Drake side of a scenario: robot, table and objects in one plant, with collision queries."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydrake.geometry import Box, Cylinder, SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex, RigidBody, SpatialInertia
from pydrake.planning import (
    CollisionCheckerParams,
    RobotDiagram,
    RobotDiagramBuilder,
    SceneGraphCollisionChecker,
)

from drake_screw.errors import ModelError, unknown
from drake_screw.resources import MODEL_SUFFIXES, find_resource
from drake_screw.robot.arm import Arm
from drake_screw.robot.names import check_apart
from drake_screw.robot.obstacles import ObstacleConfig, add_obstacle
from drake_screw.robot.shapes import register
from drake_screw.robot.tool import ToolConfig, add_tool, let_touch
from drake_screw.screws import quaternion_from_rotation
from drake_screw.typing import Array

WOOD = np.array([0.76, 0.68, 0.56, 1.0])
CLAY = np.array([0.93, 0.93, 0.90, 1.0])

MANY = 100
"""Configurations from which on sharing them out among threads takes less time than it saves."""


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


@dataclass(frozen=True)
class Workcell:
    """Robot, table, obstacles and objects in one Drake diagram.

    Objects are free bodies of the plant, so that one workcell serves every task instance: give
    their poses X_WO with each query.

    Attributes:
        diagram, plant, scene_graph: finalized, without dynamics (continuous time).
        arm: the arm that is planned for.
        start: (n,) rad, its start configuration.
        objects: the objects' bodies.
        robot: the model instance of the robot, and of what it holds.
        model_file: where the robot was read from.
        checker: looks at collisions.
        obstacles: the obstacles' bodies.
        tool: the body of what the end effector holds, if that has a shape.
    """

    diagram: RobotDiagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    arm: Arm
    start: Array
    objects: tuple[RigidBody, ...]
    robot: ModelInstanceIndex
    model_file: Path
    checker: SceneGraphCollisionChecker
    obstacles: tuple[RigidBody, ...] = ()
    tool: RigidBody | None = None

    def positions(self, q: ArrayLike, X_WO: ArrayLike) -> Array:
        """Positions of the whole plant.

        Args:
            q: (..., n) rad or m, of the arm.
            X_WO: (..., k, 4, 4) poses of the k objects; leading axes broadcast.

        Returns:
            (..., plant.num_positions()).
        """
        full, X_WO = self.arm.full_positions(q), np.asarray(X_WO, dtype=float)
        shape = np.broadcast_shapes(full.shape[:-1], X_WO.shape[:-3])
        full = np.broadcast_to(full, (*shape, full.shape[-1])).copy()
        for i, body in enumerate(self.objects):
            first = body.floating_positions_start()
            full[..., first : first + 4] = quaternion_from_rotation(X_WO[..., i, :3, :3])
            full[..., first + 4 : first + 7] = X_WO[..., i, :3, 3]
        return full

    @cached_property
    def pairs(self) -> tuple[tuple[BodyIndex, BodyIndex], ...]:
        """Bodies that could touch, one of them the robot's, as far as Drake looks at them."""
        shaped = [
            i
            for i in map(BodyIndex, range(self.plant.num_bodies()))
            if len(self.plant.GetCollisionGeometriesForBody(self.plant.get_body(i))) > 0
        ]
        robot = {i for i in shaped if self.checker.IsPartOfRobot(i)}
        return tuple(
            (a, b)
            for a, b in itertools.combinations(shaped, 2)
            if (a in robot or b in robot) and not self.checker.IsCollisionFilteredBetween(a, b)
        )

    def touching(self, pair: int) -> tuple[str, str]:
        """Names of the two bodies of one of `pairs`, the robot's first."""
        a, b = self.pairs[pair]
        if not self.checker.IsPartOfRobot(a):
            a, b = b, a
        return self.plant.get_body(a).name(), self.plant.get_body(b).name()

    def keeping(self, clearance: float) -> SceneGraphCollisionChecker:
        """A checker for which nearer than a clearance in m is a collision."""
        checker = self.checker.Clone()
        checker.SetPaddingAllRobotEnvironmentPairs(clearance)
        checker.SetPaddingAllRobotRobotPairs(clearance)
        return checker

    def collides(
        self,
        q: ArrayLike,
        X_WO: ArrayLike,
        *,
        checker: SceneGraphCollisionChecker | None = None,
    ) -> Array:
        """Whether the robot touches itself, the table, an obstacle or an object.

        What the end effector holds counts as the robot where it has a shape.

        Args:
            q: (m, n).
            X_WO: (k, 4, 4) or (m, k, 4, 4).
            checker: by which; without clearance if None.

        Returns:
            (m,) bool.
        """
        full = self.positions(q, X_WO)
        parallel = len(full) >= MANY
        free = (checker or self.checker).CheckConfigsCollisionFree(list(full), parallelize=parallel)
        return ~np.array(free, dtype=bool)

    def colliding_bodies(
        self, q: ArrayLike, X_WO: ArrayLike, clearance: float = 0.0
    ) -> tuple[tuple[str, str], ...]:
        """Names of the pairs of bodies that touch, or are nearer than a clearance in m, at q (n,)."""
        found = self.checker.CalcRobotClearance(self.positions(q, X_WO), clearance)
        name = [
            (self.plant.get_body(a).name(), self.plant.get_body(b).name())
            for a, b, distance in zip(
                found.robot_indices(),
                found.other_indices(),
                found.distances(),
                strict=True,
            )
            if distance < clearance
        ]
        return tuple(dict.fromkeys(name))


def build_workcell(
    robot: RobotConfig,
    *,
    table: TableConfig | None = None,
    objects: Sequence[ObjectConfig] = (),
    obstacles: Sequence[ObstacleConfig] = (),
) -> Workcell:
    """Build the diagram of a robot, a table, some objects and some obstacles.

    Raises:
        ModelError: the model cannot be read, or lacks a name the configuration asks for; a mesh
            cannot be read; two things have one name.
    """
    builder = RobotDiagramBuilder(time_step=0.0)
    plant: MultibodyPlant = builder.plant()
    model_file, instance, tool = add_robot(builder.parser(), robot)
    fixed, bodies = add_surroundings(plant, table, objects, obstacles)
    plant.Finalize()
    arm = Arm(plant, robot.joints, robot.end_effector, parked=robot.parked)
    if len(robot.start) != arm.n:
        raise ModelError(
            f"the start configuration has {len(robot.start)} angles for {arm.n} joints"
        )
    scene_graph = builder.scene_graph()
    if robot.tool is not None and tool is not None:
        arm.held(robot.tool.frame)
        let_touch(plant, scene_graph, tool, robot.tool.touches)
    diagram = builder.Build()
    arm.owner = diagram
    checker = SceneGraphCollisionChecker(
        CollisionCheckerParams(model=diagram, robot_model_instances=[instance], edge_step_size=0.05)
    )
    start = np.array(robot.start, dtype=float)
    return Workcell(
        diagram, plant, scene_graph, arm, start, bodies, instance, model_file, checker, fixed, tool
    )


class RobotInPlant(NamedTuple):
    """A robot that was added to a plant: its model's file, its instance, and the body it holds."""

    file: Path
    instance: ModelInstanceIndex
    tool: RigidBody | None


def add_robot(parser: Parser, robot: RobotConfig) -> RobotInPlant:
    """Read the robot's model into a plant and fix its base to the world where it is free.

    What it holds becomes a body of the same model instance.

    Raises:
        ModelError: the model or the tool's mesh cannot be read, or the model lacks a name.
    """
    plant = parser.plant()
    file = find_resource("models", robot.model, MODEL_SUFFIXES)
    try:
        instance = parser.AddModels(str(file))[0]
    except (RuntimeError, ValueError) as error:
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
    tool = None if robot.tool is None else add_tool(plant, instance, robot.tool)
    return RobotInPlant(file, instance, tool)


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
