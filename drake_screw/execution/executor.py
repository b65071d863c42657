"""A plan's constant screws followed by differential inverse kinematics, as a Drake system."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from pydrake.common.value import Value
from pydrake.multibody.inverse_kinematics import (
    DifferentialInverseKinematicsParameters,
    DifferentialInverseKinematicsStatus,
    DoDifferentialInverseKinematics,
)
from pydrake.systems.framework import BasicVector, Context, EventStatus, LeafSystem, State

from drake_screw.execution.monitoring import (
    Tolerances,
    arrival,
    beginning,
    failed,
    out_of_reach,
    worst_lag,
)
from drake_screw.execution.status import ExecutionStatus, Phase
from drake_screw.execution.timing import TimedPlan
from drake_screw.planning.roll import along_roll_free, free_frame, turned_along
from drake_screw.robot import Arm
from drake_screw.screws import shift
from drake_screw.typing import Array

SINGULAR = 1e-6
"""Of the largest singular value of J: directions with a smaller one are none to move in."""


@dataclass(frozen=True)
class Control:
    """How the executor controls.

    Attributes:
        period: s, between control steps.
        pose_gain: 1/s, at which the end effector returns to its set point.
        centering_gain: 1/s, at which the joints return to the planned path.
    """

    period: float = 0.005
    pose_gain: float = 20.0
    centering_gain: float = 5.0


@dataclass(frozen=True, eq=False)
class _Memory:
    """The executor's state: a plan, since when, and the joint command from `updated` on."""

    plan: TimedPlan | None
    began: float
    updated: float
    q: Array
    v: Array
    status: ExecutionStatus
    progress: float = 0.0
    lagging_since: float | None = None

    def __deepcopy__(self, _: object) -> _Memory:
        return self


