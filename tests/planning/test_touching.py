"""Which bodies touch: as outcomes say it, and as it is found where they do not."""

from __future__ import annotations

from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from drake_screw.assembly.why_not import why_not
from drake_screw.commands.inspect_console import instance_table
from drake_screw.commands.output import print_table
from drake_screw.planning import BatchPlanner, Cause, Outcomes
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.planning.outcomes import one_outcome
from drake_screw.planning.plan_checker import PlanChecker
from drake_screw.planning.touching import (
    CollisionCounts,
    count_collisions,
    cut_short,
    known_pair,
    touch_words,
    touching_bodies,
)
from drake_screw.robot import RobotConfig, TableConfig, Workcell, build_workcell
from drake_screw.visualization.attempt import attempt, collided, headline
from tests.planning.pole_in_the_way import BALL, CLOSED, START, lesson_of, robot_in, workcell_in
from tests.robot.small_arms import PLANAR, sdf

PAIR = ("p2_link", "pole")


@pytest.fixture(scope="module")
def workcell(tmp_path_factory: pytest.TempPathFactory) -> Workcell:
    return workcell_in(tmp_path_factory.mktemp("pole"))


def found_in(workcell: Workcell, clearance: float = 0.0):
    """Planner, demonstration and outcome (1,) of an approach that runs into the pole."""
    planner = CollisionFreePlanner(
        BatchPlanner(workcell.arm.screw_chain()), workcell, clearance=clearance
    )
    lesson = lesson_of(workcell, CLOSED)
    return planner, lesson, planner.all_outcomes([lesson], CLOSED[None], START)[0]


def unknown(outcome: Outcomes) -> Outcomes:
    return replace(outcome, pair=np.full(outcome.shape, -1, dtype=np.int16))


def test_the_outcome_of_a_collision_names_its_pair(workcell: Workcell) -> None:
    planner, lesson, (found,) = found_in(workcell)
    assert found.cause == Cause.COLLISION
    assert known_pair(found, workcell) == PAIR
    plan = cut_short(planner.planner.plan(lesson, CLOSED, START), found)
    assert touching_bodies(found, workcell, plan.q[-1], CLOSED) == (PAIR,)


def test_what_an_outcome_does_not_say_is_found_where_it_ended(workcell: Workcell) -> None:
    planner, lesson, outcomes = found_in(workcell)
    found = unknown(outcomes)[0]
    assert known_pair(found, workcell) is None
    plan = cut_short(planner.planner.plan(lesson, CLOSED, START), found)
    assert touching_bodies(found, workcell, plan.q[-1], CLOSED) == (PAIR,)
    assert touching_bodies(found, workcell, START, CLOSED) == ()


def test_a_pair_of_another_workcell_is_not_known(workcell: Workcell) -> None:
    other = replace(one_outcome(Cause.COLLISION, 0), pair=np.array(len(workcell.pairs), np.int16))
    assert known_pair(other, workcell) is None


def test_a_check_that_finds_nothing_at_the_place_of_a_collision_is_no_error(
    workcell: Workcell,
) -> None:
    """The outcome counts: where it says that something touches there, that is what is shown."""
    planner, lesson, outcomes = found_in(workcell)
    plan = planner.planner.plan(lesson, CLOSED, START)
    early = replace(unknown(outcomes), fraction=np.zeros(1, dtype=np.float32))
    tried = collided(attempt(workcell.arm, 0, lesson, CLOSED, plan), early[0], workcell)
    assert tried.bodies == ()
    assert headline(tried).endswith("the arm touches something")
    assert why_not(early, [lesson], CLOSED, START, planner).endswith(
        "with turn, the arm touches something in segment 1"
    )


def test_why_there_is_no_plan(workcell: Workcell) -> None:
    planner, lesson, outcomes = found_in(workcell)
    expected = "with turn, p2_link touches pole in segment 1"
    assert why_not(outcomes, [lesson], CLOSED, START, planner) == expected
    assert why_not(unknown(outcomes), [lesson], CLOSED, START, planner) == expected


def test_a_clearance_that_is_not_kept_is_no_touch(workcell: Workcell) -> None:
    planner, lesson, outcomes = found_in(workcell, clearance=0.03)
    assert touch_words(PAIR, 0.03) == "p2_link is nearer than 3 cm to pole"
    expected = "with turn, p2_link is nearer than 3 cm to pole in segment 1"
    assert why_not(outcomes, [lesson], CLOSED, START, planner) == expected
    assert why_not(unknown(outcomes), [lesson], CLOSED, START, planner) == expected
    plan = planner.planner.plan(lesson, CLOSED, START)
    tried = collided(attempt(workcell.arm, 0, lesson, CLOSED, plan), outcomes[0], workcell, 0.03)
    assert headline(tried).endswith(touch_words(PAIR, 0.03))
    console = Console(width=30, record=True, file=StringIO())
    print_table(console, instance_table([tried]))
    assert "bodies" in console.export_text(clear=False)
    assert "p2_link, pole" in console.export_text()


def test_pairs_are_counted_by_the_best_attempt_of_each_failure(tmp_path: Path) -> None:
    file = tmp_path / "planar.sdf"
    file.write_text(sdf(PLANAR, shapes={"p2_link": BALL, "p3_link": BALL}))
    robot = RobotConfig(str(file), ("p1", "p2", "p3"), "hand", tuple(START))
    cell = build_workcell(robot, table=TableConfig((3.0, 0.0), (0.4, 0.6), top=0.4))
    at = {cell.touching(i): i for i in range(len(cell.pairs))}
    a, b = at["p2_link", "table"], at["p3_link", "table"]
    c, j, s = Cause.COLLISION, Cause.JOINT_LIMIT, Cause.SUCCESS
    outcomes = Outcomes(
        np.array([[c, j], [c, c], [c, s], [c, c], [j, j], [c, c]], dtype=np.uint8),
        np.array([[2, 1], [1, 2], [5, -1], [3, 2], [1, 1], [2, 1]], dtype=np.int16),
        np.full((6, 2), -1, dtype=np.int8),
        np.full((6, 2), 0.5, dtype=np.float32),
        np.zeros((6, 2), dtype=np.int16),
        np.array([[a, -1], [a, b], [a, -1], [b, a], [-1, -1], [-1, a]], dtype=np.int16),
    )
    counts = count_collisions(outcomes, cell)
    assert (counts.failures, counts.collisions) == (5, 4)
    assert counts.pairs == {"p3_link-table": 2, "p2_link-table": 1}
    assert str(counts) == (
        "4 of 5 failures are collisions: p3_link-table 50%, p2_link-table 25%, others 25%"
    )


def test_rare_pairs_are_not_listed() -> None:
    counts = CollisionCounts(200, 100, {"a-b": 97, "a-c": 2, "a-d": 1})
    assert str(counts) == "100 of 200 failures are collisions: a-b 97%, others 3%"
    assert str(CollisionCounts(3, 0, {})) == "0 of 3 failures are collisions"
    assert str(CollisionCounts(3, 2, {})) == "2 of 3 failures are collisions"


def test_an_arm_without_collision_shapes_touches_nothing(tmp_path: Path) -> None:
    robot = robot_in(tmp_path)
    Path(robot.model).write_text(sdf(PLANAR))
    path = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    for table in (None, TableConfig((0.8, 0.0), (0.4, 0.6), top=0.5)):
        cell = build_workcell(robot, table=table)
        assert PlanChecker(cell).free(path, np.empty((0, 4, 4)))
