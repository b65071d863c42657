"""The best plan for an instance: of all demonstrations and turns, with its alternatives."""

from __future__ import annotations

import itertools
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from drake_screw.acquisition import Suggestion
from drake_screw.assembly.ranked_plans import RankedPlan
from drake_screw.assembly.setup import Setup
from drake_screw.errors import RunDirectoryError, ScenarioError
from drake_screw.planning import Outcomes
from drake_screw.runs.run import new_run, open_run
from drake_screw.scenario.loader import load_scenario
from tests.small_runs import finished_run

__all__ = ["finished_run"]

PLACE = {"bowl": (0.85, 0.3)}


@pytest.fixture(scope="module")
def setup() -> Setup:
    return Setup(load_scenario("pouring"))


@pytest.fixture(scope="module")
def demonstrations(setup: Setup):
    learned = []
    for i, place in enumerate([(0.9, 0.2, 0.0), (0.8, 0.5, 0.0)]):
        lesson = setup.teacher.demonstrate(
            Suggestion(0, np.array([place])), number=i, used=(), rng=np.random.default_rng(i)
        )
        learned.append(setup.learn(lesson.recording))
    return tuple(learned)


@pytest.fixture(scope="module")
def best(setup: Setup, demonstrations) -> RankedPlan:
    return setup.plan(demonstrations, PLACE)


def least_margin(setup: Setup, q: np.ndarray) -> float:
    arm = setup.workcell.arm
    part = np.minimum(q - arm.lower, arm.upper - q) / (arm.upper - arm.lower)
    return float(part.min())


def test_the_best_plan_has_the_largest_margin_of_all_that_touch_nothing(
    setup: Setup, demonstrations, best: RankedPlan
) -> None:
    """By going through all demonstrations and turns, and asking the checker about each plan."""
    X_WO = setup.area.X_WO([[[*PLACE["bowl"], 0.0]]])
    margins = []
    for lesson in demonstrations:
        found = setup.batch_planner.variant_outcomes(lesson, X_WO, setup.workcell.start)
        for variant in np.flatnonzero(found.success[0]):
            plan = setup.batch_planner.plan(lesson, X_WO[0], setup.workcell.start, int(variant))
            if setup.careful_planner.checker.free(plan.q, X_WO[0]):
                margins.append(least_margin(setup, plan.q))
    assert len(margins) > 3
    ranked = [best, *best.alternatives]
    assert len(ranked) == min(5, len(margins))
    found_margins = [one.margin for one in ranked]
    np.testing.assert_allclose(found_margins, sorted(margins, reverse=True)[: len(ranked)])
    assert best.margin == pytest.approx(least_margin(setup, best.plan.q))
    assert best.margins[best.tightest] == best.margin
    for a, b in itertools.pairwise(ranked):
        assert (a.margin, a.clearance, -a.length) >= (b.margin, b.clearance, -b.length)


def test_it_is_a_motion_in_time_that_ends_on_the_last_guiding_pose(
    setup: Setup, best: RankedPlan
) -> None:
    arm = setup.workcell.arm
    assert best.plan.success
    assert best.times[0] == 0.0
    np.testing.assert_array_equal(best.q[0], setup.workcell.start)
    assert best.q.shape == best.v.shape == (len(best.times), arm.n)
    np.testing.assert_allclose(arm.pose(best.q[-1]), best.plan.guides[-1], atol=2e-3)
    assert (np.abs(best.v) <= arm.velocity_limits).all()
    (turn,) = best.turned
    assert turn.body == "bowl"
    assert f"turned by {np.degrees(turn.angle):+.0f}°".replace("-", "−") in str(best)


def test_the_arm_may_start_elsewhere(setup: Setup, demonstrations) -> None:
    start = setup.workcell.start + 0.05
    plan = setup.plan(demonstrations, PLACE, start=start, most=1)
    np.testing.assert_array_equal(plan.q[0], start)
    assert plan.alternatives == ()


def test_where_there_is_no_plan_it_says_why(setup: Setup, demonstrations) -> None:
    with pytest.raises(ScenarioError, match="no demonstration gives a plan there: with demo"):
        setup.plan(demonstrations, {"bowl": (2.0, 0.3)})
    with pytest.raises(ScenarioError, match="no object 'bowk'"):
        setup.plan(demonstrations, {"bowk": (0.9, 0.3)})


def test_a_free_approach_is_tried_where_no_screw_leads_to_the_first_guiding_pose(
    demonstrations,
) -> None:
    changes = ["objects.0.symmetry=null", "objects.0.yaw=[-1.6, 1.6]"]
    screw = Setup(load_scenario("pouring", changes))
    free = Setup(load_scenario("pouring", [*changes, "planner.approach=free"]))
    rng = np.random.default_rng(2)
    coordinates = rng.uniform(screw.area.lower, screw.area.upper, (60, 1, 3))
    along, anyhow = (s.evaluate(demonstrations, coordinates).any_success for s in (screw, free))
    gained = 0
    for place in coordinates[anyhow & ~along]:
        with suppress(ScenarioError):  # it touches something
            assert free.plan(demonstrations, place).plan.approach
            gained += 1
    for place in coordinates[along][:3]:
        assert not free.plan(demonstrations, place).plan.approach
    assert gained > 0


def test_a_run_plans_with_its_own_demonstrations(finished_run: Path) -> None:
    run = open_run(finished_run)
    plan = run.plan(bowl=(0.9, 0.3), most=2)
    assert plan.demonstration.name in {d.name for d in run.demonstrations}
    assert isinstance(run.setup.evaluate(run.demonstrations, [[0.9, 0.3]]), Outcomes)


def test_a_run_without_demonstrations_says_so(tmp_path: Path) -> None:
    run = new_run(load_scenario("pouring"), tmp_path / "run")
    with pytest.raises(RunDirectoryError, match="no demonstrations yet"):
        run.plan(bowl=(0.9, 0.3))
