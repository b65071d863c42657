"""Ways around what is in the way: found, the same every time, checked, and given up in time."""

from __future__ import annotations

import logging
import subprocess
import sys

import numpy as np
import pytest

from drake_screw.planning import Cause, connection
from drake_screw.planning.approach import straight
from drake_screw.planning.connected import TRIED, led_around, tried_first
from drake_screw.planning.connection import connect
from drake_screw.planning.plan_checker import PlanChecker
from drake_screw.robot import Workcell
from tests.planning.pole_in_the_way import (
    AWAY,
    CLOSED,
    GOAL,
    PASSABLE,
    START,
    lesson_of,
    planner_of,
    workcell_in,
)

pytest.importorskip("ompl")


@pytest.fixture(scope="module")
def workcell(tmp_path_factory: pytest.TempPathFactory) -> Workcell:
    return workcell_in(tmp_path_factory.mktemp("models"))


@pytest.fixture(scope="module")
def checker(workcell: Workcell) -> PlanChecker:
    return PlanChecker(workcell)


@pytest.fixture(scope="module")
def planner(workcell: Workcell):
    return planner_of(workcell)


def test_it_finds_a_way_where_the_straight_motion_touches(checker, workcell) -> None:
    assert not checker.free(straight(START, GOAL)[0], PASSABLE)
    q = connect(checker, START, GOAL, PASSABLE)
    assert q is not None
    np.testing.assert_array_equal(q[[0, -1]], [START, GOAL])
    assert (workcell.arm.margin(q) >= 0.0).all()
    share = np.linspace(0.0, 1.0, 10)[:, None, None]
    dense = (q[:-1] + share * np.diff(q, axis=0)).reshape(-1, 3)
    assert not workcell.collides(dense, PASSABLE).any()


def test_the_way_is_the_same_whatever_was_asked_before(checker) -> None:
    def ask(i: int) -> np.ndarray | None:
        return connect(checker, START, GOAL + 0.02 * i, PASSABLE, seed=i)

    one_order = {i: ask(i) for i in (0, 1, 2)}
    other_order = {i: ask(i) for i in (2, 2, 0, 1)}
    for i in range(3):
        np.testing.assert_array_equal(one_order[i], other_order[i])
    again = connect(checker, START, GOAL, PASSABLE, seed=5)
    assert again is not None
    assert again.shape != one_order[0].shape or not np.array_equal(again, one_order[0])


def test_it_gives_up_within_its_iterations(checker, monkeypatch) -> None:
    asked = []
    free = checker.free
    monkeypatch.setattr(checker, "free", lambda *args: asked.append(0) or free(*args))
    assert connect(checker, START, GOAL, CLOSED, iterations=40) is None
    few = len(asked)
    assert connect(checker, START, GOAL, CLOSED, iterations=80) is None
    assert 0 < few < len(asked) - few < 40 * 80


def test_ends_that_touch_or_leave_the_limits_have_no_way(checker, workcell) -> None:
    at_goal = AWAY.copy()
    at_goal[0, :2, 3] = [0.4 * np.cos(GOAL[0]), 0.4 * np.sin(GOAL[0])]
    assert workcell.collides(GOAL[None], at_goal).all()
    assert connect(checker, START, GOAL, at_goal) is None
    assert connect(checker, GOAL, START, at_goal) is None
    assert connect(checker, START, np.add(GOAL, [2.0, 0.0, 0.0]), AWAY) is None


def test_ompl_is_silent_and_keeps_its_log_level(checker, capfd) -> None:
    util = pytest.importorskip("ompl.util")
    level = util.getLogLevel()
    connect(checker, START, GOAL, PASSABLE)
    connect(checker, START, GOAL, CLOSED, iterations=5)
    assert util.getLogLevel() == level
    assert capfd.readouterr() == ("", "")


def test_what_goes_wrong_in_a_check_is_told(checker, monkeypatch) -> None:
    def fails(*_: object) -> bool:
        raise ValueError("no such thing")

    monkeypatch.setattr(checker, "free", fails)
    with pytest.raises(ValueError, match="no such thing"):
        connect(checker, START, GOAL, PASSABLE)


def test_the_planner_is_asked_for_ways_around_last(planner, workcell) -> None:
    lesson, X_WO = lesson_of(workcell, PASSABLE), np.stack([PASSABLE, AWAY])
    planner.connects = False
    before = planner.all_outcomes([lesson], PASSABLE[None], START)
    planner.connects = True
    assert before.cause[0, 0] == Cause.COLLISION
    assert before.codes()[0, 0] == "1:c"
    own = lesson_of(workcell, AWAY)
    found = planner.all_outcomes([lesson, own], X_WO, START)
    assert found.success[0, 0]
    assert found.success[1, 1]
    some = planner.any_success([lesson], PASSABLE[None], START)
    np.testing.assert_array_equal(some.cause, found.cause[:1, :1])
    np.testing.assert_array_equal(some.variant, found.variant[:1, :1])


