"""A scenario with a pole in the way: judged, looked at, executed and exported by the same plan."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from drake_screw.assembly.preview import preview
from drake_screw.assembly.setup import Setup
from drake_screw.errors import RunDirectoryError
from drake_screw.planning import Cause, connection
from drake_screw.runs.executions import execute
from drake_screw.runs.run import Run, new_run, open_run
from drake_screw.runs.trajectory import write_trajectory
from drake_screw.scenario.loader import load_scenario
from drake_screw.scenario.schema import Scenario
from drake_screw.visualization.attempt import attempt, collided, headline
from tests.planning.pole_in_the_way import CLOSED, PASSABLE, POLE, START, lesson_of, robot_in

AT = {"pole": tuple(PASSABLE[0, :2, 3].tolist())}


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    folder = tmp_path_factory.mktemp("pole")
    robot = robot_in(folder)
    (folder / "pole.yaml").write_text(
        f"""
name: pole
robot:
  model: {robot.model}
  joints: [{", ".join(robot.joints)}]
  end_effector: hand
  start: {START.tolist()}
objects:
  - {{name: pole, x: [0.3, 0.75], y: [0, 0.1], yaw: 0, z: {PASSABLE[0, 2, 3]},
     radius: {POLE.radius}, height: {POLE.height}}}
