"""What of the screws an arm can follow, in words: what is free, and what it lacks joints for."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from drake_screw.robot import Arm
from drake_screw.robot.directions import has, missing_turn
from drake_screw.scenario.schema import Scenario
from drake_screw.scenario.values import AXES
from drake_screw.typing import Array

LETTERS = {vector: name for name, vector in AXES.items()}


def axis_words(axis: tuple[float, float, float]) -> str:
    """An axis of the hand in words: "z axis", or "axis [1, 1, 0]"."""
    if axis in LETTERS:
        return f"{LETTERS[axis]} axis"
    return f"axis [{', '.join(f'{v:g}' for v in axis)}]"


def free_roll(scenario: Scenario) -> str | None:
    """What of the hand's motion is left free, in a sentence; None where nothing is."""
    axis = scenario.planner.roll_axis
    if axis is None:
        return None
    hands = " or ".join(f"'{arm.end_effector}'" for arm in scenario.robot.each_arm)
    return (
        "Position and one axis of the hand are followed: how far it is turned about the "
        f"{axis_words(axis)} of {hands} is free, and may be anything."
    )


def cannot_follow(scenario: Scenario, arm: Arm, start: Array) -> Iterator[str]:
    """Sentences on screws that an arm lacks joints for, and what to do about it.

    Args:
        scenario: says what is followed.
        arm: to follow it.
        start: (n,) rad or m, where its plans start.
    """
    chain, axis = arm.screw_chain(), scenario.planner.roll_axis
    how_many = f"{arm.n} joint{'' if arm.n == 1 else 's'}"
    if axis is None:
        if arm.n >= 6:
            return
        yield (
            f"{how_many}: the hand cannot be turned and moved in all six directions, and a "
            "screw in general cannot be followed: plans fail as out of reach where "
            f"the bodies' places ask for another{_lacks(arm, start)}"
        )
        usable = [name for name, vector in AXES.items() if has(chain, vector)]
        if usable:
            yield (
                "planner.task: position_and_axis follows five directions, and leaves the roll "
                f"about an axis of the hand free; this arm can with planner.free_axis: "
                f"{' or '.join(usable)}, or one between them"
            )
        elif arm.n < 5:
            yield (
                "nor can planner.task: position_and_axis help, which takes five joints; it remains "
                "for motions that lie in what the arm has"
            )
    elif not has(chain, axis):
        yield _no_axis(arm, axis, how_many)


def _no_axis(arm: Arm, axis: tuple[float, float, float], how_many: str) -> str:
    if arm.n < 5:
        return (
            f"{how_many}: fewer than the five directions of planner.task: position_and_axis; "
            "screws in general cannot be followed, and plans fail as out of reach"
        )
    usable = [name for name, vector in AXES.items() if has(arm.screw_chain(), vector)]
    others = f"; it can with planner.free_axis: {' or '.join(usable)}" if usable else ""
    return (
        f"{how_many}: with the roll about the {axis_words(axis)} of '{arm.end_effector}' free the "
        f"arm still lacks a direction, so that next to nothing can be followed{others}"
    )


def _lacks(arm: Arm, q: Array) -> str:
    """Which turn an arm of five joints lacks at q (n,), as the end of a sentence; "" of others."""
    if arm.n != 5:
        return ""
    turn = missing_turn(arm.screw_chain(), [q])[0]
    if np.linalg.norm(turn) < 0.1:
        return ""
    axis = ", ".join(f"{v:.2f}" for v in turn / np.linalg.norm(turn))
    return f". At the start it is a turn about [{axis}] of the hand that is missing"
