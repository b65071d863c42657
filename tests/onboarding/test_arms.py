"""Arms are found among all of a robot's joints."""

from __future__ import annotations

from pathlib import Path

import pytest

from drake_screw.errors import ModelError, ScenarioError
from drake_screw.onboarding.arms import FoundArm, choose_arm, find_arms
from drake_screw.onboarding.reading import read_robot
from tests.onboarding.models import joint, links_and_joints, robot

LIFT = '<limit lower="0" upper="0.4" velocity="0.1" effort="100"/>'


def found(tmp_path: Path, *parts: str) -> tuple[FoundArm, ...]:
    file = tmp_path / "small.urdf"
    file.write_text(robot(*parts))
    return find_arms(read_robot(str(file)))


def test_an_arm_ends_before_its_fingers(tmp_path: Path) -> None:
    (arm,) = found(tmp_path, links_and_joints())
    assert arm.joints == tuple(f"joint_{i}" for i in range(1, 7))
    assert (arm.base, arm.last_link) == ("base", "link_6")
    assert set(arm.fingers) == {"finger_joint_1", "finger_joint_2"}
    assert (arm.held, arm.remark) == ((), None)


def test_a_lift_and_a_head_are_left_out(tmp_path: Path) -> None:
    (arm,) = found(
        tmp_path,
        joint("torso_lift_joint", "prismatic", "base", "torso", LIFT),
        joint("head_pan_joint", "revolute", "torso", "pan"),
        joint("head_tilt_joint", "revolute", "pan", "tilt"),
        links_and_joints("arm_", "torso"),
    )
    assert arm.held == ("torso_lift_joint",)
    assert arm.joints[0] == "arm_joint_1"
    assert len(arm.joints) == 6


def test_a_short_arm_keeps_its_lift_and_is_remarked_on(tmp_path: Path) -> None:
    chain = [joint("slide", "prismatic", "base", "l0", LIFT)]
    chain += [joint(f"j{i}", "revolute", f"l{i - 1}", f"l{i}", at="0.1 0 0.1") for i in range(1, 5)]
    (arm,) = found(tmp_path, *chain)
    assert arm.joints == ("slide", "j1", "j2", "j3", "j4")
    assert arm.remark is not None
    assert arm.remark.startswith("5 joints")


def test_of_a_mirrored_pair_the_left_one_is_taken(tmp_path: Path) -> None:
    arms = found(
        tmp_path,
        links_and_joints("left_", at="0 0.3 0.4"),
        links_and_joints("right_", at="0 -0.3 0.4"),
    )
    arm, why = choose_arm(arms, None)
    assert (arm.name, why) == ("left", "the left one of left and right")
    assert choose_arm(arms, "right")[0].joints[0] == "right_joint_1"


def test_of_arms_that_are_no_pair_one_has_to_be_chosen(tmp_path: Path) -> None:
    arms = found(tmp_path, links_and_joints("big_"), links_and_joints("small_", at="0 1 0.2"))
    with pytest.raises(ScenarioError, match="2 arms are found") as error:
        choose_arm(arms, None)
    assert "--arm NAME" in str(error.value)
    assert "big (big_joint_1 ... big_joint_6)" in str(error.value)
    with pytest.raises(ScenarioError, match="Did you mean 'small'"):
        choose_arm(arms, "smal")


def test_a_robot_without_an_arm_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="no arm is found"):
        found(tmp_path, joint("wheel_joint", "revolute", "base", "wheel"))


def test_the_shipped_robots() -> None:
    (arm,) = find_arms(read_robot("iiwa14"))
    assert arm.joints == tuple(f"iiwa_joint_{i}" for i in range(1, 8))
    assert [a.name for a in find_arms(read_robot("baxter"))] == ["left", "right"]
