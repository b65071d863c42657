"""Two objects that both matter: a cup is fetched where it stands, and emptied where the bowl is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw import Setup
from drake_screw.acquisition import Finished, Suggestion
from drake_screw.acquisition.simulated import SimulatedTeacher
from drake_screw.acquisition.simulated.motions import CUP, GRIP
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import ScenarioError
from drake_screw.runs.executions import execute
from drake_screw.runs.run import new_run, open_run
from drake_screw.runs.trajectory import write_trajectory
from drake_screw.scenario.loader import load_scenario
from drake_screw.screws import inverse

SHOWN = np.array([[0.74, 0.62, 0.0], [0.85, 0.1, 0.0]])


@pytest.fixture(scope="module")
def setup() -> Setup:
    return Setup(load_scenario("fetching"))


@pytest.fixture(scope="module")
def learned(setup: Setup) -> Demonstration:
    rng = np.random.default_rng(0)
    lesson = setup.teacher.demonstrate(Suggestion(0, SHOWN), number=0, used=(), rng=rng)
    assert lesson.recording is not None, lesson.remark
    return setup.learn(lesson.recording)


def test_guiding_poses_belong_to_the_cup_first_and_then_to_the_bowl(
    setup: Setup, learned: Demonstration
) -> None:
    owners = learned.objects.tolist()
    assert owners == sorted(owners)
    assert set(owners) == {0, 1}
    assert [kept.object for kept in learned.fidelity] == ["cup", "bowl"]


def test_a_plan_grasps_the_cup_where_it_stands_and_pours_where_the_bowl_is(
    setup: Setup, learned: Demonstration
) -> None:
    arm, p_EG = setup.workcell.arm, np.array([0.0, 0.0, CUP, 1.0])
    for cup, bowl in (((0.70, 0.7), (0.9, 0.0)), ((0.74, 0.62), (0.8, 0.2))):
        best = setup.plan([learned], {"cup": cup, "bowl": bowl}, most=1)
        gripped = (arm.pose(best.plan.q) @ p_EG)[:, :3]
        (X_WC, X_WB), away = setup.area.X_WO([[*cup, 0.0], [*bowl, 0.0]]), []
        away = np.linalg.norm(gripped - (X_WC[:3, 3] + [0.0, 0.0, GRIP]), axis=1)
        assert away.min() < 0.012
        after = arm.pose(best.plan.q[int(away.argmin()) :])
        near = (inverse(X_WB) @ after)[:, :3, 3]
        tilted = np.degrees(np.arccos(np.clip(-after[:, 2, 0], -1.0, 1.0)))
        pouring = int(tilted.argmax())
        assert 60.0 < tilted[pouring] < 115.0
        assert np.linalg.norm(near[pouring, :2]) < 0.2
        assert 0.08 < near[pouring, 2] < 0.2


def test_the_hand_may_touch_the_cup_alone(setup: Setup) -> None:
    pairs = {frozenset(setup.workcell.touching(i)) for i in range(len(setup.workcell.pairs))}
    assert frozenset({"left_hand", "cup"}) not in pairs
    assert frozenset({"left_wrist", "cup"}) in pairs
    assert frozenset({"left_hand", "bowl"}) in pairs
    assert frozenset({"tool", "bowl"}) in pairs
    assert frozenset({"tool", "table"}) not in pairs


def test_a_motion_that_needs_more_objects_says_so() -> None:
    one = Setup(load_scenario("pouring"))
    with pytest.raises(ScenarioError, match="'fetching' works on 2 objects, and there is 1"):
        SimulatedTeacher(one.workcell, one.area, "fetching")


@pytest.mark.slow
def test_it_certifies_executes_and_exports(tmp_path: Path) -> None:
    run = new_run(load_scenario("fetching"), tmp_path / "run")
    (*_, end) = run.events()
    assert isinstance(end, Finished)
    assert end.status == "certified"
    words = " ".join(open_run(tmp_path / "run").directory.record.certificate.statement)
    assert "Whether these touch is not looked at: left_hand and cup, what the hand holds" in words
    place = {"cup": (0.75, 0.6), "bowl": (0.85, 0.1)}
    found = execute(tmp_path / "run", instance=place, workers=1)
    assert found.summary.flawless == 1
    written = write_trajectory(tmp_path / "run", place, "baxter-csv", tmp_path / "plan.csv")
    assert written.segments >= 8
    assert not written.outside