def test_plans_are_those_that_were_judged(planner, workcell) -> None:
    lesson = lesson_of(workcell, PASSABLE)
    found = planner.all_outcomes([lesson], PASSABLE[None], START)[0, 0]
    plan = planner.plan(lesson, PASSABLE, START, int(found.variant))
    assert plan.success
    assert plan.approach
    assert planner.checker.free(plan.q, PASSABLE)
    straight_on = planner.planner.plan(lesson, PASSABLE, START, int(found.variant))
    assert not planner.checker.free(straight_on.q, PASSABLE)
    connect(planner.checker, GOAL, START, PASSABLE, seed=3)
    again, free = planner.plans(
        [lesson, lesson_of(workcell, AWAY)], np.stack([PASSABLE, AWAY]), START, [0, 1],
        [int(found.variant), 0],
    )  # fmt: skip
    np.testing.assert_array_equal(again.q, plan.q)
    np.testing.assert_array_equal(again.s, plan.s)
    straight_one = planner.planner.plan(lesson_of(workcell, AWAY), AWAY, START)
    np.testing.assert_array_equal(free.q, straight_one.q)
    goal = plan.q[np.flatnonzero(plan.segment == 0)[-1]]
    np.testing.assert_allclose(workcell.arm.pose(goal), plan.guides[0], atol=2e-3)
    assert (np.diff(plan.segment + plan.s) >= 0.0).all()


def test_what_touches_after_the_approach_stays_a_collision(planner, workcell, monkeypatch) -> None:
    """The second segment goes back through the pole."""
    lesson = lesson_of(workcell, PASSABLE, turn=-1.5)
    monkeypatch.setattr(
        "drake_screw.planning.connected.connect", lambda *_: pytest.fail("nothing to connect")
    )
    found = planner.all_outcomes([lesson], PASSABLE[None], START)
    assert found.cause[0, 0] == Cause.COLLISION


def test_a_way_is_sought_a_handful_of_times(planner, workcell, monkeypatch) -> None:
    asked = []
    monkeypatch.setattr(
        "drake_screw.planning.connected.connect", lambda *args: asked.append(args[2])
    )
    lesson = lesson_of(workcell, PASSABLE)
    found = planner.all_outcomes([lesson], PASSABLE[None], START)
    assert found.codes()[0, 0] == "1:c"
    assert 2 <= len(asked) <= TRIED
    away = np.linalg.norm(np.array(asked)[:, None] - np.array(asked), axis=-1)
    assert away[~np.eye(len(asked), dtype=bool)].min() > 0.1
    asked.clear()
    both = planner.any_success([lesson, lesson_of(workcell, AWAY)], AWAY[None], START)
    assert both.any_success.all()
    assert asked == []


def test_tries_begin_nearest_and_differ(planner, workcell) -> None:
    assert len(tried_first([])) == 0
    lesson = lesson_of(workcell, AWAY)
    variants = np.flatnonzero(
        planner.planner.variant_outcomes(lesson, AWAY[None], START).success[0]
    )
    plans = [planner.planner.plan(lesson, AWAY, START, int(v)) for v in variants]
    order = tried_first([*plans, *plans])
    assert len(set(order.tolist())) == len(order) <= TRIED
    assert len(order) == 2  # elbow to the left and to the right


def test_without_ompl_nothing_changes_but_a_warning(workcell, monkeypatch, caplog) -> None:
    monkeypatch.setattr(connection.importlib.util, "find_spec", lambda _: None)
    connection.warn_of_its_absence.cache_clear()
    with caplog.at_level(logging.WARNING):
        planner = planner_of(workcell)
        planner_of(workcell)
    assert [r.message for r in caplog.records if "drake-screw[ompl]" in r.message] == [
        connection.ABSENT
    ]
    lesson = lesson_of(workcell, PASSABLE)
    found = planner.all_outcomes([lesson], PASSABLE[None], START)
    assert found.codes()[0, 0] == "1:c"
    some = planner.any_success([lesson], PASSABLE[None], START)
    assert some.codes()[0, 0] == "1:c"
    plan = planner.plan(lesson, PASSABLE, START, int(found.variant[0, 0]))
    assert not planner.checker.free(plan.q, PASSABLE)


def test_ompl_is_not_imported_before_it_is_needed() -> None:
    code = "import sys, drake_screw.planning.collisions; sys.exit('ompl' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_plan_that_touches_nothing_else_is_led_around(planner, workcell) -> None:
    lesson = lesson_of(workcell, CLOSED)
    plan = planner.planner.plan(lesson, CLOSED, START)
    assert led_around(planner.checker, plan, CLOSED) is None
