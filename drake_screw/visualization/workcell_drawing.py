"""Robot, table and obstacles in Meshcat, as Drake draws them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from pydrake.geometry import (
    Meshcat,
    MeshcatVisualizer,
    MeshcatVisualizerParams,
    Role,
    SceneGraph,
)
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.planning import RobotDiagramBuilder
from pydrake.systems.framework import Context

from drake_screw.robot import ObstacleConfig, RobotConfig, TableConfig
from drake_screw.robot.parts import add_robot, add_surroundings
from drake_screw.typing import Array


def draw_workcell(
    meshcat: Meshcat,
    robot: RobotConfig,
    table: TableConfig | None,
    obstacles: Sequence[ObstacleConfig],
) -> Array:
    """Draw what does not move under ``/workcell``, the robot where it starts.

    Returns:
        (n, 3) m, points around the robot: corners of boxes about its looks.

    Raises:
        ModelError: the robot's model or a mesh cannot be read, or the model lacks a name.
    """
    builder = RobotDiagramBuilder(time_step=0.0)
    plant = builder.plant()
    added = add_robot(builder.parser(), robot)
    add_surroundings(plant, table, obstacles=obstacles)
    plant.Finalize()
    arm = added.arm()
    parameters = MeshcatVisualizerParams(prefix="/workcell")
    MeshcatVisualizer.AddToBuilder(builder.builder(), builder.scene_graph(), meshcat, parameters)
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    positions = arm.full_positions(np.array(robot.start, dtype=float))
    plant.SetPositions(plant.GetMyMutableContextFromRoot(context), positions)
    diagram.ForcedPublish(context)
    return _corners(diagram.scene_graph(), plant, added.models, plant.GetMyContextFromRoot(context))


def _corners(
    graph: SceneGraph,
    plant: MultibodyPlant,
    models: Sequence[ModelInstanceIndex],
    context: Context,
) -> Array:
    """(n, 3) m, the corners in the world of boxes about all looks of some models."""
    inspector = graph.model_inspector()
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    found = [plant.EvalBodyPoseInWorld(context, plant.world_body()).translation()[None]]
    for body in (plant.get_body(i) for model in models for i in plant.GetBodyIndices(model)):
        X_WB = plant.EvalBodyPoseInWorld(context, body)
        frame = plant.GetBodyFrameIdOrThrow(body.index())
        for geometry in inspector.GetGeometries(frame, Role.kIllustration):
            box = inspector.GetObbInGeometryFrame(geometry)
            if box is not None:
                X_WC = X_WB @ inspector.GetPoseInFrame(geometry) @ box.pose()
                found.append((X_WC @ (signs * box.half_width()).T).T)
    return np.concatenate(found)
