"""The batch planner gives the reference planner's answers, and those on record."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import (
    BatchPlanner,
    Cause,
    Outcomes,
    ReferencePlanner,
    concatenate,
)
from drake_screw.planning.contract import Redundancy
from drake_screw.robot import Arm
from drake_screw.screws import inverse, pose, pose_from_planar

REACHING = np.array([0.2, -0.2, 0.1, 1.4, 0.2, -0.3, -0.1])
MIDDLE = np.array([[0.5, -0.1, 0.0], [0.55, 0.2, 0.0]])
N, PAIRS = 600, 70
BENT = np.array([0.4, 0.9, 0.4])


def demonstration(
    X_WE: np.ndarray, X_WO: np.ndarray, objects: np.ndarray, name: str
) -> Demonstration:
    X_OE = inverse(X_WO[objects]) @ X_WE
    return Demonstration(name, X_OE, objects, X_WO, X_WE, np.arange(len(X_WE)))


@pytest.fixture(scope="module")
def lessons(seven: Arm) -> tuple[Demonstration, ...]:
    """Five demonstrations with 2 to 6 guiding poses around two objects in front of the arm."""
    rng, made = np.random.default_rng(11), []
    for i in range(5):
        steps = rng.uniform(-0.3, 0.3, (2 + i, seven.n))
        X_WE = seven.pose(REACHING + np.cumsum(steps, axis=0))
        X_WO = pose_from_planar(MIDDLE + rng.uniform(-0.05, 0.05, (2, 3)))
        made.append(demonstration(X_WE, X_WO, rng.integers(0, 2, 2 + i), f"demo_{i}"))
    return tuple(made)


@pytest.fixture(scope="module")
def places() -> np.ndarray:
    """(N, 2, 4, 4) poses of two objects, some out of reach."""
    spread = np.random.default_rng(12).uniform(-1.0, 1.0, (N, 2, 3)) * [0.2, 0.2, 0.5]
    return pose_from_planar(MIDDLE + spread)


@pytest.fixture(scope="module")
def planner(seven: Arm) -> BatchPlanner:
    return BatchPlanner(seven.screw_chain())


@pytest.fixture(scope="module")
def answers(
    planner: BatchPlanner, lessons: tuple[Demonstration, ...], places: np.ndarray
) -> Outcomes:
    return planner.all_outcomes(lessons, places, REACHING)


def assert_same(a: Outcomes, b: Outcomes) -> None:
    for name in ("cause", "segment", "joint", "fraction"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))


def reference_code(
    arm: Arm,
    q_start: np.ndarray,
    guides: np.ndarray,
    *,
    step: float = 0.02,
    slack: float = 0.0,
    redundancy: Redundancy = "least_norm",
) -> str:
    """What the reference planner says if all limits are this much further out."""
    other = copy.copy(arm)
    other.lower, other.upper = arm.lower - slack, arm.upper + slack
    planner = ReferencePlanner(other, step=step, joint_step=step / 2.0, redundancy=redundancy)
    return str(planner.plan(q_start, guides).outcome.codes())


def assert_agrees_but_within_a_hair(
    arm: Arm,
    q_start: np.ndarray,
    guides: np.ndarray,
    answer: Outcomes,
    redundancy: Redundancy = "least_norm",
) -> bool:
    """Whether both planners say the same.

    If they do not, 5 mrad of limit must make the difference, or else the reference's steps were
    too long for a singularity that it passes, and with shorter ones it says the same.
    """
    code, reference = str(answer.codes()), partial(reference_code, redundancy=redundancy)
    if reference(arm, q_start, guides) == code:
        return True
    hair = [reference(arm, q_start, guides, slack=slack) for slack in (0.005, -0.005)]
    if code not in hair:
        fine = reference(arm, q_start, guides, step=0.002)
        assert code == fine, f"batch {code}, reference {fine}, with a hair of limit {hair}"
    return False


def test_outcomes_of_every_kind_occur(answers: Outcomes) -> None:
    assert answers.shape == (N, 5)
    found, counts = np.unique(answers.cause, return_counts=True)
    assert set(found) == {Cause.SUCCESS, Cause.JOINT_LIMIT, Cause.UNREACHABLE}
    assert counts.min() >= 300
    assert len(np.unique(answers.joint)) >= 4


def test_fields_are_consistent(answers: Outcomes, lessons: tuple[Demonstration, ...]) -> None:
    success, limit = answers.success, answers.cause == Cause.JOINT_LIMIT
    guides = np.array([len(d.X_OE) for d in lessons])
    assert (answers.segment[success] == -1).all()
    assert (answers.fraction[success] == 1.0).all()
    failed = ~success
    assert (answers.segment[failed] >= 0).all()
    assert (answers.segment < guides).all()
    assert ((answers.fraction >= 0.0) & (answers.fraction <= 1.0)).all()
    assert ((answers.joint >= 0) == limit).all()
    assert (answers.joint < 7).all()


@pytest.mark.slow
def test_agrees_with_the_reference_on_a_small_arm(
    seven: Arm, lessons: tuple[Demonstration, ...], places: np.ndarray, answers: Outcomes
) -> None:
    pairs = [(i, d) for i in range(0, N, 60) for d in range(5)]
    same = [
        assert_agrees_but_within_a_hair(
            seven, REACHING, lessons[d].transfer(places[i]), answers[i, d]
        )
        for i, d in pairs
    ]
    assert np.mean(same) >= 0.95


@pytest.mark.slow
def test_fraction_is_how_far_the_reference_comes(
    seven: Arm, lessons: tuple[Demonstration, ...], places: np.ndarray, answers: Outcomes
) -> None:
    limits = np.argwhere((answers.cause == Cause.JOINT_LIMIT) & (answers.fraction < 0.95))[:12]
    assert len(limits) == 12
    planner = ReferencePlanner(seven, step=0.02, joint_step=0.01)
    for i, d in limits:
        plan = planner.plan(REACHING, lessons[d].transfer(places[i]))
        if plan.outcome.codes() == answers[i, d].codes():
            assert answers[i, d].fraction == pytest.approx(plan.s[-1], abs=2e-3)


def test_fewer_than_six_joints(planar: Arm) -> None:
    chain = planar.screw_chain()
    X_WE = planar.pose(np.add(BENT, [[0.1, -0.2, 0.1], [-0.2, 0.3, 0.2]]))
    X_WO = pose(np.eye(3), [[0.6, 0.4, 0.0]])
    lesson = demonstration(X_WE, X_WO, np.zeros(2, dtype=int), "flat")
    rng = np.random.default_rng(13)
    places = pose_from_planar(rng.uniform([0.2, 0.0, -0.4], [0.9, 0.7, 0.4], (30, 1, 3)))
    answers = BatchPlanner(chain).all_outcomes([lesson], places, BENT)
    assert 3 <= answers.success.sum() <= 27
    for i in range(30):
        assert_agrees_but_within_a_hair(planar, BENT, lesson.transfer(places[i]), answers[i, 0])
    lifted = places.copy()
    lifted[..., 2, 3] = 0.03
    assert not BatchPlanner(chain).all_outcomes([lesson], lifted, BENT).success.any()


@pytest.mark.parametrize(("off", "fine"), [(0.0, True), (1e-5, True), (9e-5, True), (2e-4, False)])
def test_a_guiding_pose_off_the_arms_plane_counts_by_the_tolerance(
    planar: Arm, off: float, fine: bool
) -> None:
    """Also with smaller steps, of which more lie near the end, where little is left to move."""
    rng = np.random.default_rng(15)
    bends = np.add(BENT, rng.uniform(-0.25, 0.25, (12, 1, len(BENT))))
    X_WE = planar.pose(bends)
    X_WE[..., 2, 3] += off
    one = np.eye(4)[None]
    lessons = [demonstration(X, one, np.zeros(1, dtype=int), "off") for X in X_WE]
    answers = BatchPlanner(planar.screw_chain()).all_outcomes(lessons, one[None], BENT)
    assert (answers.success == fine).all()
    for step in (0.02, 0.005):
        planner = ReferencePlanner(planar, step=step, joint_step=step)
        assert [planner.plan(BENT, X).success for X in X_WE] == [fine] * len(X_WE)


def test_a_motion_that_is_reachable_by_construction_succeeds(
    seven: Arm, planner: BatchPlanner
) -> None:
    rng = np.random.default_rng(14)
    steps = rng.uniform(-0.1, 0.1, (200, 3, 7))
    lessons = [
        demonstration(X_WE, np.eye(4)[None], np.zeros(3, dtype=int), str(i))
        for i, X_WE in enumerate(seven.screw_chain().pose(REACHING + np.cumsum(steps, axis=1)))
    ]
    answers = planner.all_outcomes(lessons, np.eye(4)[None, None], REACHING)
    assert answers.shape == (1, 200)
    assert answers.success.all()


@pytest.mark.parametrize("order", ["as given", "reversed", "shuffled"])
def test_any_success_is_that_of_all_outcomes(
    planner: BatchPlanner,
    lessons: tuple[Demonstration, ...],
    places: np.ndarray,
    answers: Outcomes,
    order: str,
) -> None:
    chosen = {"as given": [0, 1, 2, 3, 4], "reversed": [4, 3, 2, 1, 0], "shuffled": [2, 0, 4, 1, 3]}
    some = planner.any_success([lessons[i] for i in chosen[order]], places, REACHING)
    np.testing.assert_array_equal(some.any_success, answers.any_success)
    whole = answers[:, chosen[order]]
    tried = some.cause != Cause.NOT_TRIED
    np.testing.assert_array_equal(some.cause[tried], whole.cause[tried])
    np.testing.assert_array_equal(some.segment[tried], whole.segment[tried])
    assert tried[~some.any_success].all()
    assert (some.success.sum(axis=1) <= 1).all()
    assert (some.codes()[~tried] == "-").all()
    failed = ~answers.any_success
    np.testing.assert_array_equal(some.furthest_segment[failed], answers.furthest_segment[failed])


def test_nearest_demonstration_is_tried_first(
    planner: BatchPlanner, lessons: tuple[Demonstration, ...], answers: Outcomes
) -> None:
    for d, lesson in enumerate(lessons):
        there = lesson.X_WO[None]
        some = planner.any_success(lessons, there, REACHING)
        assert some.cause[0, d] != Cause.NOT_TRIED
        if some.success[0, d]:
            assert (np.delete(some.cause[0], d) == Cause.NOT_TRIED).all()


@pytest.mark.parametrize("size", [7, 16, 255, 599])
def test_batch_size_makes_no_difference(
    planner: BatchPlanner,
    lessons: tuple[Demonstration, ...],
    places: np.ndarray,
    answers: Outcomes,
    size: int,
) -> None:
    parts = [places[i : i + size] for i in range(0, N, size)]
    assert_same(concatenate(planner.all_outcomes(lessons, p, REACHING) for p in parts), answers)
    whole = planner.any_success(lessons, places, REACHING)
    assert_same(concatenate(planner.any_success(lessons, p, REACHING) for p in parts), whole)


def test_order_of_instances_and_demonstrations_makes_no_difference(
    planner: BatchPlanner,
    lessons: tuple[Demonstration, ...],
    places: np.ndarray,
    answers: Outcomes,
) -> None:
    rng = np.random.default_rng(15)
    rows, columns = rng.permutation(N), rng.permutation(5)
    mixed = planner.all_outcomes([lessons[i] for i in columns], places[rows], REACHING)
    assert_same(mixed, answers[rows][:, columns])


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_number_of_threads_makes_no_difference(
    seven: Arm,
    lessons: tuple[Demonstration, ...],
    places: np.ndarray,
    answers: Outcomes,
    threads: int,
) -> None:
    planner = BatchPlanner(seven.screw_chain(), threads=threads)
    assert_same(planner.all_outcomes(lessons, places, REACHING), answers)
    some = planner.any_success(lessons, places, REACHING)
    np.testing.assert_array_equal(some.any_success, answers.any_success)


def test_the_callers_arrays_are_not_changed(
    planner: BatchPlanner, lessons: tuple[Demonstration, ...], places: np.ndarray
) -> None:
    X_WO, start = places.copy(), REACHING.copy()
    planner.all_outcomes(lessons, X_WO, start)
    planner.any_success(lessons, X_WO[::-1], start)
    np.testing.assert_array_equal(X_WO, places)
    np.testing.assert_array_equal(start, REACHING)


def test_inputs_need_not_be_contiguous(
    planner: BatchPlanner, lessons: tuple[Demonstration, ...], places: np.ndarray, answers: Outcomes
) -> None:
    spread = np.zeros((N, 4, 4, 8))
    spread[:, ::2, :, ::2] = places
    view = spread[:, ::2, :, ::2]
    assert_same(planner.all_outcomes(lessons, view, list(REACHING)), answers)
    assert_same(planner.all_outcomes(list(lessons), places.tolist(), tuple(REACHING)), answers)


def test_nothing_in_nothing_out(
    planner: BatchPlanner, lessons: tuple[Demonstration, ...], places: np.ndarray
) -> None:
    for plan in (planner.all_outcomes, planner.any_success):
        assert plan(lessons, places[:0], REACHING).shape == (0, 5)
        none = plan([], places, REACHING)
        assert none.shape == (N, 0)
        assert not none.any_success.any()
        assert plan([], places[:0], REACHING).shape == (0, 0)


def test_evaluations_are_counted(
    seven: Arm, lessons: tuple[Demonstration, ...], places: np.ndarray
) -> None:
    planner = BatchPlanner(seven.screw_chain())
    assert planner.evaluations == 0
    planner.all_outcomes(lessons, places, REACHING)
    once = planner.evaluations
    assert once > N * 5
    planner.any_success(lessons, places, REACHING)
    assert once < planner.evaluations < 2 * once


@pytest.mark.parametrize("beyond", [1e-6, 0.1, 0.5])
@pytest.mark.parametrize("inwards", [True, False])
def test_a_start_outside_the_limits_is_a_failure_at_once(
    seven: Arm, beyond: float, inwards: bool
) -> None:
    outside = REACHING.copy()
    outside[3] = seven.upper[3] + beyond
    goal = outside.copy()
    goal[3] += -0.7 if inwards else 0.2
    lesson = demonstration(seven.pose(goal)[None], np.eye(4)[None], np.zeros(1, dtype=int), "one")
    answer = BatchPlanner(seven.screw_chain()).all_outcomes(
        [lesson], np.eye(4)[None, None], outside
    )
    assert answer.codes()[0, 0] == "1:4"
    assert answer.fraction[0, 0] == 0.0


# the recorded tasks


def recorded_outcomes(shared: Path, task: str) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Names of demonstrations, X_WO (N, 1, 4, 4) and codes (N, D) of every fourth instance."""
    file = shared / "reference" / f"outcomes_{task}.csv"
    table = np.genfromtxt(file, delimiter=",", dtype=str)
    x_y = table[1::4, :2].astype(float)
    coordinates = np.concatenate([x_y, np.zeros((len(x_y), 1))], axis=1)
    X_WO = pose_from_planar(coordinates, -0.06447185171756116)
    return table[0, 2:].tolist(), X_WO[:, None], table[1::4, 2:]


