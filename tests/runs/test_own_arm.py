"""The arm of docs/another_robot.md, as a reader would try it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from drake_screw.acquisition import Finished
from drake_screw.assembly.preview import preview
from drake_screw.errors import ModelError
from drake_screw.runs.executions import execute
from drake_screw.runs.run import new_run
from drake_screw.scenario.loader import load_scenario

PAGE = Path(__file__).parents[2] / "docs" / "another_robot.md"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Model and scenario as printed on the page."""
    folder = tmp_path_factory.mktemp("own")
    for language, name in (("xml", "my_arm.urdf"), ("yaml", "my_arm.yaml")):
        blocks = re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(), re.DOTALL)
        text = next(block for block in blocks if re.search(r"name[:=] ?\"?my_arm", block))
        (folder / name).write_text(text)
    return folder


@pytest.fixture(scope="module")
def finished(folder: Path) -> Path:
    *_, end = new_run(load_scenario(folder / "my_arm.yaml"), folder / "first").events()
    assert isinstance(end, Finished)
    assert end.status == "certified"
    assert len(end.demonstrations) == 2
    return folder / "first"


def test_the_check_tells_of_arm_and_recorder(folder: Path) -> None:
    text = str(preview(load_scenario(folder / "my_arm.yaml")))
    assert "my_arm, 6 joints, end effector 'hand', reach 1.02 m" in text
    assert "recordings named in the scenario would be on baxter, 7 joints" in text
    assert "note" not in text


def test_its_plans_are_executed(finished: Path) -> None:
    text = str(execute(finished, instance=[0.6, 0.1], workers=1))
    assert "1 instance, 1 executed" in text
    assert re.search(r"with contact +0\n", text)


def test_without_inertia_it_is_planned_for_but_not_executed(folder: Path, tmp_path: Path) -> None:
    urdf = (folder / "my_arm.urdf").read_text()
    light, removed = re.subn(r"<inertial>.*?</inertial>", "", urdf, flags=re.DOTALL)
    assert removed == 7
    (tmp_path / "light.urdf").write_text(light)
    changes = [f"robot.model={tmp_path / 'light.urdf'}", "demonstrations.budget=1"]
    scenario = load_scenario(folder / "my_arm.yaml", changes)
    for _ in new_run(scenario, tmp_path / "run").events():
        pass
    with pytest.raises(ModelError, match="joint 'turn' cannot be driven") as caught:
        execute(tmp_path / "run", instance=[0.6, 0.1], workers=1)
    assert "inertial" in (caught.value.remedy or "")
