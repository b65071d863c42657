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
    Shape,
)
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import ModelInstanceIndex, RigidBody
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import (
    ConstantVectorSource,
    LogVectorOutput,
    MatrixGain,
    VectorLogSink,
)

from drake_screw.execution.executor import ScrewPlanExecutor
from drake_screw.execution.free_objects import SETTLING, let_stand, unsettled
from drake_screw.execution.joint_path import JointPathSource
from drake_screw.execution.motors import motorise
from drake_screw.execution.screw_planner import ScrewPlanner, plan_inside
from drake_screw.execution.wiring import drive, encoders, free_bodies, measured_state, resting
from drake_screw.robot import Arm, ObjectConfig, ObstacleConfig, RobotConfig, TableConfig
from drake_screw.robot.ignored import let_links_touch
from drake_screw.robot.parts import add_robot, add_surroundings
from drake_screw.typing import Array

Follower = ScrewPlanExecutor | JointPathSource


@dataclass(frozen=True)
class Station:
    """A Drake diagram in which plans are executed; one serves any number of them.

    The diagram's input port "plan" goes to the follower; there is none where the diagram plans for
    itself. Objects are free bodies. They are locked in place, so that what touches them meets
    resistance and they do not move; or they stand on what is under them, and can be pushed.

    Attributes:
        diagram, plant, scene_graph: discrete in time, the robot's gravity compensated.
        arm: kinematics and limits, on a plant of its own.
        follower: executes plans.
        robot: the robot's model instances.
        objects: the objects' bodies.
        free_objects: whether they can be pushed.
        measured, desired: logs of q and v (2n,) at every step of the plant: where the arm is, and
            where its encoders are to be.
        moved: log of the objects' positions (7k,) in the plant, where they can be pushed.
        offsets: source of what the arm's joints are beyond what its encoders say, (2n,).
        parked: (N,) the plant's positions, with the arm's joints at 0 and all others at rest.
        columns: (n,) the arm's joints among them.
        model: hash of the robot's model as it was read.
    """

    diagram: Diagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    arm: Arm
    follower: Follower
    robot: tuple[ModelInstanceIndex, ...]
    objects: tuple[RigidBody, ...]
    free_objects: bool
    measured: VectorLogSink
    desired: VectorLogSink
    moved: VectorLogSink | None
    offsets: ConstantVectorSource
    parked: Array
    columns: Array
    model: str

    @property
    def graphviz(self) -> str:
        """The diagram as text in Graphviz's dot language."""
        return str(self.diagram.GetGraphvizString(max_depth=1))

    def context(
        self, q: ArrayLike, X_WO: ArrayLike, joint_offset: ArrayLike | None = None
    ) -> Context:
        """A fresh context of the diagram.

        Args:
            q: (n,) rad or m, where the arm's encoders say that it is.
            X_WO: (k, 4, 4) where the objects are.
            joint_offset: (n,) rad or m, how far its joints are beyond that; 0 if None.
        """
        root = self.diagram.CreateDefaultContext()
        offset = np.zeros(self.arm.n) if joint_offset is None else np.asarray(joint_offset)
        source = self.offsets.GetMyMutableContextFromRoot(root)
        held = self.offsets.get_mutable_source_value(source)
        held.SetFromVector([*offset, *np.zeros(self.arm.n)])
        context = self.plant.GetMyMutableContextFromRoot(root)
        positions = self.parked.copy()
        positions[self.columns] = np.asarray(q) + offset
        self.plant.SetPositions(context, positions)
        self.place(root, X_WO)
        if not self.free_objects:
            for body in self.objects:
                body.Lock(context)
        return root

    def place(self, root: Context, X_WO: ArrayLike) -> None:
        """Put the objects at X_WO (k, 4, 4) in a context of the diagram."""
        context = self.plant.GetMyMutableContextFromRoot(root)
        for body, X in zip(self.objects, np.asarray(X_WO, dtype=float), strict=True):
            self.plant.SetFreeBodyPose(context, body, RigidTransform(X))

    def settled(self, q: ArrayLike, X_WO: ArrayLike) -> tuple[Array, str]:
        """Where objects come to rest that are set down, before anything moves.

        They are left to themselves for `free_objects.SETTLING` seconds, with the arm held.

        Args:
            q: (n,) rad or m, where the arm is.
            X_WO: (k, 4, 4) where they are set down.

        Returns:
            X_WO (k, 4, 4), and in words what did not stay there; empty if all did.
        """
        placed = np.asarray(X_WO, dtype=float)
        if not self.free_objects or len(self.objects) == 0:
            return placed, ""
        root = self.context(q, placed)
        context = self.plant.GetMyMutableContextFromRoot(root)
        for model in self.robot:
            for index in self.plant.GetJointIndices(model):
                self.plant.get_joint(index).Lock(context)
        Simulator(self.diagram, root).AdvanceTo(SETTLING)
        found = [self.plant.EvalBodyPoseInWorld(context, body) for body in self.objects]
        settled = np.stack([X.GetAsMatrix4() for X in found])
        return settled, unsettled([body.name() for body in self.objects], placed, settled)


