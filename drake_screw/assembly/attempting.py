"""What a planner found at an instance, planned again to be looked at."""

from __future__ import annotations

from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Cause, Outcomes
from drake_screw.typing import Array
from drake_screw.visualization.attempt import Attempt, attempt, collided


def judged_attempt(
    setup: Setup, number: int, demonstration: Demonstration, X_WO: Array, outcome: Outcomes
) -> Attempt:
    """A demonstration tried at an instance, cut short at a collision.

    Args:
        setup: of the scenario.
        number: of the demonstration, from 0.
        demonstration: that was planned with.
        X_WO: (k, 4, 4) the objects of the instance.
        outcome: what `setup.planner` found, of shape ().
    """
    plan, one = setup.judged_plan(demonstration, X_WO, outcome), setup.arm_of(outcome)
    tried = attempt(one.arm, number, demonstration, X_WO, plan, setup.arm_name(outcome))
    if outcome.cause != Cause.COLLISION:
        return tried
    return collided(tried, outcome, one.workcell, setup.scenario.planner.clearance)
