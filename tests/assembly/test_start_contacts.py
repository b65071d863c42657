"""Whatever touches at the start is told with the pair and the remedy, and not by what follows."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from drake_screw import Setup, load_scenario
from drake_screw.acquisition import Finished, Suggestion
from drake_screw.assembly.preview import preview
from drake_screw.commands.inspect_console import inspect_run
from drake_screw.errors import RunDirectoryError, ScenarioError
from drake_screw.runs.run import new_run
from drake_screw.scenario.loader import dump_scenario
from drake_screw.scenario.schema import Scenario
from tests.robot.six_joints import NAMES, fingers, scenario, urdf

TOGETHER = "  ignore_collisions: [[left, right]]"
APART = "  parked: {left_slide: 0.01, right_slide: 0.01}"
BALL = "<geometry><sphere radius='0.3'/></geometry>"


def six(
    folder: Path, *changes: str, robot: str = "", shapes: dict[str, str] | None = None
) -> Scenario:
    (folder / "six.urdf").write_text(
        urdf(transmissions=NAMES, extra=fingers(), shapes=shapes or {})
    )
    (folder / "six.yaml").write_text(scenario(robot=robot))
    return load_scenario(folder / "six.yaml", changes)


@pytest.mark.parametrize("collision", ["true", "false"])
def test_fingers_that_touch_are_refused_with_the_pair_and_the_remedy(
    tmp_path: Path, collision: str
) -> None:
    """The simulated teacher looks at collisions, even if planning does not."""
    loaded = six(tmp_path, f"planner.collision={collision}")
    with pytest.raises(ScenarioError) as caught:
        preview(loaded)
    assert caught.value.message.startswith("robot.start: 'left' touches 'right' at the start")
    assert "robot.parked" in caught.value.remedy
    assert "ignore_collisions: [[left, right]]" in caught.value.remedy
    with pytest.raises(ScenarioError, match="'left' touches 'right'"):
        new_run(loaded, tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_the_arm_in_the_table_is_refused_as_well(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="'shoulder' touches 'table'") as caught:
        preview(six(tmp_path, robot=TOGETHER, shapes={"shoulder": BALL}))
    assert "[[shoulder, table]]" in caught.value.remedy


@pytest.mark.parametrize("robot", [TOGETHER, APART])
def test_each_remedy_helps(tmp_path: Path, robot: str) -> None:
    loaded = six(tmp_path, robot=robot)
    text = str(preview(loaded))
    assert "for 10,000 instances here" in text
    assert ("may touch  left and right" in text) is (robot == TOGETHER)
    run = new_run(loaded, tmp_path / "run")
    *_, end = run.events()
    assert isinstance(end, Finished)
    assert end.demonstrations
    said = "Whether these touch is not looked at: left and right."
    assert (said in run.certificate.statement) is (robot == TOGETHER)
    again = load_scenario(tmp_path / "run" / "scenario.yaml")
    assert dump_scenario(again) == dump_scenario(loaded)


def test_where_only_what_follows_looks_at_it_that_is_said(tmp_path: Path) -> None:
    changes = "planner.collision=false", "teacher={kind: interactive}"
    found = preview(six(tmp_path, *changes))
    assert found.touching_at_start == (("left", "right"),)
    assert "'left' touches 'right' at the start; collisions are left out here" in str(found)


def test_a_name_twice_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="'left' is there twice") as caught:
        six(tmp_path, robot="  ignore_collisions: [[left, right], [left, left]]")
    assert "robot.ignore_collisions.1" in caught.value.message


def test_what_keeps_the_teacher_from_it_is_told_everywhere(tmp_path: Path) -> None:
    """A post around which there is no way: the hand is in it at every place."""
    post = "{name: post, cylinder: {radius: 0.16, length: 1.0}, xyz: [0.6, 0.0, 0.5]}"
    changes = (
        f"obstacles=[{post}]",
        "robot.start=[2.5, 0.5, 1.9, 0.0, -0.83, 0.0]",
        "objects.0.x=[0.6, 0.61]",
        "objects.0.y=[0.0, 0.01]",
        "regions={grid: {x: 1, y: 1}}",
    )
    loaded = six(tmp_path, *changes, robot=APART)
    said = re.compile(r"collide \((left|right|bowl) with post in \d+ of them\)")
    found = preview(loaded)
    assert said.search(found.no_demonstration or "")
    assert f"time       unknown without a first demonstration: {found.no_demonstration}" in str(
        found
    )
    run = new_run(loaded, tmp_path / "run")
    *_, end = run.events()
    assert isinstance(end, Finished)
    assert said.search(end.reason)
    assert (tmp_path / "run" / "meshcat.html").stat().st_size > 0
    with pytest.raises(RunDirectoryError, match="ended before its first round") as caught:
        inspect_run(tmp_path / "run", Console(), html=tmp_path / "page.html")
    assert said.search(caught.value.message)
    assert "Wait" not in str(caught.value)


def test_the_remark_names_the_most_frequent_pair(tmp_path: Path) -> None:
    setup = Setup(six(tmp_path, robot=TOGETHER))
    object.__setattr__(setup.workcell, "collides", lambda q, X_WO: np.full(len(q), True))
    object.__setattr__(setup.workcell, "colliding_bodies", lambda q, X_WO: (("hand", "bowl"),))
    place = np.array([[0.6, 0.0, 0.0]])
    lesson = setup.teacher.demonstrate(
        Suggestion(0, place), number=0, used=(), rng=np.random.default_rng(0)
    )
    found = re.search(r"(\d+) collide \(hand with bowl in (\d+) of them\)", lesson.remark)
    assert found is not None
    assert found[1] == found[2]