def build_station(
    robot: RobotConfig,
    *,
    table: TableConfig | None = None,
    objects: Sequence[ObjectConfig] = (),
    obstacles: Sequence[ObstacleConfig] = (),
    follow_screws: bool = True,
    free_objects: bool = False,
    planner: ScrewPlanner | None = None,
    meshcat: Meshcat | None = None,
    looks: Sequence[Shape] | None = None,
    time_step: float = 2.5e-3,
) -> Station:
    """Build the diagram that executes plans.

    Args:
        robot: which arm of which model, where its other joints are held, and what it holds, which
            weighs nothing.
        table, objects, obstacles: of the workcell.
        follow_screws: execute with `ScrewPlanExecutor`; else play the joint path.
        free_objects: objects can be pushed; else they are locked in place.
        planner: plans inside the diagram, for where the plant has the objects. Its plans go over
            into one another, which takes the executor that follows screws.
        meshcat: to draw the simulation in.
        looks: of the objects there, each in its own frame; cylinders if None.
        time_step: s, of the plant.

    Raises:
        ModelError: the model or a mesh cannot be read, or the model lacks a name the configuration
            asks for.
        ValueError: there is a planner, and the joint path is to be played.
    """
    if planner is not None and not follow_screws:
        raise ValueError("a planner needs an executor that follows screws, not a joint path")
    builder = DiagramBuilder()
    contact = "hydroelastic_with_fallback" if free_objects else "point"
    config = MultibodyPlantConfig(time_step=time_step, contact_model=contact)
    plant, scene_graph = AddMultibodyPlant(config, builder)
    parser = Parser(plant)
    added = add_robot(parser, robot)
    _, bodies = add_surroundings(plant, table, objects, obstacles, looks)
    motorise(plant, added.models)
    for model in added.models:
        plant.set_gravity_enabled(model, False)
    plant.Finalize()
    fixed = _fixed_bodies(plant, added.instances, bodies)
    if free_objects:
        radii = [item.radius for item in objects]
        let_stand(scene_graph, plant, list(zip(bodies, radii, strict=True)), fixed)
    else:
        _ignore_contacts_among(plant, scene_graph, [*fixed, *bodies])
    added.let_tools_touch(scene_graph)
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
    offsets, read, command = encoders(builder, moved.n, measure.get_output_port())
    builder.Connect(read, follower.GetInputPort("measured_state"))
    builder.Connect(follower.GetOutputPort("desired_state"), command.get_input_port(0))
    drive(builder, plant, added.models, moved, command.get_output_port())
    if planner is None:
        builder.ExportInput(follower.GetInputPort("plan"), "plan")
    else:
        plan_inside(builder, planner, plant, bodies, read, follower)
    builder.ExportOutput(follower.GetOutputPort("status"), "status")
    builder.ExportOutput(follower.GetOutputPort("progress"), "progress")
    measured = LogVectorOutput(measure.get_output_port(), builder)
    measured.set_name("measured_log")
    desired = LogVectorOutput(follower.GetOutputPort("desired_state"), builder)
    desired.set_name("desired_log")
    pushed = None
    if free_objects and bodies:
        places = builder.AddNamedSystem("objects", MatrixGain(free_bodies(plant, bodies)))
        builder.Connect(plant.get_state_output_port(), places.get_input_port())
        pushed = LogVectorOutput(places.get_output_port(), builder)
        pushed.set_name("objects_log")
    if meshcat is not None:
        MeshcatVisualizer.AddToBuilder(
            builder, scene_graph, meshcat, MeshcatVisualizerParams(prefix="/station")
        )
    diagram = builder.Build()
    diagram.set_name("station")
    return Station(
        diagram, plant, scene_graph, arm, follower, added.instances, bodies, free_objects,
        measured, desired, pushed, offsets, parked, columns, added.model.hash,
    )  # fmt: skip


def _fixed_bodies(
    plant: MultibodyPlant, robot: Sequence[ModelInstanceIndex], objects: Sequence[RigidBody]
) -> list[RigidBody]:
    """What is neither of the robot nor an object: table, obstacles, a model's own furniture."""
    models = [ModelInstanceIndex(i) for i in range(plant.num_model_instances())]
    indices = [i for m in models if m not in robot for i in plant.GetBodyIndices(m)]
    mine = {body.index() for body in objects}
    return [plant.get_body(i) for i in indices if i not in mine]


def _ignore_contacts_among(
    plant: MultibodyPlant, scene_graph: SceneGraph, bodies: Sequence[RigidBody]
) -> None:
    """Table, obstacles and locked objects may touch: nothing of it matters to the robot."""
    others = GeometrySet()
    for body in bodies:
        others.Add(plant.GetCollisionGeometriesForBody(body))
    manager = scene_graph.collision_filter_manager()
    manager.Apply(CollisionFilterDeclaration().ExcludeWithin(others))


def _kinematics(robot: RobotConfig) -> Arm:
    """The arm on a plant of its own, for the executor."""
    plant = MultibodyPlant(0.0)
    added = add_robot(Parser(plant), robot)
    plant.Finalize()
    return added.arm()
