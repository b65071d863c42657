"""What a scenario's numbers must agree with once its robot's model is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drake_screw.errors import ScenarioError
from drake_screw.robot import Arm, ScrewChain, Workcell
from drake_screw.robot.hand import angle_between, out_of_the_hand
from drake_screw.robot.ignored import Pair, remedy_for
from drake_screw.scenario.schema import Scenario

LISTED = 6
"""Of shapes that are missing; a robot can have many."""
ON_THE_LIMIT = 1e-6
"""rad or m. So near to a limit is on it."""
NUDGE = {"rad": 0.05, "m": 0.005}
"""How far inside of a limit it is recommended to start."""
ASIDE = np.deg2rad(45.0)
"""From which on an end effector's z axis clearly does not point out of the hand."""


def check_start(scenario: Scenario, workcell: Workcell, place: str = "robot") -> None:
    """Check that the start configuration is strictly inside the joint limits.

    Args:
        scenario: says what it is.
        workcell: has it.
        place: of the arm's keys in the scenario.

    Raises:
        ScenarioError: it is not.
    """
    arm, start = workcell.arm, workcell.start
    chain = kept_within(scenario, arm)
    margin = chain.margin(start)
    if (margin <= 0.0).any():
        i = int(np.argmin(margin))
        unit, name, on = arm.units[i], arm.joint_names[i], abs(margin[i]) <= ON_THE_LIMIT
        key, kept = _margin_of(scenario, unit)
        within = f", a {key} of {kept:g} {unit} kept" if kept > 0.0 else ""
        inside = np.clip(start[i], *_a_little_inside(chain.lower[i], chain.upper[i], unit))
        raise ScenarioError(
            f"{place}.start: {name} starts at {start[i]:.4f} {unit}, {'on' if on else 'outside'} "
            f"its limits {chain.lower[i]:.4f} .. {chain.upper[i]:.4f} {unit}{within}",
            remedy=f"A plan needs room on both sides: start it a little inside, at {inside:.4g} "
            f"{unit} say. If {name} is to stay where it is, leave it out of {place}.joints and "
            "put it in robot.parked; there it may be on its limit.",
            file=scenario.source,
        )


def kept_within(scenario: Scenario, arm: Arm) -> ScrewChain:
    """The arm as it is planned for: within its joint limits, less the margin to be kept.

    Raises:
        ScenarioError: no motion is left to a joint.
    """
    chain = arm.screw_chain()
    margin = np.array([_margin_of(scenario, unit)[1] for unit in arm.units])
    lower, upper = chain.lower + margin, chain.upper - margin
    if (lower >= upper).any():
        i = int(np.argmin(upper - lower))
        unit = arm.units[i]
        raise ScenarioError(
            f"{_margin_of(scenario, unit)[0]}: {margin[i]:g} {unit} to either side leave nothing "
            f"of the range of {arm.joint_names[i]}, {arm.lower[i]:.4f} .. {arm.upper[i]:.4f} "
            f"{unit}",
            remedy="Choose a smaller margin.",
            file=scenario.source,
        )
    return replace(chain, lower=lower, upper=upper) if margin.any() else chain


def _margin_of(scenario: Scenario, unit: str) -> tuple[str, float]:
    """The key of the margin that joints of a unit are to keep, and its value."""
    block = scenario.planner
    if unit == "m":
        return "planner.slide_margin", block.slide_margin
    return "planner.joint_margin", block.joint_margin


def _a_little_inside(lower: float, upper: float, unit: str) -> tuple[float, float]:
    room = min(NUDGE[unit], 0.1 * (upper - lower))
    return lower + room, upper - room


def touching_at_start(workcell: Workcell, clearance: float = 0.0) -> tuple[Pair, ...]:
    """Names of bodies that touch at the start, or keep less than a clearance in m, in pairs.

    Objects are left out: where they stand is not known yet.
    """
    return workcell.colliding_bodies(workcell.start, workcell.objects_away, clearance)


def check_shapes(scenario: Scenario, workcell: Workcell) -> None:
    """Check that the robot has all collision shapes of its model, where collisions are looked at.

    Raises:
        ScenarioError: it has not, and the scenario does not say that this is all right.
    """
    block, missing = scenario.planner, missing_shapes(workcell)
    if not missing or not block.collision or block.incomplete_shapes:
        return
    listed = "".join(f"\n  {line}" for line in missing)
    one = workcell.model.collision_left_out == 1
    raise ScenarioError(
        f"planner.collision: {'a collision shape' if one else 'collision shapes'} of the robot "
        f"cannot be had, so what touches there would not be seen:{listed}",
        remedy="Mend what is missing; or write incomplete_shapes: true in planner, and the "
        "certificate names these links; or collision: false.",
        file=scenario.source,
    )


