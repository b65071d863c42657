"""A scenario for a robot, found step by step: arm, hand, table, start and work area."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from drake_screw.assembly.sanity import missing_shapes
from drake_screw.errors import ModelError, ScenarioError
from drake_screw.onboarding.area import (
    LARGEST,
    SMALLEST,
    WANTED,
    Survey,
    Verified,
    farthest_corner,
    survey,
    verify,
)
from drake_screw.onboarding.arms import FoundArm, choose_arm, find_arms
from drake_screw.onboarding.contacts import Pair, always_touching
from drake_screw.onboarding.end_effector import FoundEndEffector, find_end_effector
from drake_screw.onboarding.hand_ik import Range, range_of
from drake_screw.onboarding.parked import parked
from drake_screw.onboarding.reach import HOLDS, ReachMap, reach_map
from drake_screw.onboarding.reading import Robot, read_robot
from drake_screw.onboarding.rectangles import Rectangle, best_rectangle
from drake_screw.onboarding.start import Start, starts
from drake_screw.onboarding.table import best_height, stands_on_the_table, table_under
from drake_screw.onboarding.trial import Trial
from drake_screw.robot import ObjectConfig, RobotConfig, ScrewChain, TableConfig, build_workcell

BOWL = ObjectConfig("bowl", 0.08, 0.06)

SPACING = 0.05
"""m, of the places that are looked at."""

CLOSEST = 0.25
"""m, from the base's axis to the work area at least."""

COMFORTABLE = 0.62
"""Of the reach, where the middle of a work area is best."""

STARTS = 4
"""That are tried."""

ENOUGH = 0.85
"""Of the largest work area, with which the first start is taken that has it."""

NEARER = 0.1
"""m, by which a second demonstration is nearer than the farthest corner of what may be reached."""

Say = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Design:
    """What was found for a robot.

    Attributes:
        robot: its model.
        arm, arms: the arm that was taken, and all there are.
        why_this_arm: where there was a choice.
        hand: the end effector.
        task: "pouring" or "scooping".
        rest: joints outside the arm.
        touching: pairs of links that touch wherever the arm is, and may.
        on_the_table: whether the robot stands on the table.
        height_given: whether the table's height was asked for.
        table: under the work area.
        reach: shares of directions of approach that inverse kinematics finds.
        planned: places that are planned for from the start.
        start: configuration to start from.
        found: the work area.
        chain: the arm's kinematics.
        unseen: what is said of collision shapes that cannot be had.
        remarks: what a user should know.
    """

    robot: Robot
    arm: FoundArm
    arms: tuple[FoundArm, ...]
    why_this_arm: str | None
    hand: FoundEndEffector
    task: str
    rest: dict[str, float]
    touching: tuple[Pair, ...]
    on_the_table: bool
    height_given: bool
    table: TableConfig
    reach: ReachMap
    planned: Survey
    start: Start
    found: Verified
    chain: ScrewChain
    unseen: tuple[str, ...]
    remarks: tuple[str, ...]


