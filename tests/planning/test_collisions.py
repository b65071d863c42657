"""Collisions along plans: paths in batches, their first touches, and the planner that uses them."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner, Cause, Plan, ReferencePlanner, Symmetries
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.planning.plan_checker import PlanChecker
from drake_screw.robot import ObjectConfig, RobotConfig, TableConfig, build_workcell
from drake_screw.screws import exp, inverse, pose, rotation_angle, sclerp, translation_distance
from drake_screw.tasks import Symmetry
from tests.robot.small_arms import PLANAR, sdf

START = (1.0434904, -0.2201262, -0.7470486, 1.5243934, 1.8818109, -0.9687089, -0.4908739)
JOINTS = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
TABLE = TableConfig((0.85, 0.25), (0.7, 1.3), -0.0645)
AT = np.array([0.85, 0.25, -0.0644])


@pytest.fixture(scope="module")
def workcell():
    robot = RobotConfig("baxter", JOINTS, "left_hand", START, parked={"right_s0": -0.767})
    return build_workcell(robot, table=TABLE, objects=[ObjectConfig("bowl", 0.08, 0.06)])


@pytest.fixture(scope="module")
def checker(workcell) -> PlanChecker:
    return PlanChecker(workcell)


@pytest.fixture(scope="module")
def batch(workcell) -> BatchPlanner:
    return BatchPlanner(workcell.arm.screw_chain())


def plans_of(batch: BatchPlanner, lesson: Demonstration, X_WO: np.ndarray) -> tuple[Plan, ...]:
    return batch.plans([lesson], X_WO, START, np.zeros(len(X_WO), dtype=int))


def placed(*places: np.ndarray) -> np.ndarray:
    """X_WO (N, 1, 4, 4) of the bowl at points."""
    return pose(np.eye(3), np.array(places))[:, None]


def reaching(name: str, *p_OE: tuple[float, float, float]) -> Demonstration:
    """Guiding poses at points over the bowl, the end effector level and pointing along x."""
    R_OE = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    X_OE = pose(R_OE, np.array(p_OE))
    kept = np.arange(len(X_OE))
    return Demonstration(name, X_OE, np.zeros(len(X_OE), dtype=int), placed(AT)[0], X_OE, kept)


ABOVE = reaching("above", (-0.15, 0.0, 0.25), (-0.15, 0.0, 0.18))
THROUGH = reaching("through", (-0.15, 0.0, 0.25), (-0.05, 0.0, 0.05), (-0.15, 0.0, 0.25))


def some_places(N: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return placed(*(AT + rng.uniform([-0.08, -0.1, 0.0], [0.08, 0.1, 0.0], (N, 3))))


def test_paths_end_where_the_reference_planners_do(workcell, batch) -> None:
    arm, X_WO = workcell.arm, some_places(3)
    plans = plans_of(batch, ABOVE, X_WO)
    reference = ReferencePlanner(arm, step=0.02)
    for i in range(3):
        plan = reference.plan(START, ABOVE.transfer(X_WO[i]))
        assert plan.success
        np.testing.assert_allclose(plans[i].q[-1], plan.q[-1], atol=2e-4)


def test_paths_stay_on_the_screws_through_all_guiding_poses(batch, workcell) -> None:
    X_WO = some_places(4)
    for plan, guides in zip(plans_of(batch, THROUGH, X_WO), THROUGH.transfer(X_WO), strict=True):
        assert len(plan.q) == len(plan.s) == len(plan.segment)
        assert plan.segment[-1] == 2
        assert (np.diff(plan.segment) >= 0).all()
        X_WA = np.concatenate([workcell.arm.pose(START)[None], guides])[plan.segment]
        X_WS = sclerp(X_WA, guides[plan.segment], plan.s)
        X_WE = workcell.arm.pose(plan.q)
        assert translation_distance(X_WE, X_WS).max() < 2e-4
        assert rotation_angle(X_WE, X_WS).max() < 1e-3


def test_no_instances_make_no_paths(checker, batch) -> None:
    plans = plans_of(batch, ABOVE, some_places(3)[:0])
    assert plans == ()
    found = checker.first_collisions(plans, some_places(3)[:0])
    assert len(found.collides) == 0


def test_configurations_touch_what_drake_says_they_do(checker, workcell, rng) -> None:
    """One point is a path, too; of most nothing has to be asked."""
    arm, before = workcell.arm, checker.asked
    q = rng.uniform(arm.lower, arm.upper, (600, arm.n))
    X_WO = some_places(1)[0]
    free = [checker.free(one[None], X_WO) for one in q]
    assert checker.asked - before < 6
    np.testing.assert_array_equal(free, ~workcell.collides(q, X_WO))
    assert 0.05 < np.mean(free) < 0.95


def test_answers_follow_the_bowl(checker, workcell) -> None:
    q = np.array(START)[None]
    p_WE = workcell.arm.pose(START)[:3, 3]
    assert not checker.free(q, placed(p_WE)[0])
    assert checker.free(q, placed(AT + 0.5 * np.eye(3)[1])[0])


def test_a_free_path_is_free(checker, batch) -> None:
    X_WO = some_places(5)
    plans = plans_of(batch, ABOVE, X_WO)
    found = checker.first_collisions(plans, X_WO)
    assert not found.collides.any()
    assert (found.segment == -1).all()
    assert np.isnan(found.q).all()
    assert checker.free(plans[0].q, X_WO[0])


def test_first_collisions_are_those_of_a_dense_search(checker, batch, workcell) -> None:
    X_WO = some_places(4)
    plans = plans_of(batch, THROUGH, X_WO)
    found = checker.first_collisions(plans, X_WO)
    assert found.collides.all()
    assert (found.segment == 1).all()
    share = np.linspace(0.0, 1.0, 40, endpoint=False)[:, None]
    for i, plan in enumerate(plans):
        steps = itertools.pairwise(plan.q)
        dense = np.concatenate([a + share * (b - a) for a, b in steps])
        hit = workcell.collides(dense, X_WO[i])
        at = int(np.argmax(hit))
        k = at // 40
        fraction = plan.s[k] * (plan.segment[k] == 1) + (at % 40) / 40 * (
            plan.s[k + 1] - plan.s[k] * (plan.segment[k] == 1)
        )
        assert found.fraction[i] == pytest.approx(fraction, abs=0.06)
        assert workcell.collides(found.q[i : i + 1], X_WO[i]).all()


def test_plans_of_any_length_are_checked_each_by_itself(checker, batch) -> None:
    X_WO = some_places(4)
    mixed = [
        plans_of(batch, d, X)[0] for d, X in zip([ABOVE, THROUGH] * 2, X_WO[:, None], strict=True)
    ]
    assert len({len(plan.q) for plan in mixed}) > 1
    found = checker.first_collisions(mixed, X_WO)
    np.testing.assert_array_equal(found.collides, [False, True] * 2)
    for i, plan in enumerate(mixed):
        alone = checker.first_collisions([plan], X_WO[i : i + 1])
        assert alone.fraction[0] == found.fraction[i]
        np.testing.assert_array_equal(alone.q[0], found.q[i])


def test_free_paths_are_cleared_without_asking_drake(workcell, batch) -> None:
    checker, X_WO = PlanChecker(workcell), some_places(6)
    assert not checker.first_collisions(plans_of(batch, ABOVE, X_WO), X_WO).collides.any()
    assert checker.asked == 0


@pytest.fixture(scope="module")
def planners(workcell, batch):
    return batch, CollisionFreePlanner(batch, workcell)


def test_colliding_successes_become_collisions(planners, workcell) -> None:
    batch, planner = planners
    X_WO = some_places(5)
    before = batch.all_outcomes([ABOVE, THROUGH], X_WO, START)
    after = planner.all_outcomes([ABOVE, THROUGH], X_WO, START)
    assert before.success.all()
    np.testing.assert_array_equal(after.success, [[True, False]] * 5)
    assert (after.cause[:, 1] == Cause.COLLISION).all()
    assert (after.codes()[:, 1] == "2:c").all()
    assert ((after.fraction[:, 1] > 0.0) & (after.fraction[:, 1] < 1.0)).all()
    assert {workcell.touching(pair)[1] for pair in after.pair[:, 1].tolist()} == {"bowl"}


def test_the_planner_and_the_checker_of_plans_agree(planners) -> None:
    """On the first touch, too: the planner follows its own steps, the other the plan's points."""
    batch, planner = planners
    X_WO = some_places(20, seed=3)
    found = planner.all_outcomes([THROUGH], X_WO, START)[:, 0]
    hits = planner.checker.first_collisions(plans_of(batch, THROUGH, X_WO), X_WO)
    np.testing.assert_array_equal(hits.collides, ~found.success)
    np.testing.assert_array_equal(hits.segment, found.segment)
    np.testing.assert_allclose(hits.fraction, found.fraction, atol=0.05)


