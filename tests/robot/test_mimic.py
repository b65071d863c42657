"""Joints that mimic others rest where those put them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw.errors import ModelError
from drake_screw.execution.station import build_station
from drake_screw.robot import RobotConfig, Workcell, build_workcell
from drake_screw.robot.mimic import Mimic, mimics_in
from tests.robot.test_base import NONE, joint, link, urdf

FINGERS = (
    link("right")
    + link("left")
    + link("tip")
    + joint("finger", "l3", "right", "prismatic", "0.1 0.2 0")
    + joint("other", "l3", "left", "prismatic", "0.1 -0.2 0").replace(
        "</joint>", "<mimic joint='finger' multiplier='-2' offset='0.1'/></joint>"
    )
    + joint("curl", "left", "tip", "revolute", "0.1 0 0").replace(
        "</joint>", "<mimic joint='other'/></joint>"
    )
)


def config(folder: Path, after: str = FINGERS, **changes: object) -> RobotConfig:
    file = folder / "small.urdf"
    file.write_text(urdf("", after))
    settings = {"joints": ("j1", "j2", "j3"), "start": (0.1, 0.2, 0.3), **changes}
    return RobotConfig(str(file), end_effector="l3", base="base_link", **settings)


def resting(cell: Workcell, *names: str) -> list[float]:
    full = cell.positions(np.zeros(cell.arm.n), NONE)
    return [full[cell.plant.GetJointByName(name).position_start()] for name in names]


def test_they_follow_what_is_parked_and_one_another(tmp_path: Path) -> None:
    names = ("finger", "other", "curl")
    cell = build_workcell(config(tmp_path, parked={"finger": 0.3}))
    assert resting(cell, *names) == pytest.approx([0.3, -0.5, -0.5])
    assert resting(build_workcell(config(tmp_path)), *names) == pytest.approx([0.0, 0.1, 0.1])
    cell = build_workcell(config(tmp_path, parked={"finger": 0.3, "other": 0.2}))
    assert resting(cell, *names) == pytest.approx([0.3, 0.2, 0.2])


def test_they_are_held_there_when_plans_are_executed(tmp_path: Path) -> None:
    station = build_station(config(tmp_path, parked={"finger": 0.3}))
    context = station.plant.GetMyContextFromRoot(station.context([0.1, 0.2, 0.3], NONE))
    other = station.plant.GetJointByName("other").GetOnePosition(context)
    assert other == pytest.approx(-0.5)


def test_a_joint_of_the_arm_neither_follows_nor_leads(tmp_path: Path) -> None:
    leads = FINGERS.replace("mimic joint='finger'", "mimic joint='j3'")
    with pytest.raises(ModelError, match="'other' mimics joint 'j3', and 'j3' is a joint of the"):
        build_workcell(config(tmp_path, leads))
    follows = urdf("", "").replace(
        "<child link='l3'/>", "<child link='l3'/><mimic joint='j2' multiplier='-1'/>"
    )
    (tmp_path / "small.urdf").write_text(follows)
    robot = RobotConfig(
        str(tmp_path / "small.urdf"), ("j1", "j2", "j3"), "l3", (0.0,) * 3, "base_link"
    )
    with pytest.raises(ModelError, match="'j3' mimics joint 'j2'") as caught:
        build_workcell(robot)
    assert "leave the joint out of the arm" in caught.value.remedy


def test_formats_say_it_in_their_own_ways(tmp_path: Path) -> None:
    sdf = tmp_path / "a.sdf"
    sdf.write_text(
        "<sdf version='1.11'><model name='m'><joint name='b' type='revolute'><axis><xyz>0 0 1</xyz>"
        "<mimic joint='a'><multiplier>2</multiplier><offset>0.3</offset><reference>0.1</reference>"
        "</mimic></axis></joint></model></sdf>"
    )
    assert mimics_in(sdf) == (Mimic("b", "a", 2.0, pytest.approx(0.1)),)
    mjcf = tmp_path / "a.xml"
    mjcf.write_text(
        "<mujoco><equality><joint joint1='b' joint2='a' polycoef='0.1 -1 0 0 0'/>"
        "<joint joint1='c' joint2='a' polycoef='0 1 2 0 0'/><weld body1='x'/></equality></mujoco>"
    )
    assert mimics_in(mjcf, "left") == (Mimic("left::b", "left::a", -1.0, 0.1),)
    (tmp_path / "a.urdf").write_text("<robot")
    assert mimics_in(tmp_path / "a.urdf") == ()