def missing_shapes(workcell: Workcell) -> tuple[str, ...]:
    """Collision shapes of the robot's model that cannot be had, in words, a line each."""
    found = [str(s) for s in workcell.model.left_out if s.role == "collision"]
    more = len(found) - LISTED
    return (*found[:LISTED], *([f"and {more} more"] if more > 0 else ()))


def not_shown(workcell: Workcell) -> str | None:
    """What pictures lack of the robot, in a line; None where nothing."""
    left_out = workcell.model.looks_left_out
    if not left_out:
        return None
    one = len(left_out) == 1
    return (
        f"{len(left_out)} mesh{'' if one else 'es'} of the robot {'is' if one else 'are'} not "
        f"shown, such as: {left_out[0]}"
    )


def check_start_is_free(scenario: Scenario, workcell: Workcell, place: str = "robot") -> None:
    """Check that no obstacle touches the robot at the start, nor anything what the robot holds.

    Where collisions are looked at, by planning or by the simulated teacher, neither may the robot
    touch itself or the table there, since nothing could succeed, and a clearance has to be kept.

    Args:
        scenario: says what is looked at.
        workcell: with all arms at their starts.
        place: of the keys of the workcell's arm in the scenario.

    Raises:
        ScenarioError: something does.
    """
    taught = scenario.teacher.kind == "simulated"
    if not (workcell.obstacles or workcell.tool or scenario.planner.collision or taught):
        return
    pairs = touching_at_start(workcell)
    start = "robot.start" if scenario.robot.arms is None else "the starts of robot.arms"

    def touching(name: str) -> list[str]:
        return [other for pair in pairs if name in pair for other in pair if other != name]

    held = [] if workcell.tool is None else touching(workcell.name(workcell.tool.index()))
    if held:
        raise ScenarioError(
            f"{place}.tool.shape: the tool touches {_listed(held)} at the start",
            remedy=f"If it may, as the fingers around it, write touches: [{', '.join(held)}] in "
            f"{place}.tool; otherwise make the shape smaller, move it, or change {place}.start.",
            file=scenario.source,
        )
    for i, body in enumerate(workcell.obstacles):
        links = touching(workcell.name(body.index()))
        if links:
            raise ScenarioError(
                f"obstacles.{i}: '{body.name()}' touches the robot's {_listed(links)} at the start",
                remedy="Move the obstacle (xyz is in metres, seen from "
                f"'{scenario.robot.base}'), or change {start}.",
                file=scenario.source,
            )
    if pairs and (scenario.planner.collision or taught):
        follows = "plan" if scenario.planner.collision else "demonstration of a simulated teacher"
        both = " and ".join(f"'{a}' touches '{b}'" for a, b in pairs)
        raise ScenarioError(
            f"{start}: {both} at the start, so that no {follows} can succeed",
            remedy=f"Change {start}, or robot.parked (fingers may be put apart), or mend the "
            "collision shapes of the robot's model. Where they may touch, write "
            f"{remedy_for(pairs)} in robot"
            + (
                "; planner.collision: false leaves collisions out."
                if scenario.planner.collision and not taught
                else "."
            ),
            file=scenario.source,
        )
    kept = scenario.planner.clearance
    near = touching_at_start(workcell, kept) if kept else ()
    if near:
        both = " and ".join(f"'{a}' and '{b}'" for a, b in near)
        raise ScenarioError(
            f"planner.clearance: {both} are nearer than {kept:g} m at the start, so that no plan "
            "can succeed",
            remedy=f"Choose a smaller clearance, or change {start} or robot.parked; between "
            f"links that may come near, write {remedy_for(near)} in robot.",
            file=scenario.source,
        )


def _listed(names: list[str]) -> str:
    return " and ".join(f"'{name}'" for name in names)


def looks_aside(workcell: Workcell, place: str = "robot") -> str | None:
    """What is to be said where the end effector's z axis clearly does not point out of the hand."""
    plant, arm = workcell.plant, workcell.arm
    context, inspector = plant.CreateDefaultContext(), workcell.scene_graph.model_inspector()
    plant.SetPositions(context, arm.full_positions(workcell.start))
    out, told_by = out_of_the_hand(plant, inspector, arm.joints, context)
    angle = angle_between(arm.pose(workcell.start)[:3, 2], out)
    if angle < ASIDE:
        return None
    return (
        f"the z axis of '{arm.end_effector}' is {np.rad2deg(angle):.0f} degrees from what looks "
        f"like out of the hand ({told_by}); {place}.end_effector_rotation turns it"
    )
