"""Robots that lack collision shapes of their model: told of, and not certified unless wanted."""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from drake_screw.acquisition import Finished, Status
from drake_screw.assembly.preview import preview
from drake_screw.assembly.setup import Setup
from drake_screw.errors import ScenarioError
from drake_screw.runs.certifying import certificate
from drake_screw.scenario.loader import load_scenario
from drake_screw.scenario.schema import Scenario
from tests.robot.small_arms import PLANAR, sdf

TEXT = """\
name: small
robot: {model: arm.sdf, joints: [p1, p2, p3], end_effector: hand, start: [0.3, 0.3, 0.3]}
objects:
  - {name: bowl, x: [0.5, 0.7], y: [-0.1, 0.1], z: 0.5, radius: 0.05, height: 0.05}
regions: {grid: {}}
teacher: {kind: interactive}
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    mesh = "<mesh><uri>gone.obj</uri></mesh>"
    text = sdf(PLANAR, shapes={"p2_link": mesh, "p3_link": mesh})
    look = "<visual name='v'><geometry><mesh><uri>gone.dae</uri></mesh></geometry></visual>"
    (tmp_path / "arm.sdf").write_text(text.replace("<collision", f"{look}<collision", 1))
    (tmp_path / "small.yaml").write_text(TEXT)
    return tmp_path / "small.yaml"


def scenario(file: Path, **planner: bool) -> Scenario:
    return load_scenario(file, [f"planner.{k}={str(v).lower()}" for k, v in planner.items()])


def test_collisions_are_not_looked_at_with_half_the_shapes(file: Path) -> None:
    with pytest.raises(
        ScenarioError, match="collision shapes of the robot cannot be had"
    ) as caught:
        _ = Setup(scenario(file)).workcell
    assert "link 'p2_link': the mesh 'gone.obj' does not exist" in str(caught.value)
    assert "incomplete_shapes: true" in str(caught.value.remedy)


@pytest.mark.parametrize("planner", [{"collision": False}, {"incomplete_shapes": True}])
def test_check_tells_what_is_missing(file: Path, planner: dict[str, bool]) -> None:
    text = str(preview(scenario(file, **planner)))
    assert "collision checks are incomplete; these shapes of the robot are missing" in text
    assert "link 'p3_link': the mesh 'gone.obj' does not exist" in text
    assert "1 mesh of the robot is not shown, such as: link 'p2_link': the mesh 'gone.dae'" in text


def test_the_certificate_names_the_links(file: Path) -> None:
    finished = Finished(Status.INSUFFICIENT, "stopped", None, ())

    def made(**planner: bool) -> tuple[tuple[str, ...], str]:
        stated = certificate(Setup(scenario(file, **planner)), finished)
        return stated.incomplete_shapes, stated._scope()

    links, scope = made(incomplete_shapes=True)
    assert links == ("p2_link", "p3_link")
    assert "collision shapes of theirs could not be had: p2_link, p3_link." in scope
    assert "p2_link" not in made(collision=False)[1]


def test_checks_of_what_is_executed_warn(file: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "drake_screw"):
        _ = Setup(scenario(file, collision=False)).careful_planner
    assert "collision checks are incomplete: shapes are missing of p2_link, p3_link" in caplog.text
