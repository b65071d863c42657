"""Things that stand in a workcell and never move."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody, SpatialInertia

from drake_screw.errors import ModelError
from drake_screw.robot.shapes import PlacedShape, register

STONE = np.array([0.52, 0.56, 0.62, 1.0])


@dataclass(frozen=True)
class ObstacleConfig:
    """A thing that never moves; its shape is placed in W."""

    name: str
    shape: PlacedShape


def add_obstacle(plant: MultibodyPlant, item: ObstacleConfig) -> RigidBody:
    """Add an obstacle as a body fixed to the world, with a visual and a collision shape.

    Raises:
        ModelError: its mesh cannot be read.
    """
    try:
        shape = item.shape.drake()
    except ModelError as error:
        message = f"obstacle '{item.name}': {error.message}"
        raise ModelError(message, remedy=error.remedy, file=error.file) from error
    body = plant.AddRigidBody(item.name, plant.AddModelInstance(item.name), SpatialInertia.Zero())
    plant.WeldFrames(plant.world_frame(), body.body_frame(), item.shape.X_FG)
    register(plant, body, shape, RigidTransform(), STONE)
    return body
