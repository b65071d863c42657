"""Execute one plan in a simulated station."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from pydrake.common.value import Value
from pydrake.geometry import GeometryId
from pydrake.multibody.tree import RigidBody
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, EventStatus

from drake_screw.execution.allowed import Allowed
from drake_screw.execution.free_objects import displacements, poses
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
        q, v: (m, n) joint positions and velocities, as they are.
        q_desired: (m, n) as commanded.
        X_WO: (m, k, 4, 4) where the objects are; None where they are locked in place.
    """

    report: ExecutionReport
    t: Array
    q: Array
    v: Array
    q_desired: Array
    X_WO: Array | None = None

    def thinned(self, every: int) -> Execution:
        """The same with one of so many samples, and the last one."""
        kept = np.append(np.arange(0, len(self.t) - 1, every), len(self.t) - 1)
        return replace(
            self,
            t=self.t[kept],
            q=self.q[kept],
            v=self.v[kept],
            q_desired=self.q_desired[kept],
            X_WO=None if self.X_WO is None else self.X_WO[kept],
        )


def simulate(
    station: Station,
    plan: TimedPlan,
    X_WO: ArrayLike,
    q_start: ArrayLike | None = None,
    *,
    joint_offset: ArrayLike | None = None,
    wanted: TimedPlan | None = None,
    allowed: Allowed | None = None,
) -> Execution:
    """Execute a plan until it is done or has failed.

    Objects that can be pushed settle first (`Station.settled`); how far they are moved counts from
    there. Where one does not rest where it stands, nothing is begun, and the execution has failed.

    Args:
        station: to simulate.
        plan: to execute.
        X_WO: (k, 4, 4) where the objects are.
        q_start: (n,) rad, where the arm's encoders say that it is; where the plan starts if None.
        joint_offset: (n,) rad or m, how far its joints are beyond what the encoders say; 0 if None.
        wanted: the plan along which the end effector ought to go, given where the objects really
            are; the same if None.
        allowed: what an execution may do and be flawless.
    """
    if q_start is None:
        q_start = plan.segments[0].q[0] if plan.segments else station.parked[station.columns]
    X_WO, unrest = station.settled(q_start, X_WO)
    if unrest:
        plan = wanted = TimedPlan(())
    root = station.context(q_start, X_WO, joint_offset)
    station.diagram.GetInputPort("plan").FixValue(root, Value[object](plan))
    watch = _Watch(station, plan)
    simulator = Simulator(station.diagram, root)
    simulator.set_monitor(watch)
    simulator.Initialize()
    simulator.AdvanceTo(plan.duration + station.follower.tolerances.settling + PATIENCE)
    status = station.diagram.GetOutputPort("status").Eval(root)
    if not status.ended:
        status = failed(status.segment, "it never ended")
    if unrest:
        status = failed(None, unrest)
    measured, desired = station.measured.FindLog(root), station.desired.FindLog(root)
    n, t = station.arm.n, measured.sample_times()
    q, v = measured.data()[:n].T, measured.data()[n:].T
    ways = None if station.moved is None else poses(_rows(station.moved.FindLog(root).data(), 7))
    moved = () if ways is None else displacements([o.name() for o in station.objects], t, ways)
    report = make_report(
        wanted or plan, station.arm, t, q, v, status,
        contacts=tuple(watch.contacts.values()), moved=moved, allowed=allowed,
    )  # fmt: skip
    return Execution(report, t, q, v, desired.data()[:n].T, ways)


def _rows(log: Array, width: int) -> Array:
    """(m, k, width) of a log (k width, m)."""
    return log.T.reshape(log.shape[1], -1, width)


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
            a, b = (plant.get_body(k) for k in (info.bodyA_index(), info.bodyB_index()))
            self._touch(a, b, root.get_time(), info.contact_force())
        for i in range(results.num_hydroelastic_contacts()):
            info = results.hydroelastic_contact_info(i)
            surface = info.contact_surface()
            a, b = (self._body(geometry) for geometry in (surface.id_M(), surface.id_N()))
            self._touch(a, b, root.get_time(), info.F_Ac_W().translational())
        status = self._status.Eval(root)
        if status.ended:
            return EventStatus.ReachedTermination(self._station.diagram, str(status))
        return EventStatus.DidNothing()

    def _body(self, geometry: GeometryId) -> RigidBody:
        inspector = self._station.scene_graph.model_inspector()
        return self._station.plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))

    def _touch(self, a: RigidBody, b: RigidBody, time: float, force: Array) -> None:
        """Remembers it if either is of the robot: what objects stand on is none of its contacts."""
        robot = self._station.robot
        if a.model_instance() in robot or b.model_instance() in robot:
            self._touched((shown_name(a), shown_name(b)), time, float(np.linalg.norm(force)))

    def _touched(self, bodies: tuple[str, str], time: float, force: float) -> None:
        known = self.contacts.get(bodies)
        if known is None:
            segment = self._plan.at(time).segment if self._plan.segments else 0
            self.contacts[bodies] = Contact(bodies, time, segment, force)
        elif force > known.force:
            self.contacts[bodies] = Contact(bodies, known.time, known.segment, force)
