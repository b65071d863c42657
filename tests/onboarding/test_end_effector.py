"""An end effector's z axis points out of the hand, by itself or turned."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw.onboarding.arms import find_arms
from drake_screw.onboarding.end_effector import FoundEndEffector, find_end_effector
from drake_screw.onboarding.reading import read_robot
from drake_screw.robot import RobotConfig, build_workcell
from tests.onboarding.models import frame, links_and_joints, robot


def found(tmp_path: Path, *parts: str) -> FoundEndEffector:
    file = tmp_path / "small.urdf"
    file.write_text(robot(*parts))
    read = read_robot(str(file))
    return find_end_effector(read, find_arms(read)[0])


def test_a_frame_that_points_out_is_taken_as_it_is(tmp_path: Path) -> None:
    hand = found(
        tmp_path,
        links_and_joints(),
        frame("flange", "link_6", "0 1.5708 0"),
        frame("tcp", "link_6", "0 0 0.7"),
    )
    assert (hand.frame, hand.rotation) == ("tcp", None)
    assert "fingers" in hand.derived_from


@pytest.mark.parametrize("rpy", ["0 1.5708 0", "1.5708 0 0", "3.14159 0.3 0.2"])
def test_any_other_frame_is_turned(tmp_path: Path, rpy: str) -> None:
    turned = (
        links_and_joints(gripper=False)
        .replace(
            '<link name="link_6"><visual><origin xyz="0 0 0.06"/>',
            '<link name="link_6"><visual><origin xyz="-0.06 0 0"/>',
        )
        .replace(
            '<origin xyz="0 0 0.25"/><axis xyz="0 0 1"/>',
            '<origin xyz="0 0 0.25" rpy="0 1.5708 0"/><axis xyz="-1 0 0"/>',
        )
    )
    hand = found(tmp_path, turned, frame("gripper", "link_6", rpy))
    assert hand.frame == "gripper"
    assert hand.rotation is not None
    names = tuple(f"joint_{i}" for i in range(1, 7))
    config = RobotConfig(
        str(tmp_path / "small.urdf"),
        names,
        hand.frame,
        (0.0,) * 6,
        end_effector_rotation=hand.rotation,
    )
    X_WE = build_workcell(config).arm.pose(np.zeros(6))
    assert X_WE[:3, 2] == pytest.approx([0.0, 0.0, 1.0], abs=2e-3)


def test_the_shipped_robots() -> None:
    for model, frame_name in (("iiwa14", "hand"), ("baxter", "left_hand")):
        read = read_robot(model)
        hand = find_end_effector(read, find_arms(read)[0])
        assert (hand.frame, hand.rotation) == (frame_name, None)
