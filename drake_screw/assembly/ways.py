"""The arms that an instance can be planned for, and why none of them can do it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.assembly.arm_setup import ArmSetup
from drake_screw.assembly.why_not import why_not
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import ScenarioError
from drake_screw.planning import Outcomes
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.robot import Arm
from drake_screw.typing import Array


class Way(NamedTuple):
    """An arm to plan for.

    Attributes:
        planner: for limits, reach and collisions.
        arm: that is planned for.
        q_start: (n,) rad or m.
        name: of the arm where there are several.
    """

    planner: CollisionFreePlanner
    arm: Arm
    q_start: Array
    name: str | None = None


def ways(
    arms: Sequence[ArmSetup], start: ArrayLike | Mapping[str, ArrayLike] | None = None
) -> tuple[Way, ...]:
    """The arms to plan for, from where they are.

    Args:
        arms: of a scenario.
        start: (n,) rad or m, where the only arm is, or {name: (n,)} of one of several; where the
            scenario starts them if None.

    Raises:
        ScenarioError: it is not said which of several arms is there, or no arm has that name.
    """
    if start is None:
        return tuple(
            Way(one.careful_planner, one.arm, one.start, one.name if one.among_several else None)
            for one in arms
        )
    if not isinstance(start, Mapping):
        if arms[0].among_several:
            raise ScenarioError(
                "a start of one arm, where the robot has several",
                remedy=f"Say of which: start={{'{arms[0].name}': [...]}}; the others rest.",
            )
        return (ways(arms)[0]._replace(q_start=np.asarray(start, dtype=float)),)
    known = {one.name: way for one, way in zip(arms, ways(arms), strict=True)}
    if len(start) != 1 or not set(start) <= set(known):
        raise ScenarioError(
            f"a start of {', '.join(map(str, start)) or 'no arm'}, expected that of one arm: the "
            "others rest where the scenario starts them",
            remedy=f"Arms: {', '.join(known)}.",
        )
    ((name, q),) = start.items()
    return (known[name]._replace(q_start=np.asarray(q, dtype=float)),)


def why_none(ways: Sequence[Way], demonstrations: Sequence[Demonstration], X_WO: Array) -> str:
    """Why no demonstration gives a plan with any arm at an instance X_WO (k, 4, 4), in words."""
    whys = []
    for way in ways:
        outcomes = way.planner.all_outcomes(demonstrations, X_WO[None], way.q_start)[0]
        why = why_not(outcomes, demonstrations, X_WO, way.q_start, way.planner)
        whys.append(why if way.name is None else f"{way.name}: {why}")
    return "; ".join(whys)


def why_failed(
    arms: Sequence[ArmSetup],
    outcomes: Outcomes,
    demonstrations: Sequence[Demonstration],
    X_WO: Array,
) -> str:
    """Why no demonstration solves an instance X_WO (k, 4, 4), by the best attempt of (D,)."""
    one = arms[int(outcomes.best.arm)]
    why = why_not(outcomes, demonstrations, X_WO, one.start, one.careful_planner)
    return f"{one.name}: {why}" if one.among_several else why