regions: {{grid: {{x: 1}}}}
coverage: {{beta: 0.9, epsilon: 0.05, delta: 0.05}}
demonstrations: {{initial: 1, budget: 2}}
teacher: {{kind: interactive}}
planner: {{approach: free, collision: true}}
"""
    )
    return load_scenario(folder / "pole.yaml")


@pytest.fixture(scope="module")
def setup(scenario: Scenario) -> Setup:
    return Setup(scenario)


def test_a_setup_has_the_plan_that_its_planner_judged(setup: Setup) -> None:
    pytest.importorskip("ompl")
    lesson = lesson_of(setup.workcell, PASSABLE)
    found = setup.planner.all_outcomes([lesson], PASSABLE[None], START)[0, 0]
    assert found.success
    plan = setup.judged_plan(lesson, PASSABLE, found)
    assert plan.success
    assert setup.planner.checker.free(plan.q, PASSABLE)


def test_a_collision_is_shown_on_the_straight_approach(setup: Setup) -> None:
    lesson, workcell = lesson_of(setup.workcell, CLOSED), setup.workcell
    found = setup.planner.all_outcomes([lesson], CLOSED[None], START)[0, 0]
    assert found.cause == Cause.COLLISION
    plan = setup.judged_plan(lesson, CLOSED, found)
    assert plan.success
    tried = collided(attempt(workcell.arm, 0, lesson, CLOSED, plan), found, workcell)
    assert len(tried.plan.q) < len(plan.q)
    assert "pole" in headline(tried)


def test_a_planner_of_ones_own_may_give_plans(scenario: Scenario, setup: Setup) -> None:
    class Own:
        def all_outcomes(self, *_: object) -> None: ...
        def any_success(self, *_: object) -> None: ...

    class WithPlans(Own):
        def plan(self, demonstration, X_WO, q_start, variant=0):
            return "its own", variant

    lesson = lesson_of(setup.workcell, PASSABLE)
    found = setup.batch_planner.all_outcomes([lesson], PASSABLE[None], START)[0, 0]
    assert found.success
    plain = Setup(scenario, planner=lambda _: Own())
    assert plain.judged_plan(lesson, PASSABLE, found).success
    own = Setup(scenario, planner=lambda _: WithPlans())
    assert own.judged_plan(lesson, PASSABLE, found) == ("its own", int(found.variant))


def test_it_is_executed_and_exported(
    scenario: Scenario, setup: Setup, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("ompl")
    lesson, arm = lesson_of(setup.workcell, PASSABLE), setup.workcell.arm
    monkeypatch.setattr(Run, "demonstrations", (lesson,))
    new_run(scenario, tmp_path / "run", teacher=lambda _: SimpleNamespace())
    text = str(execute(tmp_path / "run", instance=AT, workers=1))
    assert "1 instance, 1 executed" in text
    assert re.search(r"with contact +0\n", text)

    exported = []

    def keep(timed, of):
        exported.append(timed)
        return b""

    monkeypatch.setattr("drake_screw.runs.trajectory.find", lambda *_: keep)
    write_trajectory(tmp_path / "run", AT, "npz", tmp_path / "plan.npz")
    _, q, _ = exported[0].sampled(5e-3)
    np.testing.assert_allclose(q[0], START, atol=1e-9)
    np.testing.assert_allclose(arm.pose(q[-1]), lesson.transfer(PASSABLE)[-1], atol=2e-3)
    assert not setup.workcell.collides(q, PASSABLE).any()


def test_check_says_what_ompl_would_be_good_for(
    scenario: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("ompl")
    assert "ompl" not in str(preview(scenario))
    monkeypatch.setattr(connection, "available", lambda: False)
    found = preview(scenario)
    assert found.lacks_ompl
    assert "pip install 'drake-screw[ompl]'" in str(found)
    screws = scenario.model_copy(
        update={"planner": scenario.planner.model_copy(update={"approach": "screw"})}
    )
    assert not preview(screws).lacks_ompl


def test_whether_the_arm_is_led_around_is_a_matter_of_a_free_approach_that_may_touch(
    scenario: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    def led(there: bool, **changes: object) -> bool | None:
        monkeypatch.setattr(connection, "available", lambda: there)
        planner = scenario.planner.model_copy(update=changes)
        return Setup(scenario.model_copy(update={"planner": planner})).leads_around

    assert led(True) is True
    assert led(False) is False
    assert led(True, approach="screw") is None
    assert led(True, collision=False) is None
    assert Setup(scenario, planner=lambda _: SimpleNamespace()).leads_around is None


@pytest.mark.parametrize(
    ("before", "said"),
    [(True, r"begun with OMPL.*not installed now"), (False, r"begun without OMPL.*installed now")],
)
def test_a_run_goes_on_only_where_the_arm_is_led_around_as_before(
    scenario: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, before: bool, said: str
) -> None:
    class Leaving:
        def demonstrate(self, *_: object, **__: object) -> None:
            raise KeyboardInterrupt

    def carry_on(there: bool) -> None:
        monkeypatch.setattr(connection, "available", lambda: there)
        list(open_run(tmp_path / "run", teacher=lambda _: Leaving()).events())

    monkeypatch.setattr(connection, "available", lambda: before)
    run = new_run(scenario, tmp_path / "run", teacher=lambda _: Leaving())
    assert run.directory.record.led_around is before
    with pytest.raises(KeyboardInterrupt):
        carry_on(before)
    record = (tmp_path / "run" / "run.json").read_text()
    with pytest.raises(RunDirectoryError, match=said) as error:
        carry_on(not before)
    assert "run the scenario again" in str(error.value.remedy).lower()
    assert (tmp_path / "run" / "run.json").read_text() == record
    old = record.replace(f'"led_around": {str(before).lower()}', '"led_around": null')
    assert old != record
    (tmp_path / "run" / "run.json").write_text(old)
    with pytest.raises(KeyboardInterrupt):
        carry_on(not before)


def test_the_certificate_of_a_run_says_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "available", lambda: False)
    changes = ["planner.approach=free", "planner.collision=true", "regions.grid={x: 1}"]
    goal = ["coverage.beta=0.5", "coverage.epsilon=0.2", "demonstrations.budget=1"]
    run = new_run(load_scenario("pouring", [*changes, *goal]), tmp_path / "run")
    for _ in run.events():
        pass
    stated = open_run(tmp_path / "run").certificate
    assert stated is not None
    assert (stated.approach, stated.led_around) == ("free", False)
    assert "without OMPL" in " ".join(stated.statement)