def design(
    model: str | RobotConfig,
    *,
    wanted_arm: str | None = None,
    choose: Callable[[Sequence[FoundArm]], str] | None = None,
    task: str = "pouring",
    table_height: float | None = None,
    incomplete_shapes: bool = False,
    say: Say = lambda _: None,
) -> Design:
    """Find everything that a scenario needs for a robot.

    Args:
        model: a shipped model's name, or the path of a model file; or with what it is read.
        wanted_arm: its name, where there are several.
        choose: asks which of several arms to take; None where nobody can be asked.
        task: "pouring" or "scooping".
        table_height: m, of the table's top over the robot's base; found if None.
        incomplete_shapes: go on where collision shapes cannot be had.
        say: told of each step.

    Raises:
        DrakeScrewError: the model cannot be read, no arm is found or several are, or no work area.
    """
    robot = read_robot(model)
    arms = find_arms(robot)
    arm, why = _choice(arms, wanted_arm, choose)
    hand = find_end_effector(robot, arm)
    rest = parked(robot, arm, [other for other in arms if other is not arm])
    say(f"arm '{arm.name}': {len(arm.joints)} joints, end effector '{hand.frame}'")
    bare = _config(robot, arm, hand, rest)
    alone = build_workcell(bare)
    missing = missing_shapes(alone)
    if missing and not incomplete_shapes:
        raise ModelError(
            "collision shapes of the robot cannot be had, so what touches there would not be seen:"
            + "".join(f"\n  {line}" for line in missing),
            remedy="Mend what is missing (--package says where a package is), or give "
            "--incomplete-shapes: then nothing is seen to touch there.",
            file=robot.file,
        )
    chain = alone.arm.screw_chain()
    within = range_of(chain)
    touching = always_touching(alone)
    bare = replace(bare, ignore_collisions=touching)
    standing = stands_on_the_table(robot, arm, len(arms) - 1, chain)
    top = _height(table_height, standing, chain, within, task)
    on_it = standing and abs(top) < 0.1
    say(f"table at {top:.2f} m; looking where the arm reaches")
    reach = _reach(chain, within, top, task)
    likely = _likely(reach, chain)
    if likely is None:
        raise _no_area(robot, arm, top, "no directions of approach work anywhere on the table")
    best = _best_start(bare, chain, within, reach, likely, top, on_it, task, say)
    if best is None:
        raise _no_area(robot, arm, top, "no start was found from which the teacher gets anywhere")
    start, planned = best
    begin = _largest(planned, chain)
    if begin is None:
        raise _no_area(robot, arm, top, "plans succeed nowhere on the table")
    table = table_under(begin, top, around_the_base=on_it)
    trial = _trial(bare, start, table, top, task)
    found = verify(trial, begin, chain.shoulder, _middle(chain), SPACING, say)
    if found is None:
        raise _no_area(robot, arm, top, "no area was found that one demonstration covers")
    table = table_under(found.area, top, around_the_base=on_it)
    remarks = [arm.remark] if arm.remark else []
    if found.area.size[0] < WANTED[0] - 1e-9 or found.area.size[1] < WANTED[1] - 1e-9:
        remarks.append("the work area is small; another --table-height may give a larger one")
    given = table_height is not None
    return Design(
        robot, arm, arms, why, hand, task, rest, touching, on_it, given, table, reach, planned,
        start, found, chain, missing, tuple(remarks),
    )  # fmt: skip


def _choice(
    arms: tuple[FoundArm, ...],
    wanted: str | None,
    choose: Callable[[Sequence[FoundArm]], str] | None,
) -> tuple[FoundArm, str | None]:
    try:
        return choose_arm(arms, wanted)
    except ScenarioError:
        if wanted is not None or choose is None:
            raise
    return choose_arm(arms, choose(arms))


def _config(
    robot: Robot, arm: FoundArm, hand: FoundEndEffector, rest: dict[str, float]
) -> RobotConfig:
    return replace(
        robot.given,
        model=robot.given.model if "://" in robot.given.model else str(robot.file),
        joints=arm.joints,
        end_effector=hand.frame,
        start=(0.0,) * len(arm.joints),
        base=arm.base,
        parked=rest,
        end_effector_rotation=hand.rotation,
    )


def _height(
    given: float | None, standing: bool, chain: ScrewChain, within: Range, task: str
) -> float:
    if given is not None:
        return given
    return 0.0 if standing else best_height(chain, within, task)


def _reach(chain: ScrewChain, within: Range, top: float, task: str) -> ReachMap:
    """On a grid before the shoulder, as far as the hand and what it holds get."""
    out = chain.reach + HOLDS[task].behind
    x0, y0 = chain.shoulder[0], chain.shoulder[1]
    x = np.arange(np.ceil((x0 + CLOSEST) / SPACING), np.floor((x0 + out) / SPACING) + 1) * SPACING
    y = np.arange(np.ceil((y0 - out) / SPACING), np.floor((y0 + out) / SPACING) + 1) * SPACING
    return reach_map(chain, within, np.round(x, 6), np.round(y, 6), top, HOLDS[task])


