"""The shape of what an end effector holds: a part of the robot that moves with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex, RigidBody, SpatialInertia

from drake_screw.errors import ModelError, unknown
from drake_screw.robot.arm import find_frame
from drake_screw.robot.names import taken_names
from drake_screw.robot.shapes import PlacedShape, register

STEEL = np.array([0.36, 0.52, 0.70, 1.0])


@dataclass(frozen=True)
class ToolConfig:
    """What an end effector holds.

    Attributes:
        frame: that the tool is fixed to.
        shape: placed in the tool's frame T.
        xyz: p_FT in m.
        rpy: roll, pitch and yaw of T in that frame, rad.
        touches: names of links, of the table, of obstacles and objects that it may touch.
    """

    frame: str
    shape: PlacedShape
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    touches: tuple[str, ...] = ()

    @property
    def X_FT(self) -> RigidTransform:
        """Pose of the tool."""
        return RigidTransform(RollPitchYaw(self.rpy), self.xyz)


def add_tool(plant: MultibodyPlant, robot: ModelInstanceIndex, tool: ToolConfig) -> RigidBody:
    """Add a tool to a robot's model as a body without mass, with a visual and a collision shape.

    Its name is "tool", or the like where the model has something of that name. Drake lets it
    touch the links that are rigidly fixed to it.

    Raises:
        ModelError: the plant does not have the frame, or the mesh cannot be read.
    """
    frame = find_frame(plant, tool.frame)
    try:
        shape = tool.shape.drake()
    except ModelError as error:
        message = f"robot.tool.shape: {error.message}"
        raise ModelError(message, remedy=error.remedy, file=error.file) from error
    taken = taken_names(plant)
    free = (name for n in count(2) for name in ("tool", f"tool_{n}") if name not in taken)
    body = plant.AddRigidBody(next(free), robot, SpatialInertia.Zero())
    plant.WeldFrames(frame, body.body_frame(), tool.X_FT)
    register(plant, body, shape, tool.shape.X_FG, STEEL)
    return body


def let_touch(
    plant: MultibodyPlant, scene_graph: SceneGraph, body: RigidBody, names: Sequence[str]
) -> None:
    """Let a tool touch bodies of a finalized plant by their names.

    Raises:
        ModelError: there is no such body.
    """
    others: dict[str, list[RigidBody]] = {}
    for i in range(1, plant.num_bodies()):
        other = plant.get_body(BodyIndex(i))
        if other.index() != body.index():
            others.setdefault(other.name(), []).append(other)
    mine = GeometrySet(plant.GetCollisionGeometriesForBody(body))
    manager = scene_graph.collision_filter_manager()
    for name in names:
        if name not in others:
            message, remedy = unknown("part", name, "the workcell", list(others))
            raise ModelError(f"robot.tool.touches: {message}", remedy=remedy)
        for other in others[name]:
            theirs = GeometrySet(plant.GetCollisionGeometriesForBody(other))
            manager.Apply(CollisionFilterDeclaration().ExcludeBetween(mine, theirs))
