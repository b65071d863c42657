"""How often the batch planner agrees: with fine steps, and with outcomes on record."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from fine_steps import fine_outcomes
from task import Task

from drake_screw.planning import BatchPlanner, Outcomes, ReferencePlanner
from drake_screw.typing import Array

SLACK = 0.005  # rad, of the joint limits that may explain a disagreement
NEAR_SINGULAR = 20.0  # |dq/ds| per unit of motion that only the edge of reach explains


def recorded_outcomes(task: Task, file: Path, outcomes: Callable[[Array], Outcomes]) -> dict:
    """Agreement with outcomes on record: x, y, and for each demonstration s:j, s:n or 0:0."""
    table = np.genfromtxt(file, delimiter=",", dtype=str)
    column = {name: i for i, name in enumerate(table[0])}
    x_y = table[1:, :2].astype(float)
    X_WO = task.regions.area.X_WO(np.insert(x_y, 2, 0.0, axis=1)[:, None])
    ours = outcomes(X_WO)
    theirs = table[1:, [column[d.name] for d in task.demonstrations]]
    segment = np.char.partition(theirs, ":")[..., 0].astype(int) - 1
    failed = ~ours.success & (segment >= 0)
    return {
        "outcomes": theirs.size,
        "agree_on_success": float((ours.success == (segment < 0)).mean()),
        "agree_on_failing_segment": float((ours.segment == segment)[failed].mean()),
    }


def agreement(task: Task, count: int, verify: int, seed: int) -> dict[str, Any]:
    """Success and failure on random pairs, next to fine steps."""
    rng, D = np.random.default_rng(seed), len(task.demonstrations)
    X_WO, which = task.instances(count, rng), rng.integers(0, D, count)
    guides = [task.demonstrations[d].transfer(X) for d, X in zip(which, X_WO, strict=True)]
    chain = task.arm.screw_chain()
    fine = fine_outcomes(chain, task.q_start, guides)
    ours = BatchPlanner(chain).all_outcomes(task.demonstrations, X_WO, task.q_start)
    ours = ours[np.arange(count), which]
    reference = ReferencePlanner(task.arm)
    checks = [reference.plan(task.q_start, guides[i]).success for i in range(min(verify, count))]
    agree = ours.success == (fine.cause == 0)
    both = ~ours.success & (fine.cause != 0)
    odd = np.flatnonzero(~agree)
    again: dict[str, Array] = {}
    if len(odd):
        some = [guides[i] for i in odd]
        for name, options in {
            "limit": {"slack": SLACK},
            "limit ": {"slack": -SLACK},
            "step": {"step": 0.01, "joint_step": 0.002},
        }.items():
            again[name] = fine_outcomes(chain, task.q_start, some, **options).cause == 0
    disagreements = []
    for k, i in enumerate(odd):
        why = [name.strip() for name, success in again.items() if success[k] == ours.success[i]]
        if fine.rate[i] > NEAR_SINGULAR:
            why.append("reach")
        disagreements.append(
            {
                "batch": str(ours.codes()[i]),
                "fine": _code(fine.cause[i], fine.segment[i], fine.joint[i]),
                "least_margin": float(fine.margin[i]),
                "largest_rate": float(fine.rate[i]),
                "explained_by": sorted(set(why)),
            }
        )
    return {
        "pairs": count,
        "agree_on_success": float(agree.mean()),
        "agree_on_cause": float((ours.cause == fine.cause).mean()),
        "agree_on_failing_segment": float((ours.segment == fine.segment)[both].mean()),
        "verified": len(checks),
        "verified_agree": int(np.sum(np.array(checks) == (fine.cause[: len(checks)] == 0))),
        "disagreements": disagreements,
    }


def _code(cause: int, segment: int, joint: int) -> str:
    return "0:0" if cause == 0 else f"{segment + 1}:{joint + 1 if cause == 1 else 'n'}"
