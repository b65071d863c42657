"""Groups of an SRDF as arms."""

from __future__ import annotations

from pathlib import Path

import pytest

from drake_screw.errors import ModelError
from drake_screw.onboarding.arms import FoundArm, choose_arm
from drake_screw.onboarding.groups import arms_by_name
from drake_screw.onboarding.reading import read_robot
from drake_screw.robot import RobotConfig
from tests.onboarding.models import joint, links_and_joints, robot

LIFT = '<limit lower="0" upper="0.4" velocity="0.1" effort="100"/>'
BODY = (
    joint("torso_lift", "prismatic", "base", "torso", LIFT),
    links_and_joints("arm_", "torso"),
)
ALL = " ".join(f'<joint name="arm_joint_{i}"/>' for i in range(1, 7))


def arms(folder: Path, *groups: str, parts: tuple[str, ...] = BODY) -> tuple[FoundArm, ...]:
    (folder / "small.urdf").write_text(robot(*parts))
    (folder / "small.srdf").write_text(f"<robot name='small'>{''.join(groups)}</robot>")
    model, srdf = str(folder / "small.urdf"), str(folder / "small.srdf")
    return arms_by_name(read_robot(RobotConfig(model, (), "", (), srdf=srdf)))


def by_name(found: tuple[FoundArm, ...]) -> dict[str, tuple[str, ...]]:
    return {arm.name: arm.joints for arm in found}


@pytest.mark.parametrize(
    "group",
    [
        ALL,
        '<chain base_link="torso" tip_link="arm_link_6"/>',
        " ".join(f'<link name="arm_link_{i}"/>' for i in range(1, 7)),
    ],
)
def test_the_arm_is_called_as_its_group(group: str, tmp_path: Path) -> None:
    (arm,) = arms(tmp_path, f'<group name="manipulator">{group}</group>')
    assert (arm.name, arm.only_by_name) == ("manipulator", False)
    assert arm.joints == tuple(f"arm_joint_{i}" for i in range(1, 7))
    assert arm.held == ("torso_lift",)


def test_other_groups_are_taken_where_they_are_asked_for(tmp_path: Path) -> None:
    """One with the lift; not those that branch, are too short, or are part of themselves."""
    found = arms(
        tmp_path,
        f'<group name="manipulator">{ALL}<group name="loop"/></group>',
        '<group name="loop"><group name="manipulator"/></group>',
        '<group name="lifted"><joint name="torso_lift"/><group name="manipulator"/></group>',
        '<group name="wrist"><chain base_link="arm_link_3" tip_link="arm_link_6"/></group>',
        '<group name="hand"><joint name="arm_finger_joint_1"/></group>',
        '<group name="none"/>',
        '<group name="astray"><chain base_link="arm_link_6" tip_link="torso"/></group>',
        '<group name="unknown"><chain base_link="here" tip_link="there"/></group>',
    )
    assert set(by_name(found)) == {"manipulator", "lifted"}
    assert by_name(found)["lifted"][0] == "torso_lift"
    assert choose_arm(found, None)[0].name == "manipulator"
    lifted, why = choose_arm(found, "lifted")
    assert (len(lifted.joints), lifted.held, why) == (7, (), None)


def test_a_group_is_an_arm_where_none_is_found(tmp_path: Path) -> None:
    wheels = [joint(f"neck_{i}", "revolute", f"l{i}", f"l{i + 1}") for i in range(5)]
    parts = (joint("fixed", "fixed", "base", "l0"), *wheels)
    names = " ".join(f'<joint name="neck_{i}"/>' for i in range(5))
    with pytest.raises(ModelError, match="no arm is found"):
        arms(tmp_path, parts=parts)
    (arm,) = arms(tmp_path, f'<group name="trunk">{names}</group>', parts=parts)
    assert arm.joints == tuple(f"neck_{i}" for i in range(5))
    assert choose_arm([arm], None)[0] is arm
