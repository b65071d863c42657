"""Attempts as numbers: everything that the inspector shows, as JSON and CSV."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Any

import numpy as np

from drake_screw.planning import Cause
from drake_screw.tasks import WorkArea
from drake_screw.visualization.attempt import Attempt, headline


def attempts_json(attempts: Sequence[Attempt], facts: Mapping[str, Any], area: WorkArea) -> str:
    """Attempts at one instance, with their screws; counted from 0 but for `round`.

    Args:
        attempts: at least one.
        facts: what else to record.
        area: names the objects.
    """
    X_WO = attempts[0].X_WO if attempts else np.empty((0, 4, 4))
    names = [o.name for o in area.objects]
    record = {
        **facts,
        "units": {"length": "m", "angle": "rad"},
        "objects": {name: X.tolist() for name, X in zip(names, X_WO, strict=False)},
        "attempts": [attempt_record(tried) for tried in attempts],
    }
    return json.dumps(record, indent=2) + "\n"


def attempt_record(attempt: Attempt) -> dict[str, Any]:
    """One attempt in plain data."""
    screw, outcome, arm = attempt.screws, attempt.plan.outcome, attempt.arm
    joint, margin = attempt.tightest
    at = attempt.failed_joint
    return {
        "demonstration": attempt.number,
        "name": attempt.demonstration.name,
        **({} if attempt.arm_name is None else {"arm": attempt.arm_name}),
        "outcome": Cause(int(outcome.cause)).name.lower(),
        "words": headline(attempt),
        "segment": attempt.failed_segment,
        "fraction": None if attempt.plan.success else float(outcome.fraction),
        "joint": None if at is None else arm.joint_names[at],
        "unreachable": _unreachable(attempt),
        "touching": [list(pair) for pair in attempt.bodies],
        "turned": {turn.body: turn.angle for turn in attempt.turned},
        "least_margin": {"joint": arm.joint_names[joint], "margin": _of(margin)},
        "segments": [
            {
                "status": status,
                "kind": "approach" if i == 0 and attempt.plan.approach else "screw",
                "axis": screw.axis[i].tolist(),
                "point": screw.point[i].tolist(),
                "angle": float(screw.angle[i]),
                "translation": float(screw.translation[i]),
                "X_WE_end": attempt.guides[i].tolist(),
            }
            for i, status in enumerate(attempt.status)
        ],
        "end": {
            name: {"angle": float(q), "lower": _of(low), "upper": _of(high), "margin": _of(m)}
            for name, q, low, high, m in zip(
                arm.joint_names,
                attempt.plan.q[-1],
                arm.lower,
                arm.upper,
                attempt.margin[-1],
                strict=True,
            )
        },
    }


def _unreachable(attempt: Attempt) -> dict[str, Any] | None:
    """Why the end effector got no farther; None where that is not how the attempt ended."""
    found = attempt.unreachable
    if found is None:
        return None
    wrist = found.wrist
    return {
        "missing_travel": found.travel,
        "missing_turn": found.turn,
        "least_singular_value": float(found.singular[-1]),
        "motion_along_the_screw": _of(found.gain[-1]),
        "shoulder_to_wrist": None if wrist is None else float(found.distance[-1]),
        "at_the_guiding_pose": _of(found.needed),
        "reach": None if wrist is None else [wrist.least, wrist.most],
    }


def _of(value: float) -> float | None:
    """A number for JSON, which knows no infinity: None of a joint without limits."""
    return float(value) if isfinite(value) else None


def attempts_csv(attempts: Sequence[Attempt]) -> str:
    """The plans of several attempts: a row for each point, with angles and margins."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    if attempts:
        names = attempts[0].arm.joint_names
        margins = [f"{name}_margin" for name in names]
        writer.writerow(["demonstration", "segment", "s", *names, *margins])
    for tried in attempts:
        plan = tried.plan
        for segment, s, q, margin in zip(plan.segment, plan.s, plan.q, tried.margin, strict=True):
            values = [f"{v:.6f}" for v in (s, *q, *margin)]
            writer.writerow([tried.number, int(segment), *values])
    return text.getvalue()
