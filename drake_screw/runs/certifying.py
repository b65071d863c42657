"""From the end of a run to what it states."""

from __future__ import annotations

from typing import Any

import numpy as np

from drake_screw.acquisition import Finished, Status
from drake_screw.assembly.following import free_roll
from drake_screw.assembly.freedoms import freedoms, tool_touches
from drake_screw.assembly.setup import Setup
from drake_screw.bandits.spending import attempt_delta
from drake_screw.runs.certificate import Certificate
from drake_screw.runs.execution_terms import ExecutionTerms


def certificate(
    setup: Setup,
    finished: Finished,
    *,
    attempt: int = 1,
    instances: int = 0,
    led_around: bool | None = None,
) -> Certificate:
    """What a finished run states.

    Args:
        setup: of the run.
        finished: its last event.
        attempt: 1 + the number of rounds before the last whose verdict was `attempted`.
        instances: drawn in all rounds.
        led_around: as the certificate has it.
    """
    verdict, goal, bandit = finished.verdict, setup.scenario.coverage, setup.bandit
    executed = goal.success == "execution"
    shown: dict[str, Any] = {}
    if verdict is not None:
        spent = bool(getattr(bandit, "spend", True))
        shown = {
            "claim": verdict.claim,
            "coverage": goal.beta if verdict.certified else verdict.coverage,
            "confidence": 1.0 - goal.delta,
            "confidence_holds_for": "the whole run" if spent else "each round",
            "fresh_instances": verdict.total_samples,
            "instances_in_all_rounds": instances,
            "delta_spent_over_attempts": spent,
        }
        if setup.tree is None:
            share = attempt_delta(goal.delta, attempt, spend=spent)
            shown |= {"attempt": attempt, "delta_of_attempt": share}
    return Certificate(
        certified=finished.status is Status.CERTIFIED,
        demonstrations=len(finished.demonstrations),
        regions=setup.regions.K if verdict is None else len(verdict.samples),
        beta=goal.beta,
        epsilon=goal.epsilon,
        delta=goal.delta,
        collisions_checked=setup.scenario.planner.collision,
        clearance=setup.scenario.planner.clearance,
        joint_margin=setup.scenario.planner.joint_margin,
        slide_margin=setup.scenario.planner.slide_margin,
        ignored_collisions=setup.scenario.robot.ignore_collisions,
        arms=tuple(arm.name for arm in setup.scenario.robot.arms or ()),
        incomplete_shapes=setup.workcell.model.incomplete,
        tool_touches=tool_touches(setup.scenario) or None,
        turned_any_way=tuple(o.name for o in setup.scenario.objects if o.orientation) or None,
        apart=setup.scenario.apart or None,
        strategy=bandit.name,
        guarantee=bandit.guarantee,
        freedoms=freedoms(setup.scenario),
        free_roll=free_roll(setup.scenario),
        approach=setup.scenario.planner.approach,
        led_around=led_around,
        success=goal.success,
        execution=ExecutionTerms.of(setup.scenario.execution) if executed else None,
        kept_position=_largest(finished, "position"),
        kept_rotation=_largest(finished, "rotation"),
        reason=finished.reason,
        **shown,
    )


def _largest(finished: Finished, measure: str) -> float | None:
    found = [getattr(f, measure) for d in finished.demonstrations for f in d.fidelity]
    return max(found) if found and np.isfinite(found).all() else None
