"""What is said of arms that lack joints, and of a roll that is left free."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.assembly.following import axis_words, cannot_follow, free_roll
from drake_screw.assembly.hints import hints
from drake_screw.errors import ScenarioError
from drake_screw.robot import Arm
from drake_screw.scenario.loader import load_scenario
from drake_screw.scenario.schema import Scenario
from tests.planning.conftest import serial_arm
from tests.planning.test_position_and_axis import five_joints

FREE = "planner.task=position_and_axis"
START = np.full(6, 0.3)


def scenario(n: int, *changes: str) -> Scenario:
    start = f"robot.start=[{', '.join(['0.3'] * n)}]"
    joints = f"robot.joints=[{', '.join(f'j{i + 1}' for i in range(n))}]"
    return load_scenario("pouring", [start, joints, "robot.parked={}", *changes])


def of_joints(n: int) -> Arm:
    axes = ["0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0"]
    return serial_arm([("0.1 0 0.05", axes[i], 2.0) for i in range(n)])


def test_of_six_joints_nothing_is_said() -> None:
    assert list(cannot_follow(scenario(6), of_joints(6), START)) == []
    assert free_roll(scenario(6)) is None
    assert hints(scenario(6), of_joints(6), START) == ()


def test_five_joints_are_told_of_the_remedy() -> None:
    said = " ".join(cannot_follow(scenario(5), five_joints(), START[:5]))
    assert "5 joints" in said
    assert "planner.task: position_and_axis" in said
    assert "a turn about [" in said
    assert (
        list(cannot_follow(scenario(5, FREE, "planner.free_axis=y"), five_joints(), START[:5]))
        == []
    )


def test_four_joints_are_too_few_for_either() -> None:
    assert "takes five joints" in " ".join(cannot_follow(scenario(4), of_joints(4), START[:4]))
    (said,) = cannot_follow(scenario(4, FREE), of_joints(4), START[:4])
    assert "fewer than the five directions" in said


def test_an_axis_that_leaves_a_direction_lacking() -> None:
    flat = serial_arm([("0.1 0 0", "0 0 1", 2.0) for _ in range(5)])
    (said,) = cannot_follow(scenario(5, FREE, "planner.free_axis=x"), flat, START[:5])
    assert "still lacks a direction" in said


@pytest.mark.parametrize(
    ("key", "axis", "words"),
    [("x", (1.0, 0.0, 0.0), "x axis"), ("[0, 1, 1]", (0.0, 1.0, 1.0), "axis [0, 1, 1]")],
)
def test_the_free_axis_is_named(key: str, axis, words: str) -> None:
    free = scenario(6, FREE, f"planner.free_axis={key}")
    assert free.planner.roll_axis == axis
    assert axis_words(axis) == words
    assert words in str(free_roll(free))


def test_the_axis_is_z_where_left_out() -> None:
    assert scenario(6, FREE).planner.roll_axis == (0.0, 0.0, 1.0)
    assert scenario(6).planner.roll_axis is None


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (("planner.free_axis=x",), "no roll is free"),
        ((FREE, "planner.free_axis=w"), "expected x, y, z"),
        ((FREE, "planner.free_axis=[0, 0, 0]"), "no direction"),
    ],
)
def test_what_makes_no_sense_is_refused(changes: tuple[str, ...], said: str) -> None:
    with pytest.raises(ScenarioError, match=said):
        scenario(6, *changes)