def test_any_success_goes_on_to_the_next_demonstration(planners) -> None:
    _, planner = planners
    outcomes = planner.any_success([THROUGH, ABOVE], some_places(5), START)
    assert outcomes.any_success.all()
    assert outcomes.success[:, 1].all()


def test_any_success_finds_none_where_all_collide(planners) -> None:
    _, planner = planners
    outcomes = planner.any_success([THROUGH], some_places(3), START)
    assert not outcomes.any_success.any()
    assert (outcomes.cause == Cause.COLLISION).all()


def test_failures_within_the_arm_stay_as_they_are(planners) -> None:
    batch, planner = planners
    far = placed(AT + 1.5 * np.eye(3)[0])
    before = batch.all_outcomes([ABOVE], far, START)
    after = planner.all_outcomes([ABOVE], far, START)
    np.testing.assert_array_equal(before.cause, after.cause)
    assert not after.success.any()


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(7)


def test_a_moving_screw_of_the_bowl_moves_the_answer(checker, batch) -> None:
    """Turning the bowl about its axis changes nothing; the demonstration turns with it."""
    turned = placed(AT) @ exp(np.array([0.0, 0.0, 0.2, 0.0, 0.0, 0.0]))
    found = checker.first_collisions(plans_of(batch, THROUGH, turned), turned)
    assert found.collides[0]
    assert found.segment[0] == 1