def test_agrees_with_the_outcomes_on_record(
    shared: Path,
    calibrated_arm: Arm,
    recorded: Mapping[str, tuple[Demonstration, ...]],
    task: str,
    q_start: np.ndarray,
) -> None:
    names, X_WO, codes = recorded_outcomes(shared, task)
    demonstrations = recorded[task]
    assert [d.name for d in demonstrations] == names
    planner = BatchPlanner(calibrated_arm.screw_chain())
    outcomes = planner.all_outcomes(demonstrations, X_WO, q_start)
    succeeded = codes == "0:0"
    assert np.mean(outcomes.success == succeeded) >= 0.994
    both_failed = ~outcomes.success & ~succeeded
    assert both_failed.sum() > 1000
    segments = np.char.partition(codes[both_failed], ":")[:, 0].astype(int) - 1
    assert np.mean(outcomes.segment[both_failed] == segments) >= 0.97
    some = planner.any_success(demonstrations, X_WO, q_start)
    np.testing.assert_array_equal(some.any_success, outcomes.any_success)


@pytest.mark.slow
def test_agrees_with_the_reference_on_recorded_tasks(
    shared: Path,
    calibrated_arm: Arm,
    recorded: Mapping[str, tuple[Demonstration, ...]],
    task: str,
    q_start: np.ndarray,
) -> None:
    _, X_WO, _ = recorded_outcomes(shared, task)
    rng = np.random.default_rng(16)
    planner, same = BatchPlanner(calibrated_arm.screw_chain()), []
    for _ in range(PAIRS):
        X, lesson = X_WO[rng.integers(len(X_WO))], recorded[task][rng.integers(16)]
        answer = planner.all_outcomes([lesson], X[None], q_start)[0, 0]
        same.append(
            assert_agrees_but_within_a_hair(calibrated_arm, q_start, lesson.transfer(X), answer)
        )
    assert np.mean(same) >= 0.97
