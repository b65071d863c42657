"""The shape of what an end effector holds: a part of the robot that moves with it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, FrameIndex, RigidBody, SpatialInertia

from drake_screw.errors import ModelError
from drake_screw.robot.names import Instances, find_body, find_frame
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
        name: of its body.
        place: of its block in a scenario, for messages.
    """

    frame: str
    shape: PlacedShape
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    touches: tuple[str, ...] = ()
    name: str = "tool"
    place: str = "robot.tool"

    @property
    def X_FT(self) -> RigidTransform:
        """Pose of the tool."""
        return RigidTransform(RollPitchYaw(self.rpy), self.xyz)


def add_tool(plant: MultibodyPlant, robot: Instances, tool: ToolConfig) -> RigidBody:
    """Add a tool to a robot's model as a body without mass, with a visual and a collision shape.

    It belongs to the model that has the frame. Its name is its own, or the like where the robot has
    something of that name. Drake lets it touch the links that are rigidly fixed to it.

    Raises:
        ModelError: the plant does not have the frame, or the mesh cannot be read.
    """
    frame = find_frame(plant, tool.frame, robot)
    try:
        shape = tool.shape.drake()
    except ModelError as error:
        message = f"{tool.place}.shape: {error.message}"
        raise ModelError(message, remedy=error.remedy, file=error.file) from error
    taken = {plant.get_frame(FrameIndex(i)).name() for i in range(plant.num_frames())}
    free = (name for n in count(2) for name in (tool.name, f"{tool.name}_{n}") if name not in taken)
    body = plant.AddRigidBody(next(free), frame.model_instance(), SpatialInertia.Zero())
    plant.WeldFrames(frame, body.body_frame(), tool.X_FT)
    register(plant, body, shape, tool.shape.X_FG, STEEL)
    return body


def let_touch(
    plant: MultibodyPlant, scene_graph: SceneGraph, body: RigidBody, tool: ToolConfig
) -> None:
    """Let a tool's body touch what it may, bodies of a finalized plant by their names.

    Raises:
        ModelError: there is no such body, or more than one.
    """
    bodies = [plant.get_body(BodyIndex(i)) for i in range(1, plant.num_bodies())]
    others = [other for other in bodies if other.index() != body.index()]
    for name in tool.touches:
        other = find_body(
            name,
            others,
            key=f"{tool.place}.touches",
            kind="part",
            many="parts of the workcell",
            where="the workcell",
            choices=others,
        )
        leave_out(plant, scene_graph, body, other)


def leave_out(plant: MultibodyPlant, scene_graph: SceneGraph, a: RigidBody, b: RigidBody) -> None:
    """Have Drake never look at whether two bodies of a finalized plant touch."""
    shapes = [GeometrySet(plant.GetCollisionGeometriesForBody(body)) for body in (a, b)]
    scene_graph.collision_filter_manager().Apply(
        CollisionFilterDeclaration().ExcludeBetween(*shapes)
    )