def test_a_turn_that_touches_nothing_is_found_after_those_that_do(workcell) -> None:
    """By asking Drake about every turn's plan: the first that is free wins, if there is any."""
    chain = workcell.arm.screw_chain()
    symmetries = Symmetries.of(chain, [Symmetry()], tried=8)
    turning = BatchPlanner(chain, symmetries=symmetries)
    planner = CollisionFreePlanner(turning, workcell)
    beside = reaching("beside", (-0.25, 0.0, 0.25), (-0.16, 0.0, 0.10))
    lessons, X_WO = [beside, ABOVE, THROUGH], some_places(12, seed=5)
    found = planner.all_outcomes(lessons, X_WO, START)
    seen = set()
    for i, (d, lesson) in itertools.product(range(12), enumerate(lessons)):
        turns = turning.variant_outcomes(lesson, X_WO[i : i + 1], START)[0]
        free, touching = [], 0
        for turn in np.flatnonzero(turns.success):
            plan = turning.plan(lesson, X_WO[i], START, int(turn))
            touches = not planner.checker.free(plan.q, X_WO[i])
            free += [] if touches else [int(turn)]
            touching += touches
        assert bool(found.success[i, d]) is bool(free)
        if free:
            assert found.variant[i, d] == free[0]
        seen.add((bool(free), touching > 0))
    assert {(True, True), (True, False), (False, True)} <= seen
    some = planner.any_success(lessons, X_WO, START)
    np.testing.assert_array_equal(some.any_success, found.any_success)


def test_an_arm_of_three_joints_is_checked_for_collisions(tmp_path: Path) -> None:
    """Once with the pole out of the way, once where the arm's last link comes through."""
    ball = "<sphere><radius>0.03</radius></sphere>"
    file = tmp_path / "planar.sdf"
    file.write_text(sdf(PLANAR, hand="0.1 0 0 0 0 0", shapes={"p2_link": ball, "p3_link": ball}))
    bent = np.array([0.4, 0.9, 0.4])
    robot = RobotConfig(str(file), tuple(joint.name for joint in PLANAR), "hand", tuple(bent))
    workcell = build_workcell(robot, objects=[ObjectConfig("pole", 0.02, 0.6)])
    X = workcell.arm.pose(bent + np.cumsum([[0.2, -0.3, 0.2], [-0.5, 0.3, 0.2]], axis=0))
    batch = BatchPlanner(workcell.arm.screw_chain())
    planner = CollisionFreePlanner(batch, workcell)

    def lesson(X_WO: np.ndarray) -> Demonstration:
        X_OE = inverse(X_WO[0]) @ X
        return Demonstration("flat", X_OE, np.zeros(2, int), X_WO, X, np.arange(2))

    away = placed([-1.0, -1.0, 0.3])
    within = placed([*(X[1, :2, 3] - 0.1 * X[1, :2, 0]), 0.3])
    for X_WO, code in ((away, "0:0"), (within, "2:c")):
        lessons = [lesson(X_WO[0])]
        assert batch.all_outcomes(lessons, X_WO, bent).codes() == "0:0"
        for answer in (planner.all_outcomes, planner.any_success):
            assert answer(lessons, X_WO, bent).codes() == code
    touching = planner.all_outcomes([lesson(within[0])], within, bent).pair.item()
    assert workcell.touching(touching) == ("p3_link", "pole")
