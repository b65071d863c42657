"""Why there is no plan for a task instance, in words."""

from __future__ import annotations

from collections.abc import Sequence

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Cause, Outcomes
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.planning.touching import cut_short, touch_words, touching_bodies
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
    cause, where = Cause(int(outcomes.cause[best])), f"segment {int(outcomes.segment[best]) + 1}"
    chosen, names = demonstrations[best], planner.planner.chain.joint_names
    match cause:
        case Cause.JOINT_LIMIT:
            joint = names[int(outcomes.joint[best])]
            return f"with {chosen.name}, {joint} meets its limit in {where}"
        case Cause.COLLISION:
            found, clearance = outcomes[best], planner.checker.swept.clearance
            plan = planner.planner.plan(chosen, X_WO, q_start, int(found.variant))
            q, workcell = cut_short(plan, found).q[-1], planner.checker.workcell
            bodies = touching_bodies(found, workcell, q, X_WO, clearance)
            touches = ", ".join(touch_words(pair, clearance) for pair in bodies)
            return f"with {chosen.name}, {touches or 'the arm touches something'} in {where}"
        case _:
            return f"with {chosen.name}, {where} is out of reach"
