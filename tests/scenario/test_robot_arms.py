"""A robot has one arm, or a list of them; what is wrong with either is said by file and line."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from drake_screw.errors import ScenarioError
from drake_screw.scenario.loader import dump_scenario, load_scenario, load_stored_scenario

BOTH = load_scenario("pouring_both")


def refused(*changes: str, of: str = "pouring_both") -> ScenarioError:
    with pytest.raises(ScenarioError) as caught:
        load_scenario(of, list(changes))
    return caught.value


def test_both_arms_are_listed_in_order() -> None:
    assert [arm.name for arm in BOTH.robot.each_arm] == ["left", "right"]
    assert BOTH.robot.place(1) == "robot.arms.1"
    one = load_scenario("pouring").robot
    assert [arm.joints for arm in one.each_arm] == [one.joints]
    assert one.place(0) == "robot"


def test_it_is_written_out_and_read_back(tmp_path: Path) -> None:
    file = tmp_path / "scenario.yaml"
    file.write_text(dump_scenario(BOTH))
    assert load_stored_scenario(file) == BOTH
    assert set(yaml.safe_load(file.read_text())["robot"]["arms"][0]) == {
        "name",
        "joints",
        "end_effector",
        "start",
    }
    file.write_text(dump_scenario(load_scenario("pouring")))
    assert "arms" not in yaml.safe_load(file.read_text())["robot"]


def test_keys_of_one_arm_do_not_go_with_several() -> None:
    error = refused("robot.start=[0, 0, 0, 0, 0, 0, 0]")
    assert "robot.start: is of a single arm, and robot.arms lists them" in error.message
    assert "tool" in str(error.remedy)


def test_without_arms_the_keys_of_one_are_missing() -> None:
    error = refused("robot.arms=null")
    assert "robot.joints: missing; expected a list of texts" in error.message
    assert "robot.end_effector: missing" in error.message
    assert "robot.start: missing" in error.message


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("robot.arms=[]", "robot.arms: expected at least one arm, found none"),
        ("robot.arms.1.name=left", "robot.arms.1.name: there is another arm named 'left'"),
        (
            "robot.arms.1.start=[0, 0]",
            "robot.arms.1.start: expected 7 angles, one for each joint, found 2",
        ),
        (
            "robot.arms.1.joints.0=left_s0",
            "robot.arms.1.joints.0: joint 'left_s0' belongs to arm 'left', too",
        ),
        (
            "robot.parked.right_s0=0.1",
            "robot.parked.right_s0: joint 'right_s0' belongs to arm 'right', so it cannot be",
        ),
        ("robot.velocity_limits.elbow=1", "'elbow' is no joint of an arm"),
        ("robot.arms.0.start=ready", "robot.arms.0.start: 'ready' would be a state of an SRDF"),
        ("robot.arms.0.strat=[0]", "robot.arms.0.strat: unknown key"),
    ],
)
def test_what_is_wrong_with_an_arm_is_said_where(change: str, message: str) -> None:
    assert message in refused(change).message
