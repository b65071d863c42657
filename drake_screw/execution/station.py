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
from pydrake.multibody.tree import ModelInstanceIndex, PdControllerGains, RigidBody
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import (
    Adder,
    ConstantVectorSource,
    LogVectorOutput,
    MatrixGain,
    VectorLogSink,
)

from drake_screw.execution.executor import ScrewPlanExecutor
from drake_screw.execution.joint_path import JointPathSource
from drake_screw.robot import Arm, ObjectConfig, ObstacleConfig, RobotConfig, TableConfig
from drake_screw.robot.parts import add_robot, add_surroundings
from drake_screw.robot.tool import let_touch
from drake_screw.typing import Array

Follower = ScrewPlanExecutor | JointPathSource

STIFFNESS = 80.0  # 1/rad: position gains as multiples of a joint's greatest effort
DAMPING = 0.05  # s: velocity gains as multiples of position gains
UNRATED = 100.0  # N m, greatest effort assumed for gains where the model states none that is true
MOST_EFFORT = 1e4  # N m; more than this is no statement


@dataclass(frozen=True)
class Station:
    """A Drake diagram in which plans are executed; one serves any number of them.

    The diagram's input port "plan" goes to the follower. Objects are free bodies that are locked
    in place: what touches them meets resistance, and they do not move.

    Attributes:
        diagram, plant, scene_graph: discrete in time, the robot's gravity compensated.
        arm: kinematics and limits, on a plant of its own.
        follower: executes plans.
        robot: the robot's model instance.
        objects: the objects' bodies.
        measured, desired: logs of q and v (2n,) at every step of the plant.
        parked: (N,) positions of the robot's N joints, with the arm's at 0.
        columns: (n,) the arm's joints among the robot's N.
    """

    diagram: Diagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    arm: Arm
    follower: Follower
    robot: ModelInstanceIndex
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
        self.plant.SetPositions(context, self.robot, positions)
        for body, X in zip(self.objects, np.asarray(X_WO, dtype=float), strict=True):
            self.plant.SetFreeBodyPose(context, body, RigidTransform(X))
            body.Lock(context)
        return root


def build_station(
    robot: RobotConfig,
    *,
    table: TableConfig | None = None,
    objects: Sequence[ObjectConfig] = (),
    obstacles: Sequence[ObstacleConfig] = (),
    follow_screws: bool = True,
    meshcat: Meshcat | None = None,
    time_step: float = 2.5e-3,
) -> Station:
    """Build the diagram that executes plans.

    Args:
        robot: which arm of which model, where its other joints are held, and what it holds, which
            weighs nothing.
        table, objects, obstacles: of the workcell.
        follow_screws: execute with `ScrewPlanExecutor`; else play the joint path.
        meshcat: to draw the simulation in.
        time_step: s, of the plant.

    Raises:
        ModelError: the model or a mesh cannot be read, or the model lacks a name the configuration
            asks for.
    """
    builder = DiagramBuilder()
    config = MultibodyPlantConfig(time_step=time_step, contact_model="point")
    plant, scene_graph = AddMultibodyPlant(config, builder)
    parser = Parser(plant)
    _, instance, tool = add_robot(parser, robot)
    _, bodies = add_surroundings(plant, table, objects, obstacles)
    _motorise(plant, instance)
    plant.set_gravity_enabled(instance, False)
    plant.Finalize()
    _ignore_contacts_of_objects(plant, scene_graph, instance)
    if robot.tool is not None and tool is not None:
        let_touch(plant, scene_graph, tool, robot.tool.touches)
    arm = _kinematics(robot)
    follower = builder.AddNamedSystem(
        "executor", ScrewPlanExecutor(arm) if follow_screws else JointPathSource(arm)
    )
    columns, parked = _joints(plant, instance, arm)
    N, n = len(parked), arm.n
    pick = np.zeros((2 * n, 2 * N))
    pick[np.arange(n), columns] = pick[n + np.arange(n), N + columns] = 1.0
    rest = np.concatenate([parked, np.zeros(N)])
    rest[columns] = 0.0
    measure = builder.AddNamedSystem("arm_of_robot", MatrixGain(pick))
    spread = builder.AddNamedSystem("robot_of_arm", MatrixGain(pick.T))
    idle = builder.AddNamedSystem("idle_joints", ConstantVectorSource(rest))
    command = builder.AddNamedSystem("joint_command", Adder(2, 2 * N))
    builder.Connect(plant.get_state_output_port(instance), measure.get_input_port())
    builder.Connect(measure.get_output_port(), follower.GetInputPort("measured_state"))
    builder.Connect(follower.GetOutputPort("desired_state"), spread.get_input_port())
    builder.Connect(spread.get_output_port(), command.get_input_port(0))
    builder.Connect(idle.get_output_port(), command.get_input_port(1))
    builder.Connect(command.get_output_port(), plant.get_desired_state_input_port(instance))
    builder.ExportInput(follower.GetInputPort("plan"), "plan")
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
        diagram, plant, scene_graph, arm, follower, instance, bodies, measured, desired,
        parked, columns,
    )  # fmt: skip


