"""Planning inside a diagram: from where the objects are to the plan that is executed."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import (
    BasicVector,
    Context,
    DiagramBuilder,
    EventStatus,
    LeafSystem,
    OutputPort,
    State,
)

from drake_screw.errors import DrakeScrewError
from drake_screw.execution.choosing import Choice, Chooser
from drake_screw.execution.following import Follower, Following, PlannerMemory, Seen
from drake_screw.execution.monitoring import Tolerances
from drake_screw.execution.timing import TimeLimits
from drake_screw.screws import pose
from drake_screw.screws.rotations import rotation_from_quaternion
from drake_screw.typing import Array

PoseList = Value[list[RigidTransform]]
"""What a plant's port `body_poses` carries; pydrake.multibody.plant brings this type along."""


class ScrewPlanner(LeafSystem):
    """Plans for where the objects are, and goes on planning while they are moved.

    When the arm and the objects are at rest, it plans with all demonstrations from where the arm
    is, and takes the plan that keeps farthest from the joint limits. Until the first guiding pose
    is reached it follows objects that move: demonstration and turn stay, and the arm goes over from
    one motion to the next without coming to rest (see `handover`). The way to the first guiding
    pose is checked for collisions as it is played; it is a screw no longer. Where no plan follows,
    the arm comes to rest on its path, and everything is tried again when the objects rest. From the
    first guiding pose on nothing is changed. An object that is moved then, and that the rest of the
    plan is about, ends the execution: the arm comes to rest on its path, and the executor's status
    says which object it was, and how far it was moved.

    Without a trigger it plans whenever it is idle and an object has come to rest in a new place;
    after a failure of the execution never again. With one it plans when asked, and after failures,
    too. All state is in the context.

    Input ports:
        object_poses: abstract, a list of k `RigidTransform`, X_WO: what `ObjectPoses` makes of a
            plant's `body_poses`. This port or the next.
        object_positions: (7k,) for each object a quaternion (w, x, y, z), then p_WO in m: a free
            body's positions in a plant.
        measured_state: (2n,) measured q in rad (or m), then v.
        trigger: (1,) optional; asks for a plan as it rises above 0.5.
        execution_status: abstract, optional: the executor's `status`. Without it an execution is
            over when its time is.

    Output ports:
        plan: abstract, a `TimedPlan` for `ScrewPlanExecutor`, or None. It begins one period later.
        outcome: abstract, `PlanningOutcome`: success, or segment, cause and joint of the best
            attempt.
        choice: abstract, the `Choice` behind the plan: demonstration, variant, how symmetric
            objects are turned; None without a plan.
        margins: (n,) each joint's least distance from its limits along the plan, in parts of its
            range; NaN without a plan.
        mode: abstract, `Mode`: waiting, following, committed, stopping or ended.
        replans: (1,) how often the plan has been replaced while the arm moved.

    Args:
        chooser: plans; `drake_screw.assembly.plan_chooser` makes one from a scenario.
        following: how objects are followed, and how often planning may be asked for.
        limits: how fast plans are executed.
        tolerances: of the executor.
    """

    def __init__(
        self,
        chooser: Chooser,
        *,
        following: Following | None = None,
        limits: TimeLimits | None = None,
        tolerances: Tolerances | None = None,
    ) -> None:
        super().__init__()
        self.chooser, self.following = chooser, following or Following()
        how = limits or TimeLimits(), tolerances or Tolerances()
        self._follower = Follower(chooser, self.following, *how)
        k, n = len(chooser.names), chooser.arm.n
        self._poses = self.DeclareAbstractInputPort("object_poses", PoseList())
        self._positions = self.DeclareVectorInputPort("object_positions", 7 * k)
        self._measured = self.DeclareVectorInputPort("measured_state", 2 * n)
        self._trigger = self.DeclareVectorInputPort("trigger", 1)
        self._status = self.DeclareAbstractInputPort("execution_status", Value[object]())
        self._state = self.DeclareAbstractState(Value[object](PlannerMemory()))
        self.DeclarePeriodicUnrestrictedUpdateEvent(self.following.period, 0.0, self._step)
        memory = {self.abstract_state_ticket(self._state)}
        for name in ("plan", "outcome", "choice", "mode"):
            self.DeclareAbstractOutputPort(name, Value[object], self._writer(name), memory)
        self.DeclareVectorOutputPort("margins", n, self._write_margins, memory)
        self.DeclareVectorOutputPort("replans", 1, self._write_replans, memory)

    def _memory(self, context: Context) -> PlannerMemory:
        return context.get_abstract_state(int(self._state)).get_value()

    def _writer(self, name: str) -> Callable[[Context, Value], None]:
        def write(context: Context, output: Value) -> None:
            output.set_value(getattr(self._memory(context), name))

        return write

    def _write_margins(self, context: Context, output: BasicVector) -> None:
        choice: Choice | None = self._memory(context).choice
        n = self.chooser.arm.n
        output.SetFromVector(np.full(n, np.nan) if choice is None else choice.margins)

    def _write_replans(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector([self._memory(context).replans])

    def _step(self, context: Context, state: State) -> EventStatus:
        n = self.chooser.arm.n
        measured = self._measured.Eval(context)
        seen = Seen(
            context.get_time(),
            self._X_WO(context),
            measured[:n],
            measured[n:],
            self._trigger.Eval(context)[0] > 0.5 if self._trigger.HasValue(context) else None,
            self._status.Eval(context) if self._status.HasValue(context) else None,
        )
        memory = self._follower.step(self._memory(context), seen)
        state.get_mutable_abstract_state(int(self._state)).set_value(memory)
        return EventStatus.Succeeded()

    def _X_WO(self, context: Context) -> Array:
        """(k, 4, 4) where the objects are.

        Raises:
            DrakeScrewError: no port says it, or one says what is no pose.
        """
        k = len(self.chooser.names)
        if self._poses.HasValue(context):
            poses = self._poses.Eval(context)
            if len(poses) != k:
                raise DrakeScrewError(
                    f"port object_poses has {len(poses)} poses; there are to be {k}, of "
                    f"{', '.join(self.chooser.names)}",
                    remedy="Connect a plant's body_poses through ObjectPoses, which picks them.",
                )
            return np.stack([X.GetAsMatrix4() for X in poses]) if k else np.zeros((0, 4, 4))
        if not self._positions.HasValue(context):
            raise DrakeScrewError(
                "the planner does not know where the objects are",
                remedy="Connect its port object_poses or object_positions.",
            )
        numbers = self._positions.Eval(context).reshape(k, 7)
        size = np.linalg.norm(numbers[:, :4], axis=1)
        if not np.isfinite(numbers).all() or (np.abs(size - 1.0) > 1e-3).any():
            raise DrakeScrewError(
                f"port object_positions holds {numbers.round(3).tolist()}, which are no poses",
                remedy="Give a unit quaternion (w, x, y, z), then x, y, z in m for each object.",
            )
        unit = numbers[:, :4] / size[:, None]
        return pose(rotation_from_quaternion(unit), numbers[:, 4:])


class ObjectPoses(LeafSystem):
    """Picks the poses of some bodies out of those of all bodies of a plant.

    Input ports:
        body_poses: abstract, a list of `RigidTransform`: a plant's port of that name.

    Output ports:
        object_poses: abstract, a list of k `RigidTransform`, X_WO in the order of the bodies.

    Args:
        bodies: k of the plant, once that is finalized.
    """

    def __init__(self, bodies: Sequence[RigidBody]) -> None:
        super().__init__()
        self._indices = [int(body.index()) for body in bodies]
        self._all = self.DeclareAbstractInputPort("body_poses", PoseList())
        self.DeclareAbstractOutputPort("object_poses", PoseList, self._write)

    def _write(self, context: Context, output: Value) -> None:
        poses = self._all.Eval(context)
        output.set_value([poses[i] for i in self._indices])


def plan_inside(
    builder: DiagramBuilder,
    planner: ScrewPlanner,
    plant: MultibodyPlant,
    bodies: Sequence[RigidBody],
    measured: OutputPort,
    follower: LeafSystem,
) -> None:
    """Close the loop: a plant's bodies to the planner, and its plans to what executes them.

    The planner's outcome, mode, choice and margins become output ports of the diagram.

    Args:
        builder: of the diagram.
        planner: that is added to it.
        plant: finalized.
        bodies: the k objects.
        measured: the arm's q and v (2n,).
        follower: executes; it has the ports of `ScrewPlanExecutor`.
    """
    builder.AddNamedSystem("planner", planner)
    poses = builder.AddNamedSystem("object_poses", ObjectPoses(bodies))
    builder.Connect(plant.get_body_poses_output_port(), poses.get_input_port())
    builder.Connect(poses.get_output_port(), planner.GetInputPort("object_poses"))
    builder.Connect(measured, planner.GetInputPort("measured_state"))
    builder.Connect(follower.GetOutputPort("status"), planner.GetInputPort("execution_status"))
    builder.Connect(planner.GetOutputPort("plan"), follower.GetInputPort("plan"))
    for name in ("outcome", "mode", "choice", "margins"):
        builder.ExportOutput(planner.GetOutputPort(name), name)
