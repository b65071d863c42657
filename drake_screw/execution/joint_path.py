"""The baseline to following screws: play the planned joint path by the clock."""

from __future__ import annotations

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_screw.execution.monitoring import Tolerances, arrival
from drake_screw.execution.status import ExecutionStatus, Phase
from drake_screw.execution.timing import TimedPlan
from drake_screw.robot import Arm


class JointPathSource(LeafSystem):
    """Plays the time-parametrised joint path of a plan from time 0, and checks nothing on the way.

    It has the ports of `ScrewPlanExecutor`, so that the two can take each other's place.

    Input ports:
        plan: abstract, a `TimedPlan` or None.
        measured_state: (2n,) measured q in rad (or m), then v.

    Output ports:
        desired_state: (2n,) q and v of the joint path; without a plan, the middle of the joints'
            ranges at rest.
        status: abstract, `ExecutionStatus`; whether the end effector arrives is known after the
            plan's time only.
        progress: (1,) part of the plan's time that is over, 0 to 1.

    Args:
        arm: that is moved.
        tolerances: of the end.
    """

    def __init__(self, arm: Arm, *, tolerances: Tolerances | None = None) -> None:
        super().__init__()
        self.arm = arm
        self.tolerances = tolerances or Tolerances()
        self._plan = self.DeclareAbstractInputPort("plan", Value[object]())
        self._measured = self.DeclareVectorInputPort("measured_state", 2 * arm.n)
        sources = {self.time_ticket(), self.input_port_ticket(self._plan.get_index())}
        self.DeclareVectorOutputPort("desired_state", 2 * arm.n, self._write_desired, sources)
        self.DeclareAbstractOutputPort(
            "status", lambda: Value[object](ExecutionStatus()), self._write_status
        )
        self.DeclareVectorOutputPort("progress", 1, self._write_progress, sources)

    def _timed(self, context: Context) -> TimedPlan | None:
        plan = self._plan.Eval(context) if self._plan.HasValue(context) else None
        return plan if plan is not None and plan.segments else None

    def _write_desired(self, context: Context, output: BasicVector) -> None:
        plan = self._timed(context)
        q, v = self.arm.middle, np.zeros(self.arm.n)
        if plan is not None:
            point = plan.at(context.get_time())
            q, v = point.q, point.v
        output.SetFromVector(np.concatenate([q, v]))

    def _write_status(self, context: Context, output: Value) -> None:
        plan, status = self._timed(context), ExecutionStatus()
        if plan is not None:
            t = context.get_time()
            measured = self._measured.Eval(context)[: self.arm.n]
            ended = arrival(plan, t, self.arm.pose(measured), self.tolerances)
            status = ended or ExecutionStatus(Phase.RUNNING, plan.at(t).segment)
        output.set_value(status)

    def _write_progress(self, context: Context, output: BasicVector) -> None:
        plan = self._timed(context)
        output.SetFromVector([0.0 if plan is None else min(context.get_time() / plan.duration, 1)])
