"""Trials: instances that were to be executed, and what came of them, as a table and in words."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from drake_screw.execution.report import ExecutionReport
from drake_screw.execution.simulate import Execution
from drake_screw.execution.status import Phase
from drake_screw.tasks import AXES, WorkArea
from drake_screw.typing import Array


@dataclass(frozen=True, eq=False)
class Trial:
    """One instance that was to be executed.

    Attributes:
        region: it lies in.
        x_y_yaw: (k, 3) m, m, rad.
        demonstration: the name of the one it was planned with; empty if none gives a plan.
        reason: why there is no plan; empty if there is one.
        execution: what was done; None without a plan.
    """

    region: int
    x_y_yaw: Array
    demonstration: str
    reason: str
    execution: Execution | None

    @property
    def report(self) -> ExecutionReport | None:
        """Of the execution."""
        return None if self.execution is None else self.execution.report


def trials_csv(trials: Sequence[Trial], area: WorkArea) -> str:
    """A row for each trial; lengths in m (mm where the name says so), angles in rad (mrad).

    Lists in a cell are separated by semicolons: deviations from the screws have an entry for each
    segment, contacts name both bodies.
    """
    places = [f"{o.name}_{axis}" for o in area.objects for axis in AXES]
    header = ["region", *places, "demonstration", "status", "segment", "reason", *_MEASURES]
    file = io.StringIO()
    rows = csv.writer(file, lineterminator="\n")
    rows.writerow(header)
    for trial in trials:
        place = [f"{value:.6g}" for value in trial.x_y_yaw.ravel()]
        report = trial.report
        if report is None:
            said = ["no plan", "", trial.reason, *([""] * len(_MEASURES))]
        else:
            segment = "" if report.status.segment is None else str(report.status.segment + 1)
            said = [report.status.phase.value, segment, report.status.reason]
            said += [measure(report) for measure in _MEASURES.values()]
        rows.writerow([trial.region, *place, trial.demonstration, *said])
    return file.getvalue()


_MEASURES: dict[str, Callable[[ExecutionReport], str]] = {
    "planned_s": lambda r: f"{r.planned:.3f}",
    "time_s": lambda r: f"{r.time:.3f}",
    "worst_margin_rad": lambda r: f"{r.worst_margin:.5f}",
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
    "final_mm": lambda r: f"{1e3 * r.final.position:.3f}",
    "final_mrad": lambda r: f"{1e3 * r.final.rotation:.3f}",
}


def summary(trials: Sequence[Trial]) -> str:
    """What trials show, for people."""
    reports = [trial.report for trial in trials if trial.report is not None]
    lines = [f"{len(trials)} instances, {len(reports)} executed"]
    lines += [
        f"  region {trial.region}, {_where(trial)}: no plan: {trial.reason}"
        for trial in trials
        if trial.execution is None
    ]
    if not reports:
        return "\n".join(lines)
    done = sum(report.status.phase is Phase.DONE for report in reports)
    lines += [
        f"done                       {done} of {len(reports)}",
        f"outside joint limits       {sum(bool(r.outside) for r in reports)}",
        f"over a velocity limit      {sum(r.velocity > 1.0 for r in reports)}",
        f"with contact               {sum(bool(r.contacts) for r in reports)}",
        f"least joint margin         {min(r.worst_margin for r in reports):.4f} rad",
        f"greatest joint velocity    {max(r.velocity for r in reports):.0%} of its limit",
        "hand from its set point    " + _worst([r.tracking for r in reports]),
        "hand from its screw        " + _worst([d for r in reports for d in r.screws]),
        "hand from the last pose    " + _worst([r.final for r in reports]),
        f"time                       {_span([r.time for r in reports])} s",
    ]
    for trial in trials:
        report = trial.report
        if report is not None and not report.flawless:
            found = [str(report.status), *map(str, report.contacts)]
            found += [f"{name} leaves its limits" for name in report.outside]
            lines.append(f"  region {trial.region}, {_where(trial)}: {'; '.join(found)}")
    return "\n".join(lines)


def _worst(deviations: Sequence) -> str:
    position = max(d.position for d in deviations)
    rotation = max(d.rotation for d in deviations)
    return f"at most {1e3 * position:.2f} mm, {1e3 * rotation:.2f} mrad"


def _span(values: Sequence[float]) -> str:
    return f"{min(values):.1f} to {max(values):.1f}, mean {np.mean(values):.1f}"


def _where(trial: Trial) -> str:
    return ", ".join(f"x {x:.3f} y {y:.3f}" for x, y, _ in trial.x_y_yaw)
