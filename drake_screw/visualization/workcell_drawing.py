"""Robot, table and obstacles in Meshcat, as Drake draws them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams
from pydrake.planning import RobotDiagramBuilder

from drake_screw.robot import ObstacleConfig, RobotConfig, TableConfig
from drake_screw.robot.parts import add_robot, add_surroundings


def draw_workcell(
    meshcat: Meshcat,
    robot: RobotConfig,
    table: TableConfig | None,
    obstacles: Sequence[ObstacleConfig],
) -> None:
    """Draw what does not move under ``/workcell``, the robot where it starts.

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