def _motorise(plant: MultibodyPlant, robot: ModelInstanceIndex) -> None:
    """Position control of every joint with one degree of freedom, within the model's efforts."""
    driven = {}
    for index in plant.GetJointActuatorIndices():
        actuator = plant.get_joint_actuator(index)
        driven[actuator.joint().index()] = actuator
    for index in plant.GetJointIndices(robot):
        joint = plant.get_joint(index)
        if joint.num_velocities() != 1:
            continue
        actuator = driven.get(index) or plant.AddJointActuator(joint.name(), joint)
        effort = actuator.effort_limit()
        p = STIFFNESS * (effort if effort < MOST_EFFORT else UNRATED)
        actuator.set_controller_gains(PdControllerGains(p=p, d=DAMPING * p))


def _ignore_contacts_of_objects(
    plant: MultibodyPlant, scene_graph: SceneGraph, robot: ModelInstanceIndex
) -> None:
    """Table, obstacles and objects may touch one another: nothing of it matters to the robot."""
    others = GeometrySet()
    for index in plant.GetBodyIndices(plant.world_body().model_instance()):
        others.Add(plant.GetCollisionGeometriesForBody(plant.get_body(index)))
    for i in range(plant.num_model_instances()):
        if ModelInstanceIndex(i) != robot:
            for index in plant.GetBodyIndices(ModelInstanceIndex(i)):
                others.Add(plant.GetCollisionGeometriesForBody(plant.get_body(index)))
    manager = scene_graph.collision_filter_manager()
    manager.Apply(CollisionFilterDeclaration().ExcludeWithin(others))


def _kinematics(robot: RobotConfig) -> Arm:
    """The arm on a plant of its own, for the executor."""
    plant = MultibodyPlant(0.0)
    add_robot(Parser(plant), robot)
    plant.Finalize()
    return Arm(plant, robot.joints, robot.frame, parked=robot.parked)


def _joints(plant: MultibodyPlant, robot: ModelInstanceIndex, arm: Arm) -> tuple[Array, Array]:
    """Where the arm's joints stand among the robot's, and where those rest."""
    place = plant.GetPositionsFromArray(robot, np.arange(plant.num_positions(), dtype=float))
    columns = [
        int(np.flatnonzero(place == plant.GetJointByName(name, robot).position_start())[0])
        for name in arm.joint_names
    ]
    resting = arm.full_positions(np.zeros(arm.n))
    parked = np.zeros(len(place))
    for index in plant.GetJointIndices(robot):
        joint = plant.get_joint(index)
        if joint.num_positions() == 1:
            own = arm.plant.GetJointByName(joint.name()).position_start()
            parked[place == joint.position_start()] = resting[own]
    return np.array(columns), parked
