"""What a scenario allows and is likely to regret."""

from __future__ import annotations

from drake_screw.assembly.following import cannot_follow, free_roll
from drake_screw.robot import Arm
from drake_screw.scenario.schema import Scenario
from drake_screw.typing import Array

SHORT = 1.0
"""m. A slide with less of a range soon comes to its end, where a metre counts as a radian."""


def hints(scenario: Scenario, arm: Arm, start: Array) -> tuple[str, ...]:
    """Sentences on what is left free, or likely to go wrong, and what to do about it.

    Args:
        scenario: says what is followed.
        arm: to follow it.
        start: (n,) rad or m, where its plans start.
    """
    free, lacks = free_roll(scenario), cannot_follow(scenario, arm, start)
    return (*([free] if free else []), *lacks, *_short_slides(scenario, arm))


def _short_slides(scenario: Scenario, arm: Arm) -> tuple[str, ...]:
    if arm.n <= 6 or scenario.planner.redundancy != "least_norm":
        return ()
    ranges = zip(arm.joint_names, arm.slides, arm.upper - arm.lower, strict=True)
    short = [name for name, slides, extent in ranges if slides and extent < SHORT]
    if not short:
        return ()
    return (
        f"{', '.join(short)}: where joints move as little as can be, a metre of a slide counts as "
        "a radian, so that a short one is soon at its end; planner.redundancy: away_from_limits "
        "keeps it from there",
    )
