"""SRDF: links that may touch one another, groups, and states."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drake_screw.assembly.preview import preview
from drake_screw.assembly.setup import Setup
from drake_screw.errors import ModelError, ScenarioError
from drake_screw.robot import RobotConfig, Workcell, build_workcell
from drake_screw.robot.srdf import Group, GroupState, IgnoredPair, read_srdf
from drake_screw.runs.begun_with import model_files, model_hashes
from drake_screw.scenario.loader import dump_scenario, load_scenario
from tests.robot.small_arms import PLANAR, sdf

BALL = "<sphere><radius>0.4</radius></sphere>"
SRDF = """<?xml version="1.0"?>
<robot name="small">
  <group name="arm"><chain base_link="base" tip_link="hand"/></group>
  <group name="all"><joint name="p1"/><link name="hand"/><group name="arm"/></group>
  <group_state name="home" group="arm">
    <joint name="p1" value="0.5"/><joint name="p2" value="-1"/>
    <joint name="root" value="0 0 0 0 0 0 1"/>
  </group_state>
  <disable_collisions link1="p1_link" link2="p3_link" reason="Default"/>
  <disable_collisions link1="p3_link" link2="p1_link" reason="again"/>
  <disable_collisions link1="p1_link" link2="finger"/>
</robot>
"""
SCENARIO = """\
name: small
robot: {model: arm.sdf, joints: [p1, p2, p3], end_effector: hand, start: [0.3, 0.3, 0.3],
  srdf: arm.srdf}
objects:
  - {name: bowl, x: [0.5, 0.7], y: [-0.1, 0.1], z: 0.1, radius: 0.05, height: 0.05}
regions: {grid: {}}
teacher: {kind: interactive}
"""


@pytest.fixture
def robot(tmp_path: Path) -> RobotConfig:
    """A planar arm that touches itself wherever it is."""
    (tmp_path / "arm.sdf").write_text(sdf(PLANAR, shapes={"p1_link": BALL, "p3_link": BALL}))
    (tmp_path / "arm.srdf").write_text(SRDF)
    (tmp_path / "small.yaml").write_text(SCENARIO)
    start = (0.0, 0.0, 0.0)
    return RobotConfig(str(tmp_path / "arm.sdf"), ("p1", "p2", "p3"), "hand", start)


def touches(cell: Workcell) -> bool:
    return bool(cell.collides(np.zeros((1, 3)), np.empty((0, 4, 4)))[0])


def test_pairs_groups_and_states_are_read(robot: RobotConfig) -> None:
    found = read_srdf(Path(robot.model).with_suffix(".srdf"))
    assert found.pairs == (
        IgnoredPair("p1_link", "p3_link", "Default"),
        IgnoredPair("p1_link", "finger", "no reason given"),
    )
    assert found.groups == (
        Group("arm", chains=(("base", "hand"),)),
        Group("all", joints=("p1",), links=("hand",), groups=("arm",)),
    )
    assert found.states == (GroupState("home", "arm", {"p1": 0.5, "p2": -1.0}),)


def test_its_pairs_may_touch(robot: RobotConfig) -> None:
    before = build_workcell(robot)
    assert touches(before)
    cell = build_workcell(replace(robot, srdf=str(Path(robot.model).with_suffix(".srdf"))))
    assert not touches(cell)
    assert len(before.pairs) - len(cell.pairs) == 1
    assert cell.unknown_links == ("finger",)


def test_it_is_part_of_a_scenario(robot: RobotConfig, tmp_path: Path) -> None:
    """Its path is relative; check names links that there are not; a run is tied to it."""
    scenario = load_scenario(tmp_path / "small.yaml")
    assert scenario.robot.srdf == str(tmp_path / "arm.srdf")
    copy = tmp_path / "sub.yaml"
    copy.write_text(dump_scenario(scenario))
    assert load_scenario(copy) == scenario
    assert "note       links that the robot's model lacks: finger" in str(preview(scenario))
    setup = Setup(scenario)
    assert model_files(setup)["robot.srdf"] == tmp_path / "arm.srdf"
    before = model_hashes(setup)
    (tmp_path / "arm.srdf").write_text(SRDF.replace("Default", "Never"))
    changed = {name for name, hash in model_hashes(setup).items() if before[name] != hash}
    assert changed == {"robot.srdf"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot", "this SRDF cannot be read"),
        ("<sdf/>", "not SRDF"),
        ("<robot><joint><parent link='a'/></joint></robot>", "a robot's model and not SRDF"),
        (SRDF.replace('"0.5"', '"half"'), "state 'home' has 'half' for joint 'p1'"),
        (None, "there is no such SRDF file"),
    ],
)
def test_what_cannot_be_used_is_refused(
    text: str | None, message: str, robot: RobotConfig, tmp_path: Path
) -> None:
    file = tmp_path / "other.srdf"
    if text is not None:
        file.write_text(text)
    with pytest.raises(ModelError, match=message) as caught:
        build_workcell(replace(robot, srdf=str(file)))
    assert caught.value.file == file


STATES = SRDF.replace(
    "</robot>",
    """<group_state name="home" group="wrist"><joint name="p3" value="0.25"/></group_state>
