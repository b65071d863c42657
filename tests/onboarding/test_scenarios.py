"""From a model to a scenario that is certified."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drake_screw import load_scenario, new_run
from drake_screw.acquisition import Status
from drake_screw.errors import DrakeScrewError
from drake_screw.onboarding import Design, assumptions, design, scenario_text, write_scenario
from drake_screw.robot import RobotConfig
from drake_screw.runs.summary import summarize_run
from tests.commands.conftest import Command, command
from tests.onboarding.models import frame, links_and_joints, robot

__all__ = ["command"]


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Design:
    file = tmp_path_factory.mktemp("models") / "small.urdf"
    file.write_text(robot(links_and_joints(), frame("tool", "link_6", "0 -1.5708 0")))
    return design(str(file))


def test_what_is_found_is_what_is_written(small: Design, tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    picture = write_scenario(small, file, "drake-screw init small.urdf")
    assert picture == tmp_path / "mine_reach.png"
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.yaml", "mine_reach.png"]
    scenario = load_scenario(file)
    assert scenario.name == "mine"
    assert scenario.robot.joints == small.arm.joints
    assert scenario.robot.start == pytest.approx(small.start.q)
    assert dict(scenario.robot.parked) == small.rest
    bowl = scenario.objects[0]
    assert (bowl.x.lower, bowl.x.upper) == pytest.approx(small.found.area.x)
    assert bowl.z.lower == bowl.z.upper == small.table.top == 0.0
    assert small.rest["finger_joint_1"] > 0.02


def test_every_assumption_is_said(small: Design, tmp_path: Path) -> None:
    said = "\n".join(assumptions(small))
    for words in ("6 joints", "--table-height", "robot.start", "objects.0.x"):
        assert words in said
    text = scenario_text(small, "mine", tmp_path, "drake-screw init small.urdf")
    assert text.count("#") > 20


def test_nothing_is_left_of_a_scenario_that_cannot_be_used(small: Design, tmp_path: Path) -> None:
    wrong = replace(small, rest={"no_such_joint": 0.1})
    with pytest.raises(DrakeScrewError, match="no_such_joint"):
        write_scenario(wrong, tmp_path / "mine.yaml", "drake-screw init")
    assert list(tmp_path.iterdir()) == []


def test_a_table_out_of_reach_is_refused(small: Design) -> None:
    with pytest.raises(DrakeScrewError, match="no work area") as error:
        design(str(small.robot.file), table_height=-2.0)
    assert "--table-height" in str(error.value)


@pytest.mark.parametrize(
    ("args", "expected"),
    [
        (["nowhere.urdf"], "no file 'nowhere.urdf'"),
        (["iiwa14", "--output", "mine.txt"], "Name it mine.yaml"),
        (["iiwa14", "--output", "nowhere/mine.yaml"], "there is no folder"),
        (["iiwa14", "--arm", "left"], "no arm 'left'"),
        (["pouring", "--arm", "left"], "--arm is for a robot's model"),
        (["iiwa"], "iiwa14"),
        (["iiwa14", "--xacro", "dof"], "--xacro: 'dof' is not NAME=VALUE"),
        (["iiwa14", "--package", "my_arm=nowhere"], "--package: there is no folder"),
        (["iiwa14", "--srdf", "nowhere.srdf"], "--srdf: there is no file 'nowhere.srdf'"),
        (["pouring", "--incomplete-shapes"], "--incomplete-shapes is for a robot's model"),
    ],
)
def test_what_cannot_be_made_is_said(command: Command, args: list[str], expected: str) -> None:
    code, _, err = command("init", *args)
    assert code == 2
    assert expected in err
    assert list(Path().iterdir()) == []


def test_what_a_model_is_read_with_is_written_too(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    package = tmp_path / "parts" / "my_arm"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>my_arm</name></package>")
    lost = '<link name="cover"><collision><geometry><mesh filename="package://my_arm/lost.obj"/>'
    lost += '</geometry></collision></link><joint name="on" type="fixed"><parent link="base"/>'
    lost += '<child link="cover"/></joint>'
    text = robot(links_and_joints("$(arg side)"), lost)
    ns = '<robot xmlns:xacro="http://ros.org/wiki/xacro" '
    file = tmp_path / "small.urdf.xacro"
    file.write_text(
        text.replace("<robot ", ns).replace("<link", '<xacro:arg name="side" default=""/><link', 1)
    )
    srdf = tmp_path / "small.srdf"
    pair = '<disable_collisions link1="left_link_1" link2="left_link_3" reason="Never"/>'
    srdf.write_text(f'<robot name="small">{pair}</robot>')
    packages = {"my_arm": package}
    given = RobotConfig(
        str(file), (), "", (), packages=packages, xacro={"side": "left_"}, srdf=str(srdf)
    )
    with pytest.raises(DrakeScrewError, match="cover") as error:
        design(given)
    assert "--incomplete-shapes" in str(error.value)
    made = tmp_path / "mine.yaml"
    write_scenario(design(given, incomplete_shapes=True), made, "drake-screw init")
    block = load_scenario(made).robot
    assert block.joints[0] == "left_joint_1"
    assert dict(block.xacro) == {"side": "left_"}
    assert {name: Path(folder) for name, folder in block.packages.items()} == packages
    assert Path(str(block.srdf)) == srdf
    assert load_scenario(made).planner.incomplete_shapes
    assert "my_arm: parts/my_arm" in made.read_text()


@pytest.mark.slow
@pytest.mark.parametrize("model", ["small", "iiwa14", "baxter"])
def test_what_is_made_is_certified(command: Command, small: Design, model: str) -> None:
    named = str(small.robot.file) if model == "small" else model
    code, out, err = command("init", named, "--output", "mine.yaml")
    assert (code, err) == (0, "")
    assert "drake-screw run mine.yaml" in out
    assert command("check", "mine.yaml")[0] == 0
    run = new_run(load_scenario("mine.yaml"), Path("run"))
    for _ in run.events():
        pass
    summary = summarize_run(run)
    assert summary.status == Status.CERTIFIED
    assert np.isclose(load_scenario("mine.yaml").coverage.beta, 0.95)


@pytest.mark.slow
def test_scooping_too(command: Command) -> None:
    code, _, err = command("init", "iiwa14", "--task", "scooping", "--output", "mine.yaml")
    assert (code, err) == (0, "")
    run = new_run(load_scenario("mine.yaml"), Path("run"))
    for _ in run.events():
        pass
    assert summarize_run(run).status == Status.CERTIFIED
