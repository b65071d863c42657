"""A short lift that belongs to the arm: demonstrated, planned, executed; and its units."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drake_screw import Setup, load_scenario
from drake_screw.acquisition import Finished
from drake_screw.assembly.preview import preview
from drake_screw.demonstrations import Recording
from drake_screw.demonstrations.recording import checked
from drake_screw.errors import ScenarioError
from drake_screw.execution import TimedPlan, build_station, simulate, time_plan
from drake_screw.planning import ReferencePlanner
from drake_screw.runs.executions import execute
from drake_screw.runs.run import new_run
from drake_screw.scenario.loader import dump_scenario, load_stored_scenario
from drake_screw.scenario.schema import Scenario
from drake_screw.screws import pose
from tests.robot.six_joints import NAMES, START, scenario, urdf

JOINTS = ("lift", *NAMES)


def lifted(
    folder: Path, at: float | None, *changes: str, range: tuple[float, float] = (0.0, 0.25)
) -> Scenario:
    (folder / "six.urdf").write_text(urdf(transmissions=JOINTS[::-1], lift=range))
    (folder / "six.yaml").write_text(scenario(lift=at))
    return load_scenario(folder / "six.yaml", changes)


@pytest.mark.slow
@pytest.mark.parametrize("at", [0.1, 0.003])
def test_it_is_taught_certified_and_executed(tmp_path: Path, at: float) -> None:
    least_norm = preview(lifted(tmp_path, at))
    assert least_norm.plans_per_second is not None
    assert "planner.redundancy: away_from_limits" in str(least_norm)
    changes = "planner.redundancy=away_from_limits", "planner.slide_margin=0.001"
    loaded = lifted(tmp_path, at, *changes)
    assert preview(loaded).hints == ()
    *_, end = new_run(loaded, tmp_path / "run").events()
    assert isinstance(end, Finished)
    assert end.status == "certified", end.reason
    done = execute(tmp_path / "run", instance=[0.6, 0.1], workers=1)
    assert done.summary.flawless == 1, str(done)
    worst = done.summary.worst
    assert worst is not None
    assert worst.unit == ("m" if worst.joint == "lift" else "rad")
    assert f"least joint margin         {worst.joint_margin:.4f} {worst.unit}" in str(done)


@pytest.mark.parametrize(
    ("at", "said", "inside"),
    [
        (0.0, "lift starts at 0.0000 m, on its limits 0.0000 .. 0.2500 m", "at 0.005 m say"),
        (0.25, "lift starts at 0.2500 m, on its limits", "at 0.245 m say"),
        (0.4, "lift starts at 0.4000 m, outside its limits", "at 0.245 m say"),
    ],
)
def test_a_start_at_the_end_is_told_in_metres_with_the_remedy(
    tmp_path: Path, at: float, said: str, inside: str
) -> None:
    with pytest.raises(ScenarioError) as caught:
        _ = Setup(lifted(tmp_path, at)).workcell
    assert said in caught.value.message
    assert inside in caught.value.remedy
    assert "robot.parked" in caught.value.remedy


def test_a_parked_lift_may_rest_on_its_limit(tmp_path: Path) -> None:
    loaded = lifted(tmp_path, None, "robot.parked={lift: 0.0}")
    assert Setup(loaded).workcell.arm.n == 6


def test_margins_of_slides_and_hinges_are_apart(tmp_path: Path) -> None:
    margins = "planner.joint_margin=0.15", "planner.slide_margin=0.01"
    setup = Setup(lifted(tmp_path, 0.1, *margins))
    chain, arm = setup.batch_planner.chain, setup.workcell.arm
    np.testing.assert_allclose(chain.lower - arm.lower, [0.01, *[0.15] * 6])
    with pytest.raises(ScenarioError, match=r"planner.slide_margin: 0.2 m to either side leave"):
        _ = Setup(lifted(tmp_path, 0.1, "planner.slide_margin=0.2")).workcell
    with pytest.raises(ScenarioError, match=r"a planner.slide_margin of 0.11 m kept"):
        _ = Setup(lifted(tmp_path, 0.1, "planner.slide_margin=0.11")).workcell


def test_a_stored_scenario_from_when_they_were_one_keeps_its_meaning(tmp_path: Path) -> None:
    written = dump_scenario(lifted(tmp_path, 0.1, "planner.joint_margin=0.02"))
    file = tmp_path / "stored.yaml"
    file.write_text(re.sub(r",? *slide_margin: 0.0", "", written))
    assert "slide_margin" not in file.read_text()
    assert load_stored_scenario(file).planner.slide_margin == 0.02
    assert load_scenario(file).planner.slide_margin == 0.0


def test_executions_speak_of_a_slide_in_metres(tmp_path: Path) -> None:
    station = build_station(Setup(lifted(tmp_path, 0.1)).robot)
    arm, q_start = station.arm, np.array([0.1, *START])
    X = arm.pose(q_start)
    guide = X @ pose(np.eye(3), [0.0, 0.05, -0.05])
    plan = ReferencePlanner(arm, step=0.02).plan(q_start, guide[None])
    timed = time_plan(plan, np.stack([X, guide]), arm)
    v = np.abs(timed.segments[0].v[:, 0])
    assert (np.diff(v) / timed.segments[0].period).max() <= 0.5 * 1.01
    none = np.empty((0, 4, 4))
    assert simulate(station, timed, none).report.flawless
    up = np.eye(arm.n)[0]
    away = simulate(station, timed, none, q_start + 0.01 * up).report
    assert "lift is 0.010 m away" in away.status.reason
    beyond = replace(timed.segments[0], q=timed.segments[0].q + 0.2 * up)
    left = simulate(station, TimedPlan((beyond,)), none, q_start).report
    assert re.search(r"leaves the limits of lift by 0\.\d+ m$", left.status.reason)


def test_recordings_speak_of_a_slide_in_millimetres() -> None:
    t = np.linspace(0.0, 1.0, 101)
    q = np.column_stack([-0.0005 + 0.1 * t, 0.5 + 0.5005 * t])
    made = Recording("one", ("lift", "turn"), t, q, np.eye(4)[None])
    limits = np.array([0.0, 0.0]), np.array([0.2, 1.0])
    found = checked(made, *limits, units=("m", "rad"))
    assert found.notes == (
        "clamped turn to the limit (beyond it by 0.50 mrad)",
        "clamped lift to the limit (beyond it by 0.50 mm)",
    )


def test_a_slide_with_much_friction_is_driven_all_the_same(tmp_path: Path) -> None:
    """As of a torso that holds itself: 20,000 N s/m."""
    robot = Setup(lifted(tmp_path, 0.1)).robot
    stuck = "<child link='column'/><dynamics damping='20000'/>"
    text = urdf(transmissions=NAMES, lift=(0.0, 0.25)).replace("<child link='column'/>", stuck)
    (tmp_path / "six.urdf").write_text(text)
    station = build_station(robot)
    X = station.arm.pose(q_start := np.array([0.1, *START]))
    guide = X @ pose(np.eye(3), [0.0, 0.05, -0.05])
    plan = ReferencePlanner(station.arm, step=0.02).plan(q_start, guide[None])
    timed = time_plan(plan, np.stack([X, guide]), station.arm)
    report = simulate(station, timed, np.empty((0, 4, 4))).report
    assert report.flawless, str(report.status)
    assert report.tracking.position < 2e-3