<group_state name="up" group="arm"><joint name="p1" value="1"/><joint name="p2" value="1"/>
  <joint name="p3" value="1"/></group_state>
<group_state name="up" group="wrist"><joint name="p3" value="0.25"/></group_state>
</robot>""",
)


def started(folder: Path, start: str, states: str = STATES) -> Setup:
    (folder / "arm.srdf").write_text(states)
    return Setup(load_scenario(folder / "small.yaml", [f"robot.start={start}"]))


@pytest.mark.usefixtures("robot")
def test_a_state_is_the_start(tmp_path: Path) -> None:
    """Of one group, or of several together; it is kept by its name."""
    setup = started(tmp_path, "home")
    np.testing.assert_array_equal(setup.workcell.start, [0.5, -1.0, 0.25])
    copy = tmp_path / "sub.yaml"
    copy.write_text(dump_scenario(setup.scenario))
    assert load_scenario(copy).robot.start == "home"
    setup = started(tmp_path, "arm/up")
    np.testing.assert_array_equal(setup.workcell.start, [1.0, 1.0, 1.0])


@pytest.mark.usefixtures("robot")
@pytest.mark.parametrize(
    ("start", "states", "message", "remedy"),
    [
        ("hom", STATES, "no state 'hom'", "Did you mean 'home'"),
        ("home", SRDF, "state 'home' has no position for joint 'p3'", "It has one for: p1, p2"),
        ("up", STATES, "state 'up' has 2 positions for joint 'p3'", "arm/up or wrist/up"),
    ],
)
def test_a_state_that_will_not_do_is_refused(
    start: str, states: str, message: str, remedy: str, tmp_path: Path
) -> None:
    with pytest.raises(ModelError, match=message) as caught:
        _ = started(tmp_path, start, states).workcell
    assert caught.value.file == tmp_path / "arm.srdf"
    assert remedy in str(caught.value.remedy)


@pytest.mark.usefixtures("robot")
def test_a_state_without_an_srdf_is_refused(tmp_path: Path) -> None:
    text = SCENARIO.replace("[0.3, 0.3, 0.3],\n  srdf: arm.srdf", "home")
    (tmp_path / "small.yaml").write_text(text)
    with pytest.raises(ScenarioError, match="'home' would be a state of an SRDF file"):
        load_scenario(tmp_path / "small.yaml")


@pytest.mark.usefixtures("robot")
@pytest.mark.parametrize("start", ["[0.3, x, 0.3]", "[0.3, [1], 0.3]"])
def test_a_number_that_is_none_is_told_by_its_place(start: str, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"robot\.start\.1: expected a number"):
        started(tmp_path, start)
