"""What a scenario asks to be kept: from all else and itself, and from the joint limits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw import Setup, load_scenario
from drake_screw.errors import ScenarioError
from drake_screw.planning import Cause, connection
from drake_screw.scenario.schema import Scenario
from tests.assembly.test_surroundings import scenario_in
from tests.planning.pole_in_the_way import AWAY, BALL, START, lesson_of
from tests.robot.small_arms import PLANAR, sdf

BESIDE = "{name: post, cylinder: {radius: 0.05, length: 0.6}, xyz: [0.8, 0, 0.5]}"
"""Out of reach of the balls on the arm, but the second one passes 0.32 m away."""


@pytest.fixture(autouse=True)
def _straight(monkeypatch: pytest.MonkeyPatch) -> None:
    """No ways around."""
    monkeypatch.setattr(connection, "available", lambda: False)


def kept_in(folder: Path, *changes: str) -> Scenario:
    """The planar arm beside a post, with more to be kept."""
    return load_scenario(scenario_in(folder, BESIDE).source, changes)


@pytest.mark.parametrize(("clearance", "free"), [(0.0, True), (0.01, True), (0.35, False)])
def test_a_clearance_is_kept_or_the_plan_fails(
    tmp_path: Path, clearance: float, free: bool
) -> None:
    setup = Setup(kept_in(tmp_path, f"planner.clearance={clearance}"))
    lesson = lesson_of(setup.workcell, AWAY)
    outcome = setup.evaluate([lesson], [[-1.0, -1.0]])[0, 0]
    assert outcome.cause == (Cause.SUCCESS if free else Cause.COLLISION)
    plan = setup.batch_planner.plan(lesson, AWAY, START, int(outcome.variant) if free else 0)
    q = np.concatenate([np.linspace(a, b, 20) for a, b in zip(plan.q, plan.q[1:], strict=False)])
    near = setup.workcell.collides(
        q, AWAY, checker=setup.workcell.keeping(clearance) if clearance else None
    )
    assert near.any() != free
    assert setup.careful_planner.checker.free(plan.q, AWAY) == free
    if not free:
        assert setup.workcell.touching(int(outcome.pair))[1] == "post"


@pytest.mark.parametrize("value", ["-0.1", "1.5", "wide"])
def test_a_clearance_that_cannot_be_is_refused(tmp_path: Path, value: str) -> None:
    with pytest.raises(ScenarioError, match=r"planner\.clearance"):
        kept_in(tmp_path, f"planner.clearance={value}")


def test_a_clearance_needs_collisions_to_be_looked_at(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="collisions are not looked at") as caught:
        kept_in(tmp_path, "planner.clearance=0.01", "planner.collision=false")
    assert "collision: true" in str(caught.value)


def test_a_start_nearer_than_the_clearance_is_refused(tmp_path: Path) -> None:
    """No plan could succeed; by the post, or by another part of the robot."""
    with pytest.raises(ScenarioError) as caught:
        _ = Setup(kept_in(tmp_path, "planner.clearance=0.6")).workcell
    assert "planner.clearance" in caught.value.message
    assert "at the start" in caught.value.message
    assert "robot.start" in caught.value.remedy


def test_a_start_that_touches_itself_is_refused(tmp_path: Path) -> None:
    """The last ball touches the one that the arm stands on."""
    scenario = kept_in(tmp_path, f"robot.start=[{START[0]}, 2.49, 0.0]")
    _ = Setup(scenario).workcell
    big = "<sphere><radius>0.53</radius></sphere>"
    shapes = {"base": big, "p2_link": BALL, "p3_link": BALL}
    Path(str(scenario.robot.model)).write_text(sdf(PLANAR, shapes=shapes))
    with pytest.raises(ScenarioError) as caught:
        _ = Setup(scenario).workcell
    assert caught.value.file == scenario.source
    assert caught.value.message.startswith("robot.start: ")
    assert "'base'" in caught.value.message
    assert "'p3_link'" in caught.value.message
    assert "planner.collision: false" in caught.value.remedy
    loose = load_scenario(
        scenario.source,
        ["planner.collision=false", "obstacles=[]", f"robot.start=[{START[0]}, 2.49, 0.0]"],
    )
    _ = Setup(loose).workcell


@pytest.mark.parametrize(("margin", "kept"), [(0.0, True), (1.5, True), (1.7, False)])
def test_a_joint_margin_is_kept_or_the_plan_fails(
    tmp_path: Path, margin: float, kept: bool
) -> None:
    """The first joint turns from -0.7 to 0.9 rad, of 2.5 that it could."""
    changes = f"planner.joint_margin={margin}", "robot.start=[-0.7, 0.3, 0.2]"
    setup = Setup(kept_in(tmp_path, *changes, "planner.ik_seeds=1"))
    chain, arm = setup.batch_planner.chain, setup.workcell.arm
    np.testing.assert_allclose(chain.lower, arm.lower + margin)
    np.testing.assert_allclose(chain.upper, arm.upper - margin)
    lesson = lesson_of(setup.workcell, AWAY)
    outcome = setup.evaluate([lesson], [[-1.0, -1.0]])[0, 0]
    assert outcome.success == kept
    if kept:
        plan = setup.batch_planner.plan(lesson, AWAY, setup.workcell.start, int(outcome.variant))
        assert np.minimum(plan.q - arm.lower, arm.upper - plan.q).min() >= margin


def test_a_start_within_the_joint_margin_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError) as caught:
        _ = Setup(kept_in(tmp_path, "planner.joint_margin=1.65")).workcell
    assert "robot.start: p1 starts at -0.9000 rad" in caught.value.message
    assert "a planner.joint_margin of 1.65 rad kept" in caught.value.message


def test_a_joint_margin_that_leaves_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError) as caught:
        _ = Setup(kept_in(tmp_path, "planner.joint_margin=2.6")).workcell
    assert "2.6 rad to either side leave nothing of the range of p1" in caught.value.message
    assert caught.value.remedy == "Choose a smaller margin."