def _middle(chain: ScrewChain) -> tuple[float, float]:
    """x, y in m where a work area is best, as far as nothing else is against it."""
    return float(chain.shoulder[0] + COMFORTABLE * chain.reach), float(chain.shoulder[1])


def _likely(reach: ReachMap, chain: ScrewChain) -> Rectangle | None:
    """A first guess at the work area, from inverse kinematics alone."""
    for share in (0.6, 0.0):
        good = reach.share > share
        found = best_rectangle(reach.x, reach.y, good, most=LARGEST, middle=_middle(chain))
        if found is not None and found.size[0] >= WANTED[0] - 1e-9 and found.size[1] >= WANTED[1]:
            return found
    return found


def _trial(bare: RobotConfig, start: Start, table: TableConfig, top: float, task: str) -> Trial:
    workcell = build_workcell(replace(bare, start=start.q), table=table, objects=[BOWL])
    return Trial(workcell, task, top, free_axis=start.free_axis)


def _best_start(
    bare: RobotConfig,
    chain: ScrewChain,
    within: Range,
    reach: ReachMap,
    likely: Rectangle,
    top: float,
    on_it: bool,
    task: str,
    say: Say,
) -> tuple[Start, Survey] | None:
    """Of some starts the one from which one demonstration covers the largest rectangle."""
    table = table_under(likely, top, around_the_base=on_it)
    workcell = build_workcell(bare, table=table, objects=[BOWL])
    found = starts(workcell, chain, within, likely, top, STARTS, task)
    say(f"{len(found)} configurations to start from are tried")
    corner = farthest_corner(likely, chain.shoulder)
    best: tuple[float, Start, Survey] | None = None
    for number, start in enumerate(found):
        placed = replace(workcell, start=np.array(start.q))
        trial = Trial(placed, task, top, free_axis=start.free_axis)
        seen = survey(trial, reach.x, reach.y, np.array([corner]))
        size = _size(seen, chain)
        say(f"  start {number + 1}: one demonstration covers {size:.2f} m²")
        if best is None or size > 1.05 * best[0]:
            best = size, start, seen
        if size >= ENOUGH * LARGEST[0] * LARGEST[1]:
            return best[1:]
    if best is None:
        return None
    size, start, seen = best
    placed = replace(workcell, start=np.array(start.q))
    nearer = [[x, y] for x in (likely.x[1] - NEARER, sum(likely.x) / 2.0) for y in likely.y]
    trial = Trial(placed, task, top, free_axis=start.free_axis)
    again = survey(trial, reach.x, reach.y, np.array(nearer))
    return start, max(seen, again, key=lambda s: _size(s, chain))


def _size(seen: Survey, chain: ScrewChain) -> float:
    """m² of the largest rectangle that is covered."""
    covered = _largest(seen, chain)
    return 0.0 if covered is None else covered.area


def _largest(seen: Survey, chain: ScrewChain) -> Rectangle | None:
    return best_rectangle(seen.x, seen.y, seen.good, most=LARGEST, middle=_middle(chain))


def _no_area(robot: Robot, arm: FoundArm, top: float, why: str) -> ModelError:
    least = " x ".join(f"{side:g}" for side in SMALLEST)
    short = f" (it has {arm.remark})" if arm.remark else ""
    return ModelError(
        f"no work area of {least} m is found for arm '{arm.name}'{short} at a table of "
        f"{top:.2f} m: {why}",
        remedy="Give another --table-height (m, over the robot's base) or --arm, or write the "
        "scenario by hand, see docs/another_robot.md.",
        file=robot.file,
    )
