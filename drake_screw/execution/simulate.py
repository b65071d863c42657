"""Execute one plan in a simulated station."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, EventStatus

from drake_screw.execution.monitoring import failed
from drake_screw.execution.report import Contact, ExecutionReport, make_report
from drake_screw.execution.station import Station
from drake_screw.execution.timing import TimedPlan
from drake_screw.robot.names import shown_name
from drake_screw.typing import Array

PATIENCE = 1.0
"""s beyond the plan's time and the follower's own patience, after which a simulation is stopped."""


@dataclass(frozen=True, eq=False)
class Execution:
    """A simulated execution.

    Attributes:
        report: what it did.
        t: (m,) s.
        q, v: (m, n) measured joint positions and velocities.
        q_desired: (m, n) as commanded.
    """

    report: ExecutionReport
    t: Array
    q: Array
    v: Array
    q_desired: Array


def simulate(
    station: Station, plan: TimedPlan, X_WO: ArrayLike, q_start: ArrayLike | None = None
) -> Execution:
    """Execute a plan until it is done or has failed.

    Args:
        station: to simulate.
        plan: to execute.
        X_WO: (k, 4, 4) where the objects are.
        q_start: (n,) rad, where the arm is; where the plan starts if None.
    """
    if q_start is None:
        q_start = plan.segments[0].q[0] if plan.segments else station.parked[station.columns]
    root = station.context(q_start, X_WO)
    station.diagram.GetInputPort("plan").FixValue(root, Value[object](plan))
    watch = _Watch(station, plan)
    simulator = Simulator(station.diagram, root)
    simulator.set_monitor(watch)
    simulator.Initialize()
    simulator.AdvanceTo(plan.duration + station.follower.tolerances.settling + PATIENCE)
    status = station.diagram.GetOutputPort("status").Eval(root)
    if not status.ended:
        status = failed(status.segment, "it never ended")
    measured, desired = station.measured.FindLog(root), station.desired.FindLog(root)
    n, t = station.arm.n, measured.sample_times()
    q, v = measured.data()[:n].T, measured.data()[n:].T
    report = make_report(plan, station.arm, t, q, v, status, tuple(watch.contacts.values()))
    return Execution(report, t, q, v, desired.data()[:n].T)


class _Watch:
    """Looks at every step: remembers contacts, and stops the simulation when the plan is over."""

    def __init__(self, station: Station, plan: TimedPlan) -> None:
        self.contacts: dict[tuple[str, str], Contact] = {}
        self._station, self._plan = station, plan
        self._status = station.diagram.GetOutputPort("status")
        self._results = station.plant.get_contact_results_output_port()

    def __call__(self, root: Context) -> EventStatus:
        plant = self._station.plant
        results = self._results.Eval(plant.GetMyContextFromRoot(root))
        for i in range(results.num_point_pair_contacts()):
            info = results.point_pair_contact_info(i)
            a, b = (shown_name(plant.get_body(k)) for k in (info.bodyA_index(), info.bodyB_index()))
            self._touched((a, b), root.get_time(), float(np.linalg.norm(info.contact_force())))
        status = self._status.Eval(root)
        if status.ended:
            return EventStatus.ReachedTermination(self._station.diagram, str(status))
        return EventStatus.DidNothing()

    def _touched(self, bodies: tuple[str, str], time: float, force: float) -> None:
        known = self.contacts.get(bodies)
        if known is None:
            segment = self._plan.at(time).segment if self._plan.segments else 0
            self.contacts[bodies] = Contact(bodies, time, segment, force)
        elif force > known.force:
            self.contacts[bodies] = Contact(bodies, known.time, known.segment, force)
