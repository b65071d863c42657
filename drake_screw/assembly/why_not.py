"""Why there is no plan for a task instance, in words."""

from __future__ import annotations

from collections.abc import Sequence

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Cause, Outcomes
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.typing import Array


def why_not(
    outcomes: Outcomes,
    demonstrations: Sequence[Demonstration],
    X_WO: Array,
    q_start: Array,
    planner: CollisionFreePlanner,
) -> str:
    """Why no demonstration solves an instance, by the best attempt.

    Args:
        outcomes: (D,).
        demonstrations: D of them.
        X_WO: (k, 4, 4).
        q_start: (n,) rad or m.
        planner: that gave the outcomes.
    """
    best = int(outcomes.best_attempt)
    cause, segment = Cause(int(outcomes.cause[best])), int(outcomes.segment[best]) + 1
    chosen, names = demonstrations[best], planner.planner.chain.joint_names
    match cause:
        case Cause.JOINT_LIMIT:
            joint = names[int(outcomes.joint[best])]
            return f"with {chosen.name}, {joint} meets its limit in segment {segment}"
        case Cause.COLLISION:
            variant = int(outcomes.variant[best])
            plan = planner.planner.plan(chosen, X_WO, q_start, variant)
            return f"with {chosen.name}, {planner.checker.explain(plan, X_WO)}"
        case _:
            return f"with {chosen.name}, segment {segment} is out of reach"
