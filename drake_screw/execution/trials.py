"""Trials: instances that were to be executed, and what came of them, as a table and in sum."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from drake_screw.errors import counted
from drake_screw.execution.allowed import said
from drake_screw.execution.report import Deviation, ExecutionReport
from drake_screw.execution.simulate import Execution
from drake_screw.execution.status import Phase
from drake_screw.tasks import WorkArea, column_names
from drake_screw.typing import Array


@dataclass(frozen=True, eq=False)
class Trial:
    """One instance that was to be executed.

    Attributes:
        region: it lies in.
        coordinates: (k, c) m and rad, in the order of `WorkArea.axes`.
        demonstration: the name of the one it was planned with; empty if none gives a plan.
        reason: why there is no plan; empty if there is one.
        turned: rad, by which symmetric objects are turned in the plan, by their names.
        execution: what was done; None without a plan.
        arm: the name of the arm that moved; empty where the robot has no other, or without a plan.
    """

    region: int
    coordinates: Array
    demonstration: str
    reason: str
    execution: Execution | None
    turned: tuple[tuple[str, float], ...] = ()
    arm: str = ""

    @property
    def report(self) -> ExecutionReport | None:
        """Of the execution."""
        return None if self.execution is None else self.execution.report


def trials_csv(trials: Sequence[Trial], area: WorkArea) -> str:
    """A row for each trial; lengths in m (mm where the name says so), angles in rad (mrad).

    Lists in a cell are separated by semicolons: deviations from the screws have an entry for each
    segment, contacts name both bodies. Where the robot has several arms, one of the columns says
    which of them moved.
    """
    several = any(trial.arm for trial in trials)
    header = [
        "region",
        *column_names(area),
        "demonstration",
        *(["arm"] if several else []),
        "turned_rad",
        "status",
        "segment",
        "reason",
        *_MEASURES,
    ]
    file = io.StringIO()
    rows = csv.writer(file, lineterminator="\n")
    rows.writerow(header)
    for trial in trials:
        place = [f"{trial.coordinates[i, j]:.9g}" for i, j in area.columns]
        report = trial.report
        if report is None:
            said = ["no plan", "", trial.reason, *([""] * len(_MEASURES))]
        else:
            segment = "" if report.status.segment is None else str(report.status.segment + 1)
            said = [report.status.phase.value, segment, report.status.reason]
            said += [measure(report) for measure in _MEASURES.values()]
        turned = ";".join(f"{body} {angle:.4f}" for body, angle in trial.turned)
        planned = [trial.demonstration, *([trial.arm] if several else []), turned]
        rows.writerow([trial.region, *place, *planned, *said])
    return file.getvalue()


_MEASURES: dict[str, Callable[[ExecutionReport], str]] = {
    "planned_s": lambda r: f"{r.planned:.3f}",
    "time_s": lambda r: f"{r.time:.3f}",
    "worst_margin_rad": lambda r: f"{r.worst_margin:.5f}" if r.worst_unit == "rad" else "",
    "worst_margin_m": lambda r: f"{r.worst_margin:.5f}" if r.worst_unit == "m" else "",
    "worst_joint": lambda r: r.worst_joint,
    "outside_limits": lambda r: ";".join(r.outside),
    "velocity_over_limit": lambda r: f"{r.velocity:.4f}",
    "tracking_mm": lambda r: f"{1e3 * r.tracking.position:.3f}",
    "tracking_mrad": lambda r: f"{1e3 * r.tracking.rotation:.3f}",
    "tracking_rms_mm": lambda r: f"{1e3 * r.tracking.position_rms:.3f}",
    "tracking_rms_mrad": lambda r: f"{1e3 * r.tracking.rotation_rms:.3f}",
    "screw_mm": lambda r: ";".join(f"{1e3 * d.position:.3f}" for d in r.screws),
    "screw_mrad": lambda r: ";".join(f"{1e3 * d.rotation:.3f}" for d in r.screws),
    "contacts": lambda r: ";".join(f"{' - '.join(c.bodies)} {c.force:.0f} N" for c in r.contacts),
    "moved_mm": lambda r: ";".join(f"{o.object} {1e3 * o.position:.3f}" for o in r.moved),
    "moved_mrad": lambda r: ";".join(f"{o.object} {1e3 * o.rotation:.3f}" for o in r.moved),
    "final_mm": lambda r: f"{1e3 * r.final.position:.3f}",
    "final_mrad": lambda r: f"{1e3 * r.final.rotation:.3f}",
}


@dataclass(frozen=True)
class Remark:
    """What is to be said of a trial: its region, where its objects are (m, m, rad), the words."""

    region: int
    x_y_yaw: tuple[tuple[float, float, float], ...]
    text: str

    def __str__(self) -> str:
        where = ", ".join(f"x {x:.3f} y {y:.3f}" for x, y, _ in self.x_y_yaw)
        return f"region {self.region}, {where}: {self.text}"


@dataclass(frozen=True)
class Measures:
    """The worst of some executions.

    Attributes:
        joint_margin: the least, in `unit`; negative outside the limits.
        joint, unit: which joint had it, and "rad" or "m".
        velocity: greatest joint velocity, over its limit.
        tracking, screws, final: greatest of each kind, see `ExecutionReport`.
        moved: m and rad, greatest of any object; None where objects are locked in place.
        time: s, least, greatest and mean.
    """

    joint_margin: float
    joint: str
    unit: str
    velocity: float
    tracking: Deviation
    screws: Deviation
    final: Deviation
    moved: tuple[float, float] | None
    time: tuple[float, float, float]


@dataclass(frozen=True)
class TrialSummary:
    """What trials show.

    Attributes:
        instances: how many there were to execute.
        executed: how many have a plan, which was simulated.
        done: how many of those ended as planned.
        flawless: how many of those besides kept all limits and what else is allowed.
        outside_limits, over_velocity, with_contact: how many left joint limits, were too fast,
            touched something.
        off_the_way, pushed: how many were too far off, and pushed an object too far.
        worst: of all that were executed; None if none was.
        arms: how many executions each of several arms moved in, by its name; {} of a single one.
        without_plan: why there is none.
        flawed: what went wrong.
    """

    instances: int
    executed: int
    done: int
    flawless: int
    outside_limits: int
    over_velocity: int
    with_contact: int
    off_the_way: int
    pushed: int
    worst: Measures | None
    arms: Mapping[str, int]
    without_plan: tuple[Remark, ...]
    flawed: tuple[Remark, ...]

    def __str__(self) -> str:
        by = ", ".join(f"{count} by arm {name}" for name, count in self.arms.items())
        each = f": {by}" if by else ""
        lines = [f"{counted(self.instances, 'instance')}, {self.executed} executed{each}"]
        lines += [f"  {remark}" for remark in self.without_plan]
        if self.worst is not None:
            least, most, mean = self.worst.time
            lines += [
                f"done                       {self.done} of {self.executed}",
                f"outside joint limits       {self.outside_limits}",
                f"over a velocity limit      {self.over_velocity}",
                f"with contact               {self.with_contact}",
                f"too far off their way      {self.off_the_way}",
                *self._pushed(self.worst),
                f"least joint margin         {self.worst.joint_margin:.4f} {self.worst.unit}",
                f"greatest joint velocity    {self.worst.velocity:.0%} of its limit",
                f"tracking error (set point) {_at_most(self.worst.tracking)}",
                f"path error (screw)         {_at_most(self.worst.screws)}",
                f"error at the last pose     {_at_most(self.worst.final)}",
                f"time                       {least:.1f} to {most:.1f}, mean {mean:.1f} s",
            ]
        lines += [f"  {remark}" for remark in self.flawed]
        if not self.flawless:
            lines.append("nothing was executed as planned")
        return "\n".join(lines)

    def _pushed(self, worst: Measures) -> list[str]:
        if worst.moved is None:
            return []
        far, turned = worst.moved
        return [
            f"pushed an object           {self.pushed}",
            f"objects moved              at most {1e3 * far:.2f} mm, {1e3 * turned:.2f} mrad",
        ]


def summarize(trials: Sequence[Trial]) -> TrialSummary:
    """Count and name what trials show."""
    reports = [trial.report for trial in trials if trial.report is not None]
    without = tuple(
        _remark(trial, f"no plan: {trial.reason}") for trial in trials if trial.execution is None
    )
    flawed = tuple(
        _remark(trial, said(trial.report.flaws))
        for trial in trials
        if trial.report is not None and not trial.report.flawless
    )
    return TrialSummary(
        instances=len(trials),
        executed=len(reports),
        done=sum(report.status.phase is Phase.DONE for report in reports),
        flawless=sum(report.flawless for report in reports),
        outside_limits=sum(bool(report.outside) for report in reports),
        over_velocity=sum(report.velocity > 1.0 for report in reports),
        with_contact=sum(bool(report.contacts) for report in reports),
        off_the_way=sum(report.off for report in reports),
        pushed=sum(bool(report.pushed) for report in reports),
        worst=_measures(reports) if reports else None,
        arms=dict(sorted(Counter(trial.arm for trial in trials if trial.arm).items())),
        without_plan=without,
        flawed=flawed,
    )


def _remark(trial: Trial, text: str) -> Remark:
    places = tuple((x, y, yaw) for x, y, yaw, *_ in trial.coordinates.tolist())
    return Remark(trial.region, places, text)


def _measures(reports: Sequence[ExecutionReport]) -> Measures:
    times = [report.time for report in reports]
    tightest = min(reports, key=lambda report: report.worst_compared)
    return Measures(
        joint_margin=tightest.worst_margin,
        joint=tightest.worst_joint,
        unit=tightest.worst_unit,
        velocity=max(report.velocity for report in reports),
        tracking=_greatest([report.tracking for report in reports]),
        screws=_greatest([screw for report in reports for screw in report.screws]),
        final=_greatest([report.final for report in reports]),
        moved=_farthest(reports),
        time=(min(times), max(times), float(np.mean(times))),
    )


def _farthest(reports: Sequence[ExecutionReport]) -> tuple[float, float] | None:
    moved = [(o.position, o.rotation) for report in reports for o in report.moved]
    if not moved:
        return None
    far, turned = np.max(moved, axis=0).tolist()
    return far, turned


def _greatest(deviations: Sequence[Deviation]) -> Deviation:
    return Deviation(
        **{
            field.name: max((getattr(d, field.name) for d in deviations), default=0.0)
            for field in fields(Deviation)
        }
    )


def _at_most(deviation: Deviation) -> str:
    return f"at most {1e3 * deviation.position:.2f} mm, {1e3 * deviation.rotation:.2f} mrad"
