"""Position and one axis of the hand are followed, and the roll about it is free."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner, Cause, Outcomes, ReferencePlanner
from drake_screw.planning.compiled import Settings
from drake_screw.planning.roll import axes_apart, free_frame, rolled, turned_apart
from drake_screw.robot import Arm
from drake_screw.robot.directions import has, missing_turn, spread_configurations
from drake_screw.screws import exp, inverse, log, pose_from_planar, shift
from tests.planning.compiled_arms import bench, random_chain
from tests.planning.conftest import serial_arm
from tests.planning.test_batch import MIDDLE, REACHING, demonstration

Z, OBLIQUE = (0.0, 0.0, 1.0), (0.3, 0.4, 0.8)
N = 120


@dataclass(frozen=True)
class Case:
    """An arm, where it starts, the axis that is free, and what it is asked for."""

    arm: Arm
    q: np.ndarray
    axis: tuple[float, float, float]
    lessons: tuple[Demonstration, ...]
    places: np.ndarray


def five_joints() -> Arm:
    """A table-top arm: it swings, lifts, bends twice, and rolls its hand."""
    x, y, z = "1 0 0", "0 1 0", "0 0 1"
    return serial_arm(
        [
            ("0 0 0.1", z, 1.9),
            ("0.02 0 0.03", y, 1.8),
            ("0.11 0 0.03", y, 1.7),
            ("0.13 0 0", y, 1.7),
            ("0.03 0 0", x, 2.7),
        ]
    )


def case_of(arm: Arm, q: np.ndarray, axis, middle, spread, seed: int = 3) -> Case:
    """Demonstrations that also roll the hand about the axis, as the arm itself need not."""
    rng, lessons = np.random.default_rng(seed), []
    turn = np.concatenate([np.array(axis) / np.linalg.norm(axis), np.zeros(3)])
    for i in range(3):
        X_WE = arm.pose(q + np.cumsum(rng.uniform(-0.25, 0.25, (2 + i, arm.n)), axis=0))
        X_WE = X_WE @ exp(rng.uniform(-1.0, 1.0, (2 + i, 1)) * turn)
        X_WO = pose_from_planar(middle + 0.2 * spread * rng.uniform(-1.0, 1.0, (2, 3)))
        lessons.append(demonstration(X_WE, X_WO, rng.integers(0, 2, 2 + i), f"demo_{i}"))
    places = pose_from_planar(middle + spread * rng.uniform(-1.0, 1.0, (N, 2, 3)))
    return Case(arm, q, axis, tuple(lessons), places)


@pytest.fixture(
    scope="module",
    params=[pytest.param("seven z", marks=pytest.mark.slow), "five z", "five oblique"],
)
def case(request, seven: Arm) -> Case:
    if request.param == "seven z":
        return case_of(seven, REACHING, Z, MIDDLE, np.array([0.25, 0.25, 0.6]))
    q, middle = np.array([0.1, -0.6, 1.0, 0.6, 0.1]), np.array([[0.25, 0.0, 0.0], [0.25, 0.05, 0]])
    axis = Z if request.param == "five z" else OBLIQUE
    return case_of(five_joints(), q, axis, middle, np.array([0.06, 0.1, 0.3]))


@pytest.fixture(scope="module")
def planner(case: Case) -> BatchPlanner:
    return BatchPlanner(case.arm.screw_chain(), free_axis=case.axis)


@pytest.fixture(scope="module")
def answers(case: Case, planner: BatchPlanner) -> Outcomes:
    return planner.all_outcomes(case.lessons, case.places, case.q)


def reference(case: Case, step: float = 0.02) -> ReferencePlanner:
    return ReferencePlanner(case.arm, step=step, joint_step=step / 2.0, free_axis=case.axis)


def test_a_rolled_pose_keeps_origin_and_axis() -> None:
    rng = np.random.default_rng(0)
    A, B, G = exp(rng.normal(size=(3, 6)))
    found = rolled(A, B, G)
    np.testing.assert_allclose(found[:3, 2:], G[:3, 2:], atol=1e-15)
    np.testing.assert_allclose(np.linalg.det(found[:3, :3]), 1.0)
    C = B @ exp(np.array([0.0, 0.0, 0.7, 0.0, 0.0, 0.0]))
    np.testing.assert_allclose(rolled(C, B, B), C, atol=1e-12)
    assert axes_apart(C, B) < 1e-12


@pytest.mark.parametrize("axis", [Z, (1.0, 0.0, 0.0), (0.0, -2.0, 0.0), OBLIQUE])
def test_the_free_frame_has_that_z_axis(axis) -> None:
    R = free_frame(axis)[:3, :3]
    np.testing.assert_allclose(R[:, 2], np.array(axis) / np.linalg.norm(axis), atol=1e-15)
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-15)
    assert np.linalg.det(R) > 0.0


def test_whole_poses_are_followed_by_the_same_programs() -> None:
    for n in (3, 6, 7):
        chain = random_chain(np.random.default_rng(n), n)
        plain, free = bench(chain).programs, bench(chain, Settings(roll_free=True)).programs
        again = bench(chain, Settings(roll_free=False)).programs
        assert {k: str(p) for k, p in plain.items()} == {k: str(p) for k, p in again.items()}
        assert str(plain["aim"]) != str(free["aim"])


def test_outcomes_are_those_of_the_reference(case: Case, answers: Outcomes) -> None:
    assert answers.success.any()
    assert not answers.success.all()
    for i in range(0, N, 20):
        for d, lesson in enumerate(case.lessons):
            guides = lesson.transfer(case.places[i])
            found = str(reference(case).plan(case.q, guides).outcome.codes())
            if found != str(answers[i, d].codes()):  # within a hair: steps decide
                found = str(reference(case, 0.002).plan(case.q, guides).outcome.codes())
            assert found == str(answers[i, d].codes())


def test_so_are_the_joint_paths(case: Case, planner: BatchPlanner, answers: Outcomes) -> None:
    solved = np.argwhere(answers.success)[:: max(answers.success.sum() // 5, 1)][:5]
    for i, d in solved:
        plan = planner.plan(case.lessons[d], case.places[i], case.q)
        exact = reference(case).plan(case.q, case.lessons[d].transfer(case.places[i]))
        assert exact.success
        ends = [
            p.q[np.flatnonzero((p.segment == 0) & (p.s >= 1.0 - 1e-9))[-1]] for p in (plan, exact)
        ]
        np.testing.assert_allclose(*ends, atol=2e-3)
        np.testing.assert_allclose(plan.q[-1], exact.q[-1], atol=2e-3)
        np.testing.assert_array_equal(plan.free_axis, case.axis)


def test_the_screws_carry_position_and_axis_and_the_roll_is_free(
    case: Case, planner: BatchPlanner, answers: Outcomes
) -> None:
    drifted = []
    for i, d in np.argwhere(answers.success)[:6]:
        plan = planner.plan(case.lessons[d], case.places[i], case.q)
        begins = [case.arm.pose(plan.q[0]), *plan.guides]
        X_WE = case.arm.pose(plan.q)
        for k, G in enumerate(plan.guides):
            here = (plan.segment == k) & (plan.s > 0.0)
            V = log(G @ inverse(begins[k]))
            X_WS = exp(plan.s[here, None] * V) @ begins[k]
            np.testing.assert_allclose(X_WE[here][:, :3, 3], X_WS[:, :3, 3], atol=1e-3)
            assert turned_apart(X_WE[here], X_WS, case.axis).max() < 3e-3
        last = X_WE[-1]
        assert np.linalg.norm(last[:3, 3] - plan.guides[-1][:3, 3]) <= 1e-4
        assert turned_apart(last, plan.guides[-1], case.axis) <= 1e-3
        drifted.append(turned_apart(last, plan.guides[-1], None))
    assert max(drifted) > 0.1


@pytest.mark.slow
def test_small_steps_of_another_kind_agree(case: Case, answers: Outcomes) -> None:
    """Euler's method on the recorded screw's own set points, without any aim again."""
    same, seen = 0, 0
    for i in range(0, N, 20):
        for d, lesson in enumerate(case.lessons):
            seen += 1
            same += bool(answers.success[i, d]) == euler_succeeds(
                case, lesson.transfer(case.places[i])
            )
    assert same >= seen - 1


def euler_succeeds(case: Case, guides: np.ndarray, steps: int = 300) -> bool:
    arm, q = case.arm, case.q.copy()
    a = np.array(case.axis) / np.linalg.norm(case.axis)
    X_WA = arm.pose(q)
    for G in guides:
        V = log(G @ inverse(X_WA))
        for k in range(1, steps + 1):
            X_WS = exp(k / steps * V) @ X_WA
            X_WE, J_WE = arm.pose_and_jacobian(q)
            W = shift(V, X_WE[:3, 3]) / steps
            z, z_S = X_WE[:3, :3] @ a, X_WS[:3, :3] @ a
            W[3:] = X_WS[:3, 3] - X_WE[:3, 3]
            W[:3] = np.cross(z, z_S)
            keep = np.eye(3) - np.outer(z, z)
            J = np.concatenate([keep @ J_WE[:3], J_WE[3:]])
            dq = np.linalg.pinv(J, rcond=1e-6) @ W
            if np.linalg.norm(dq) > 1.0:
                return False
            q = q + dq
            if (arm.margin(q) <= 0.0).any():
                return False
        X_WE = arm.pose(q)
        if np.linalg.norm(X_WE[:3, 3] - G[:3, 3]) > 1e-2 or turned_apart(X_WE, G, case.axis) > 0.02:
            return False
        X_WA = G
    return True


def test_five_joints_cannot_follow_whole_poses() -> None:
    arm = five_joints()
    q = np.array([0.1, -0.6, 1.0, 0.6, 0.1])
    G = arm.pose(q) @ exp(np.array([0.0, 0.0, 0.3, 0.02, 0.0, 0.0]))
    found = ReferencePlanner(arm, step=0.02).plan(q, G[None])
    assert found.outcome.cause == Cause.UNREACHABLE
    assert ReferencePlanner(arm, step=0.02, free_axis=Z).plan(q, G[None]).success


def test_a_segment_that_only_rolls_is_over_at_once() -> None:
    arm = five_joints()
    q = np.array([0.1, -0.6, 1.0, 0.6, 0.1])
    X_WO = np.eye(4)[None]
    X_WE = arm.pose(q) @ exp(np.array([[0.0, 0.0, 1.0, 0, 0, 0], [0.0, 0.0, -1.0, 0, 0, 0]]))
    lesson = demonstration(X_WE, X_WO, np.zeros(2, dtype=int), "rolls")
    plan = BatchPlanner(arm.screw_chain(), free_axis=Z).plan(lesson, X_WO, q)
    assert plan.success
    np.testing.assert_allclose(plan.q, np.tile(q, (len(plan.q), 1)), atol=1e-6)


def test_which_axes_an_arm_can_do_without() -> None:
    chain = five_joints().screw_chain()
    assert not has(chain)
    on_axis = chain.home.copy()
    on_axis[2, 3] -= 0.05
    rolls = replace(chain, home=on_axis)  # with E on its last joint's axis, x
    assert [has(rolls, axis) for axis in np.eye(3)] == [False, True, True]
    chain, q = rolls, spread_configurations(chain, 3)
    assert (np.abs(missing_turn(chain, q)[:, 0]) < 1e-9).all()
    six = random_chain(np.random.default_rng(1), 6)
    assert has(six)
    assert not has(random_chain(np.random.default_rng(1), 4), Z)
