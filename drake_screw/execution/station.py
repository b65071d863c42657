"""A workcell that moves: position-controlled robot, what is around it, what executes plans."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from pydrake.geometry import (
    CollisionFilterDeclaration,
    GeometrySet,
    Meshcat,
    MeshcatVisualizer,
    MeshcatVisualizerParams,
    SceneGraph,
)
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import ModelInstanceIndex, RigidBody
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import (
    LogVectorOutput,
    MatrixGain,
    VectorLogSink,
)

from drake_screw.execution.executor import ScrewPlanExecutor
from drake_screw.execution.joint_path import JointPathSource
from drake_screw.execution.motors import motorise
from drake_screw.execution.screw_planner import ScrewPlanner, plan_inside
from drake_screw.execution.wiring import drive, measured_state, resting
from drake_screw.robot import Arm, ObjectConfig, ObstacleConfig, RobotConfig, TableConfig
from drake_screw.robot.ignored import let_links_touch
from drake_screw.robot.parts import add_robot, add_surroundings
from drake_screw.robot.tool import let_touch
from drake_screw.typing import Array

Follower = ScrewPlanExecutor | JointPathSource


@dataclass(frozen=True)
class Station:
    """A Drake diagram in which plans are executed; one serves any number of them.

    The diagram's input port "plan" goes to the follower; there is none where the diagram plans for
    itself. Objects are free bodies that are locked in place: what touches them meets resistance,
    and they do not move.

    Attributes:
        diagram, plant, scene_graph: discrete in time, the robot's gravity compensated.
        arm: kinematics and limits, on a plant of its own.
        follower: executes plans.
        objects: the objects' bodies.
        measured, desired: logs of q and v (2n,) at every step of the plant.
        parked: (N,) the plant's positions, with the arm's joints at 0 and all others at rest.
        columns: (n,) the arm's joints among them.
    """

    diagram: Diagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    arm: Arm
    follower: Follower
    objects: tuple[RigidBody, ...]
    measured: VectorLogSink
    desired: VectorLogSink
    parked: Array
    columns: Array

    @property
    def graphviz(self) -> str:
        """The diagram as text in Graphviz's dot language."""
        return str(self.diagram.GetGraphvizString(max_depth=1))

    def context(self, q: ArrayLike, X_WO: ArrayLike) -> Context:
        """A fresh context of the diagram.

        Args:
            q: (n,) rad, where the arm is.
            X_WO: (k, 4, 4) where the objects are.
        """
        root = self.diagram.CreateDefaultContext()
        context = self.plant.GetMyMutableContextFromRoot(root)
        positions = self.parked.copy()
        positions[self.columns] = q
        self.plant.SetPositions(context, positions)
        self.place(root, X_WO)
        for body in self.objects:
            body.Lock(context)
        return root

    def place(self, root: Context, X_WO: ArrayLike) -> None:
        """Put the objects at X_WO (k, 4, 4) in a context of the diagram."""
        context = self.plant.GetMyMutableContextFromRoot(root)
        for body, X in zip(self.objects, np.asarray(X_WO, dtype=float), strict=True):
            self.plant.SetFreeBodyPose(context, body, RigidTransform(X))


def build_station(
    robot: RobotConfig,
    *,
    table: TableConfig | None = None,
    objects: Sequence[ObjectConfig] = (),
    obstacles: Sequence[ObstacleConfig] = (),
    follow_screws: bool = True,
    planner: ScrewPlanner | None = None,
    meshcat: Meshcat | None = None,
    time_step: float = 2.5e-3,
) -> Station:
    """Build the diagram that executes plans.

    Args:
        robot: which arm of which model, where its other joints are held, and what it holds, which
            weighs nothing.
        table, objects, obstacles: of the workcell.
        follow_screws: execute with `ScrewPlanExecutor`; else play the joint path.
        planner: plans inside the diagram, for where the plant has the objects. Its plans go over
            into one another, which takes the executor that follows screws.
        meshcat: to draw the simulation in.
        time_step: s, of the plant.

    Raises:
        ModelError: the model or a mesh cannot be read, or the model lacks a name the configuration
            asks for.
        ValueError: there is a planner, and the joint path is to be played.
    """
    if planner is not None and not follow_screws:
        raise ValueError("a planner needs an executor that follows screws, not a joint path")
    builder = DiagramBuilder()
    config = MultibodyPlantConfig(time_step=time_step, contact_model="point")
    plant, scene_graph = AddMultibodyPlant(config, builder)
    parser = Parser(plant)
    added = add_robot(parser, robot)
    _, bodies = add_surroundings(plant, table, objects, obstacles)
    motorise(plant, added.models)
    for model in added.models:
        plant.set_gravity_enabled(model, False)
    plant.Finalize()
    _ignore_contacts_of_objects(plant, scene_graph, added.instances)
    if robot.tool is not None and added.tool is not None:
        let_touch(plant, scene_graph, added.tool, robot.tool.touches)
    let_links_touch(plant, scene_graph, added.models, robot)
    arm = _kinematics(robot)
    follower = builder.AddNamedSystem(
        "executor", ScrewPlanExecutor(arm) if follow_screws else JointPathSource(arm)
    )
    moved = added.arm()
    parked = resting(plant, moved)
    columns = np.array([joint.position_start() for joint in moved.joints])
    measure = builder.AddNamedSystem("arm_of_robot", MatrixGain(measured_state(plant, moved)))
    builder.Connect(plant.get_state_output_port(), measure.get_input_port())
    builder.Connect(measure.get_output_port(), follower.GetInputPort("measured_state"))
    drive(builder, plant, added.models, moved, follower.GetOutputPort("desired_state"))
    if planner is None:
        builder.ExportInput(follower.GetInputPort("plan"), "plan")
    else:
        plan_inside(builder, planner, plant, bodies, measure.get_output_port(), follower)
    builder.ExportOutput(follower.GetOutputPort("status"), "status")
    builder.ExportOutput(follower.GetOutputPort("progress"), "progress")
    measured = LogVectorOutput(measure.get_output_port(), builder)
    measured.set_name("measured_log")
    desired = LogVectorOutput(follower.GetOutputPort("desired_state"), builder)
    desired.set_name("desired_log")
    if meshcat is not None:
        MeshcatVisualizer.AddToBuilder(
            builder, scene_graph, meshcat, MeshcatVisualizerParams(prefix="/station")
        )
    diagram = builder.Build()
    diagram.set_name("station")
    return Station(
        diagram, plant, scene_graph, arm, follower, bodies, measured, desired, parked,
        columns,
    )  # fmt: skip


def _ignore_contacts_of_objects(
    plant: MultibodyPlant, scene_graph: SceneGraph, robot: Sequence[ModelInstanceIndex]
) -> None:
    """Table, obstacles and objects may touch one another: nothing of it matters to the robot."""
    others = GeometrySet()
    for index in plant.GetBodyIndices(plant.world_body().model_instance()):
        others.Add(plant.GetCollisionGeometriesForBody(plant.get_body(index)))
    for i in range(plant.num_model_instances()):
        if ModelInstanceIndex(i) not in robot:
            for index in plant.GetBodyIndices(ModelInstanceIndex(i)):
                others.Add(plant.GetCollisionGeometriesForBody(plant.get_body(index)))
    manager = scene_graph.collision_filter_manager()
    manager.Apply(CollisionFilterDeclaration().ExcludeWithin(others))


def _kinematics(robot: RobotConfig) -> Arm:
    """The arm on a plant of its own, for the executor."""
    plant = MultibodyPlant(0.0)
    added = add_robot(Parser(plant), robot)
    plant.Finalize()
    return added.arm()