class ScrewPlanExecutor(LeafSystem):
    """Leads an arm's end effector along the constant screws of a plan.

    A free approach in front of them is followed joint by joint. Where the roll about an axis of the
    hand is free, its position and that axis are led, and the roll is drawn to the planned path's.

    Every control period it takes the set point of the current segment, a pose on the constant
    screw under the plan's time law and the screw's twist, and turns it into joint velocities by
    Drake's differential inverse kinematics, within the joints' position and velocity limits. The
    motion that the end effector leaves free is drawn to the planned joint path. The velocities are
    integrated: the arm's own position control follows them, and the measured state serves to
    notice that it does not.

    Input ports:
        plan: abstract, a `TimedPlan` or None. A plan that is not the one at hand begins at once, or
            at the time that it names: the one at hand is followed until then, and the command goes
            on from where it is.
        measured_state: (2n,) measured q in rad (or m), then v.

    Output ports:
        desired_state: (2n,) q and v for the arm's position control. Between control steps q
            advances at v. It holds still when nothing runs, after a blockage where the arm is.
        status: abstract, `ExecutionStatus`: idle; running; done, once the measured end effector is
            at the last guiding pose; failed, with segment and reason; or what the plan says that
            it ends with. It stays so until another plan comes.
        progress: (1,) part of the plan's time that is over, 0 to 1.

    Args:
        arm: that is moved. Its plant serves for kinematics and limits; it is not simulated.
        control: period and gains.
        tolerances: beyond which the execution fails.
    """

    def __init__(
        self, arm: Arm, *, control: Control | None = None, tolerances: Tolerances | None = None
    ) -> None:
        super().__init__()
        self.arm = arm
        self.control = control or Control()
        self.tolerances = tolerances or Tolerances()
        self._parameters = _parameters(arm, self.control)
        self._lags, self._units = self.tolerances.lags(arm), arm.units
        self._plan = self.DeclareAbstractInputPort("plan", Value[object]())
        self._measured = self.DeclareVectorInputPort("measured_state", 2 * arm.n)
        rest = _Memory(None, 0.0, -np.inf, arm.middle, np.zeros(arm.n), ExecutionStatus())
        self._state = self.DeclareAbstractState(Value[object](rest))
        self.DeclareInitializationUnrestrictedUpdateEvent(self._initialize)
        self.DeclarePeriodicUnrestrictedUpdateEvent(self.control.period, 0.0, self._step)
        memory = {self.abstract_state_ticket(self._state)}
        sources = {*memory, self.time_ticket()}
        self.DeclareVectorOutputPort("desired_state", 2 * arm.n, self._write_desired, sources)
        self.DeclareAbstractOutputPort(
            "status", lambda: Value[object](ExecutionStatus()), self._write_status, memory
        )
        self.DeclareVectorOutputPort("progress", 1, self._write_progress, memory)

    def _memory(self, context: Context) -> _Memory:
        return context.get_abstract_state(int(self._state)).get_value()

    def _write_desired(self, context: Context, output: BasicVector) -> None:
        memory = self._memory(context)
        output.SetFromVector(np.concatenate([self._command(memory, context), memory.v]))

    def _write_status(self, context: Context, output: Value) -> None:
        output.set_value(self._memory(context).status)

    def _write_progress(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector([self._memory(context).progress])

    def _command(self, memory: _Memory, context: Context) -> Array:
        elapsed = min(context.get_time() - memory.updated, self.control.period)
        return memory.q + elapsed * memory.v

    def _initialize(self, context: Context, state: State) -> EventStatus:
        if 0.0 <= context.get_time() - self._memory(context).updated < 1.5 * self.control.period:
            return EventStatus.DidNothing()  # it goes on from a copy
        q = self._measured.Eval(context)[: self.arm.n]
        rest = _Memory(None, 0.0, context.get_time(), q, np.zeros(self.arm.n), ExecutionStatus())
        state.get_mutable_abstract_state(int(self._state)).set_value(rest)
        return EventStatus.Succeeded()

    def _step(self, context: Context, state: State) -> EventStatus:
        memory, t = self._memory(context), context.get_time()
        measured = self._measured.Eval(context)[: self.arm.n]
        plan = self._plan.Eval(context) if self._plan.HasValue(context) else None
        memory = replace(
            memory, q=self._command(memory, context), v=np.zeros(self.arm.n), updated=t
        )
        if plan is not memory.plan and _due(plan, t):
            status = beginning(plan, self.arm, measured, self.tolerances)
            began = t if plan is None or plan.begins is None else plan.begins
            memory = _Memory(plan, began, t, memory.q, memory.v, status)
            if plan is not None and plan.begins is None and status.phase is Phase.RUNNING:
                memory = replace(memory, q=plan.segments[0].q[0])
        if memory.status.phase is Phase.RUNNING:
            memory = self._follow(memory, measured)
        state.get_mutable_abstract_state(int(self._state)).set_value(memory)
        return EventStatus.Succeeded()

    def _follow(self, memory: _Memory, measured: Array) -> _Memory:
        """One control step of a running plan."""
        arm, plan, q, allowed = self.arm, memory.plan, memory.q, self.tolerances
        assert plan is not None
        t = memory.updated - memory.began
        now, ahead = plan.at(t), plan.at(t + self.control.period / 2.0)
        memory = replace(
            memory,
            status=ExecutionStatus(Phase.RUNNING, plan.shown(now.segment)),
            progress=min(t / plan.duration, 1.0),
        )
        late, joint, lag = worst_lag(self._lags, q, measured)
        since = memory.lagging_since if memory.lagging_since is not None else memory.updated
        memory = replace(memory, lagging_since=since if late else None)
        if memory.updated - since > allowed.patience and late:
            how_far = f"{arm.joint_names[joint]} stays {lag:.3f} {self._units[joint]} behind"
            reason = f"the arm is blocked: {how_far}"
            return replace(memory, q=measured, status=failed(now.segment, reason))
        X_WE, J_WE = arm.pose_and_jacobian(q)
        X_WS = turned_along(X_WE, plan.segments[now.segment].pose(now.s), plan.free_axis)
        ended = arrival(plan, t, arm.pose(measured), allowed) if t >= plan.duration else None
        if plan.segments[now.segment].screw:
            ended = ended or out_of_reach(now.segment, X_WE, X_WS, allowed, plan.free_axis)
        if ended is not None:
            return replace(memory, status=ended)
        if not plan.segments[ahead.segment].screw:
            v = ahead.v + self.control.pose_gain * (now.q - q)
            return replace(memory, v=self._within_limits(q, v))
        V_WS = ahead.rate * plan.segments[ahead.segment].twist
        V_WE = shift(V_WS, X_WE[:3, 3]) + self.control.pose_gain * _difference(X_WE, X_WS)
        self._parameters.set_nominal_joint_position(ahead.q)
        if plan.free_axis is not None:
            P = along_roll_free(X_WE @ free_frame(plan.free_axis))
            V_WE, J_WE = P @ V_WE, P @ J_WE
        V, J = _possible(V_WE, J_WE)
        solution = DoDifferentialInverseKinematics(q, memory.v, V, J, self._parameters)
        if solution.status == DifferentialInverseKinematicsStatus.kSolutionFound:
            memory = replace(memory, v=self._within_limits(q, solution.joint_velocities))
        return memory

    def _within_limits(self, q: Array, v: Array) -> Array:
        """Velocities cut to the limits, which the solver keeps to about a thousandth."""
        arm, period = self.arm, self.control.period
        least = np.maximum(-arm.velocity_limits, (arm.lower - q) / period)
        most = np.minimum(arm.velocity_limits, (arm.upper - q) / period)
        return np.clip(v, np.minimum(least, 0.0), np.maximum(most, 0.0))


def _due(plan: TimedPlan | None, t: float) -> bool:
    """Whether a plan's time has come."""
    return plan is None or plan.begins is None or t >= plan.begins - 1e-9


def _parameters(arm: Arm, control: Control) -> DifferentialInverseKinematicsParameters:
    parameters = DifferentialInverseKinematicsParameters(arm.n, arm.n)
    parameters.set_time_step(control.period)
    parameters.set_joint_position_limits((arm.lower, arm.upper))
    parameters.set_joint_velocity_limits((-arm.velocity_limits, arm.velocity_limits))
    parameters.set_joint_centering_gain(control.centering_gain * np.eye(arm.n))
    return parameters


def _possible(V_WE: Array, J_WE: Array) -> tuple[Array, Array]:
    """The part of a twist (d,) that an arm of fewer joints than d can give.

    Drake's solver wants the twist exactly, and stands still at a rounding error in a direction in
    which the arm cannot move.

    Returns:
        V (m,) and J (m, n) in m directions in which it can.
    """
    if J_WE.shape[1] >= len(J_WE):
        return V_WE, J_WE
    U, size, _ = np.linalg.svd(J_WE, full_matrices=False)
    directions = U[:, size > SINGULAR * size[0]].T
    return directions @ V_WE, directions @ J_WE


def _difference(X_WE: Array, X_WS: Array) -> Array:
    """(6,) the small motion [w; v], at E's origin in W, that takes pose E to pose S."""
    R = X_WS[:3, :3] @ X_WE[:3, :3].T
    w = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return np.concatenate([w, X_WS[:3, 3] - X_WE[:3, 3]])
