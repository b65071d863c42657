"""A scenario for a robot, found step by step: arm, hand, table, start and work area."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from drake_screw.assembly.sanity import missing_shapes
from drake_screw.errors import ModelError, ScenarioError, counted
from drake_screw.onboarding.area import SMALLEST, WANTED, Survey, Verified
from drake_screw.onboarding.arms import FoundArm, choose_arm
from drake_screw.onboarding.at_height import NoArea, Place, Say, at_height
from drake_screw.onboarding.contacts import Pair, always_touching
from drake_screw.onboarding.end_effector import FoundEndEffector, find_end_effector
from drake_screw.onboarding.groups import arms_by_name
from drake_screw.onboarding.hand_ik import Range, range_of
from drake_screw.onboarding.parked import parked
from drake_screw.onboarding.reach import ReachMap
from drake_screw.onboarding.reading import Robot, read_robot
from drake_screw.onboarding.start import Start
from drake_screw.onboarding.table import best_heights, stands_on_the_table
from drake_screw.robot import RobotConfig, ScrewChain, TableConfig, build_workcell


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
    arms = arms_by_name(robot)
    arm, why = _choice(arms, wanted_arm, choose)
    hand = find_end_effector(robot, arm)
    others = [o for o in arms if not o.only_by_name and not set(o.joints) & set(arm.joints)]
    rest = parked(robot, arm, others)
    say(f"arm '{arm.name}': {counted(len(arm.joints), 'joint')}, end effector '{hand.frame}'")
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
    standing = stands_on_the_table(robot, arm, len(others), chain)
    if table_height is not None:
        heights: Sequence[float] = (table_height,)
    else:
        heights = (0.0,) if standing else best_heights(chain, within, task)
    place = _first_place(robot, arm, bare, chain, within, heights, task, standing, say)
    found = place.found
    remarks = [arm.remark] if arm.remark else []
    if found.area.size[0] < WANTED[0] - 1e-9 or found.area.size[1] < WANTED[1] - 1e-9:
        remarks.append("the work area is small; another --table-height may give a larger one")
    given = table_height is not None
    return Design(
        robot, arm, arms, why, hand, task, rest, touching, place.on_the_table, given, place.table,
        place.reach, place.planned, place.start, found, chain, missing, tuple(remarks),
    )  # fmt: skip


def _first_place(
    robot: Robot,
    arm: FoundArm,
    bare: RobotConfig,
    chain: ScrewChain,
    within: Range,
    heights: Sequence[float],
    task: str,
    standing: bool,
    say: Say,
) -> Place:
    """At the first of some heights of a table at which there is a work area."""
    reasons = []
    for top in heights:
        try:
            return at_height(bare, chain, within, top, task, standing=standing, say=say)
        except NoArea as reason:
            reasons.append(reason)
            say(f"  no work area at {top:.2f} m: {reason.why}")
    raise _no_area(robot, arm, reasons)


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


def _no_area(robot: Robot, arm: FoundArm, reasons: Sequence[NoArea]) -> ModelError:
    least = " x ".join(f"{side:g}" for side in SMALLEST)
    short = f" (it has {arm.remark})" if arm.remark else ""
    one = f" at a table of {reasons[0].top:.2f} m: {reasons[0].why}"
    each = "".join(f"\n  at a table of {r.top:.2f} m: {r.why}" for r in reasons)
    return ModelError(
        f"no work area of {least} m is found for arm '{arm.name}'{short}"
        f"{one if len(reasons) == 1 else each}",
        remedy="Give another --table-height (m, over the robot's base) or --arm, or write the "
        "scenario by hand, see docs/another_robot.md.",
        file=robot.file,
    )
