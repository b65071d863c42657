"""What a planner in a diagram plans with: the plans of `Setup.plan`, and nothing besides."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from drake_screw import Setup, load_scenario
from drake_screw.acquisition import Suggestion
from drake_screw.assembly.plan_chooser import PlanChooser
from drake_screw.execution import Phase, PlanningOutcome, ScrewPlanner, build_station
from drake_screw.execution.monitoring import apart
from drake_screw.planning import Cause
from drake_screw.runs.executions import planning_station
from drake_screw.screws import exp, rotation_angle

HERE, THERE = [[0.85, 0.3, 0.0]], [[0.9, 0.36, 0.0]]


@pytest.fixture(scope="module")
def setup() -> Setup:
    return Setup(load_scenario("pouring"))


@pytest.fixture(scope="module")
def demonstrations(setup):
    def learned(number: int, place: list[float]):
        rng, asked = np.random.default_rng(number), Suggestion(0, np.array([place]))
        lesson = setup.teacher.demonstrate(asked, number=number, used=(), rng=rng)
        return setup.learn(lesson.recording)

    return learned(0, [0.9, 0.2, 0.0]), learned(1, [0.8, 0.5, 0.0])


@pytest.fixture(scope="module")
def chooser(setup, demonstrations) -> PlanChooser:
    return PlanChooser(setup, demonstrations)


def test_it_chooses_what_a_run_would(setup, demonstrations, chooser) -> None:
    best = setup.plan(demonstrations, {"bowl": HERE[0][:2]})
    found = chooser.choose(setup.area.X_WO(HERE), setup.workcell.start)
    assert found.demonstration is best.demonstration
    np.testing.assert_array_equal(found.plan.q, best.plan.q)
    assert found.margins.min() == pytest.approx(best.margin, abs=1e-12)
    assert [str(turn) for turn in found.turned] == [str(turn) for turn in best.turned]


def test_it_chooses_from_where_the_arm_is(setup, demonstrations, chooser) -> None:
    start = setup.workcell.start + 0.1
    best = setup.plan(demonstrations, {"bowl": HERE[0][:2]}, start=start)
    found = chooser.choose(setup.area.X_WO(HERE), start)
    np.testing.assert_array_equal(found.plan.q, best.plan.q)


def test_it_keeps_demonstration_and_turn_where_the_object_goes(setup, chooser) -> None:
    chosen = chooser.choose(setup.area.X_WO(HERE), setup.workcell.start)
    kept = chooser.keep(chosen, setup.area.X_WO(THERE), setup.workcell.start)
    assert kept.demonstration is chosen.demonstration
    assert kept.variant == chosen.variant
    assert abs(kept.plan.angles - chosen.plan.angles).max() < 0.2
    X_WO = setup.symmetries.turned(setup.area.X_WO(THERE), kept.plan.angles[:-1])
    expected = kept.demonstration.transfer(X_WO)
    np.testing.assert_allclose(kept.plan.guides, expected, atol=1e-9)
    again = chooser.keep(kept, setup.area.X_WO(HERE), setup.workcell.start)
    np.testing.assert_array_equal(again.plan.q, chosen.plan.q)


def test_a_failure_says_where_the_best_attempt_ended(setup, demonstrations, chooser) -> None:
    X_WO = setup.area.X_WO([[1.6, 0.3, 0.0]])
    outcomes = setup.careful_planner.all_outcomes(demonstrations, X_WO[None], setup.workcell.start)
    best = int(outcomes[0].best_attempt)
    found = chooser.choose(X_WO, setup.workcell.start)
    assert isinstance(found, PlanningOutcome)
    assert found.cause == outcomes[0].cause[best]
    assert found.segment == outcomes[0].segment[best]
    assert found.demonstration == demonstrations[best].name
    kept = chooser.keep(
        chooser.choose(setup.area.X_WO(HERE), setup.workcell.start), X_WO, setup.workcell.start
    )
    assert isinstance(kept, PlanningOutcome)
    assert kept.cause in (Cause.UNREACHABLE, Cause.JOINT_LIMIT)


def test_paths_through_the_bowl_are_not_free(setup, chooser) -> None:
    found = chooser.choose(setup.area.X_WO(HERE), setup.workcell.start)
    assert chooser.free(found.plan.q, setup.area.X_WO(HERE))
    hand = setup.workcell.arm.pose(found.plan.q[len(found.plan.q) // 2])[:3, 3]
    in_the_way = setup.area.X_WO(HERE).copy()
    in_the_way[0, :3, 3] = hand
    assert not chooser.free(found.plan.q, in_the_way)


def test_turning_a_bowl_about_its_axis_is_not_moving_it(setup, chooser) -> None:
    X_WO = setup.area.X_WO(HERE)
    turned = X_WO @ exp([0.0, 0.0, 0.7, 0.0, 0.0, 0.0])
    far, angle = chooser.apart(X_WO, turned)
    assert far[0] == pytest.approx(0.0, abs=1e-12)
    assert angle[0] == pytest.approx(0.0, abs=1e-12)
    tilted = X_WO @ exp([0.1, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert chooser.apart(X_WO, tilted)[1] == pytest.approx(rotation_angle(X_WO, tilted), abs=1e-9)
    assert chooser.apart(X_WO, setup.area.X_WO(THERE))[0] == pytest.approx(np.hypot(0.05, 0.06))


def test_without_demonstrations_there_is_nothing_to_choose_from(setup) -> None:
    with pytest.raises(ValueError, match="at least one demonstration"):
        PlanChooser(setup, ())


def test_in_a_station_a_bowl_that_is_pushed_is_poured_into_where_it_ends(
    setup, demonstrations
) -> None:
    """10 cm in half a second, with the arm's dynamics."""
    station = planning_station(setup, demonstrations[:1])
    arm, planner = station.arm, station.diagram.GetSubsystemByName("planner")
    root = station.context(setup.workcell.start, setup.area.X_WO(HERE))
    simulator = Simulator(station.diagram, root)
    simulator.AdvanceTo(0.8)
    pushed = np.array([0.06, 0.08, 0.0])
    for part in np.linspace(0.1, 1.0, 10):
        station.place(root, setup.area.X_WO(HERE + part * pushed))
        simulator.AdvanceTo(root.get_time() + 0.05)
    X_WO = setup.area.X_WO(HERE + pushed)

    def says(port: str):
        return station.diagram.GetOutputPort(port).Eval(root)

    while not says("status").ended and root.get_time() < 15.0:
        simulator.AdvanceTo(root.get_time() + 0.25)
    assert says("status").phase is Phase.DONE
    assert planner.GetOutputPort("replans").Eval(planner.GetMyContextFromRoot(root))[0] >= 8
    choice = says("choice")
    X_WG = setup.symmetries.guides(choice.demonstration, X_WO, choice.plan.angles)[-1]
    log, commands = station.measured.FindLog(root), station.desired.FindLog(root)
    far, turned = apart(arm.pose(log.data()[: arm.n, -1]), X_WG)
    assert far < 5e-3
    assert turned < 20e-3
    v = commands.data()[arm.n :, np.diff(commands.sample_times(), prepend=-1.0) > 1e-6].T
    assert np.abs(np.diff(v, axis=0) / arm.velocity_limits).max() < 0.05
    assert says("margins").min() > 0.0


def test_plans_that_go_over_into_one_another_are_not_played_by_the_clock(setup, chooser) -> None:
    with pytest.raises(ValueError, match="an executor that follows screws"):
        build_station(setup.robot, planner=ScrewPlanner(chooser), follow_screws=False)
