"""The reference planner follows constant screws to every guiding pose, or says why it cannot."""

from __future__ import annotations

import copy
from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Cause, Plan, ReferencePlanner
from drake_screw.robot import Arm
from drake_screw.screws import rotation_angle, sclerp, translation_distance

MIDDLE = np.array([0.2, 0.4, 0.1, 0.8, 0.3, 0.5, -0.2])
SEEDS = st.integers(0, 2**32 - 1)
few = settings(deadline=None, max_examples=15)


def with_limits(arm: Arm, lower: np.ndarray, upper: np.ndarray) -> Arm:
    other = copy.copy(arm)
    other.lower, other.upper = lower, upper
    return other


def nearby(arm: Arm, q: np.ndarray, seed: int, count: int, step: float = 0.25) -> np.ndarray:
    """End-effector poses of a random walk of the joints."""
    steps = np.random.default_rng(seed).uniform(-step, step, (count, arm.n))
    return arm.pose(q + np.cumsum(steps, axis=0))


def check_success(arm: Arm, plan: Plan, q_start: np.ndarray, guides: np.ndarray) -> None:
    assert plan.success
    assert plan.outcome.codes() == "0:0"
    assert plan.outcome.segment == plan.outcome.joint == -1
    assert plan.outcome.fraction == 1.0
    assert len(plan.q) == len(plan.segment) == len(plan.s)
    np.testing.assert_array_equal(plan.q[0], q_start)
    assert (arm.margin(plan.q) > 0.0).all()
    assert (np.diff(plan.segment) >= 0).all()
    X_WE = arm.pose(plan.q)
    before = X_WE[0]
    for k, X_WG in enumerate(guides):
        inside = plan.segment == k
        assert inside.any()
        assert (np.diff(plan.s[inside]) > 0.0).all()
        assert plan.s[inside][-1] == 1.0
        on_screw = sclerp(before, X_WG, plan.s[inside])
        assert translation_distance(X_WE[inside], on_screw).max() < 2e-5
        assert rotation_angle(X_WE[inside], on_screw).max() < 2e-4
        before = X_WE[inside][-1]
        assert translation_distance(before, X_WG) <= 1e-4
        assert rotation_angle(before, X_WG) <= 1e-3


@few
@given(seed=SEEDS)
def test_success_follows_the_screws_and_ends_on_each_guiding_pose(seven: Arm, seed: int) -> None:
    guides = nearby(seven, MIDDLE, seed, 3)
    wide = with_limits(seven, -6.0 * np.ones(7), 6.0 * np.ones(7))
    plan = ReferencePlanner(wide, step=0.02, joint_step=0.01).plan(MIDDLE, guides)
    check_success(wide, plan, MIDDLE, guides)


def test_joint_path_is_the_least_norm_one(seven: Arm) -> None:
    guides = nearby(seven, MIDDLE, 3, 1)
    plan = ReferencePlanner(seven, step=0.02).plan(MIDDLE, guides)
    assert plan.success
    for a, b in zip(plan.q[:-2], plan.q[1:-1], strict=True):
        J = seven.jacobian((a + b) / 2.0)
        moved = b - a
        across = moved - np.linalg.pinv(J) @ (J @ moved)
        assert np.linalg.norm(across) < 1e-4 * np.linalg.norm(moved)


def test_smaller_steps_give_the_same_path(seven: Arm) -> None:
    guides = nearby(seven, MIDDLE, 4, 2)
    coarse = ReferencePlanner(seven, step=0.04, joint_step=0.02).plan(MIDDLE, guides)
    fine = ReferencePlanner(seven, step=0.01, joint_step=0.005).plan(MIDDLE, guides)
    assert coarse.success
    assert fine.success
    assert len(fine.q) > 2 * len(coarse.q)
    np.testing.assert_allclose(coarse.q[-1], fine.q[-1], atol=1e-5)


def test_even_long_steps_end_on_the_guiding_poses(seven: Arm) -> None:
    guides = nearby(seven, MIDDLE, 4, 2)
    plan = ReferencePlanner(seven, step=1.0, joint_step=1.0).plan(MIDDLE, guides)
    assert plan.success
    ends = seven.pose(plan.q[[np.flatnonzero(plan.segment == k)[-1] for k in range(2)]])
    assert translation_distance(ends, guides).max() <= 1e-5
    assert rotation_angle(ends, guides).max() <= 1e-4


def test_steps_are_no_longer_than_asked(seven: Arm) -> None:
    guides = nearby(seven, MIDDLE, 5, 2, step=0.4)
    plan = ReferencePlanner(seven, step=0.02, joint_step=0.01).plan(MIDDLE, guides)
    assert np.linalg.norm(np.diff(plan.q, axis=0), axis=1).max() < 1.1 * 0.01
    X_WE = seven.pose(plan.q)
    assert rotation_angle(X_WE[1:], X_WE[:-1]).max() < 1.05 * 0.02


@few
@given(seed=SEEDS, joint=st.integers(0, 6), at_upper=st.booleans())
def test_a_limit_in_the_way_is_where_the_path_ends(
    seven: Arm, seed: int, joint: int, at_upper: bool
) -> None:
    guides = nearby(seven, MIDDLE, seed, 3)
    wide = with_limits(seven, -6.0 * np.ones(7), 6.0 * np.ones(7))
    free = ReferencePlanner(wide, step=0.02, joint_step=0.01).plan(MIDDLE, guides)
    travel = free.q[:, joint] - MIDDLE[joint]
    reached = travel.max() if at_upper else travel.min()
    if abs(reached) < 0.02:
        return
    lower, upper = wide.lower.copy(), wide.upper.copy()
    (upper if at_upper else lower)[joint] = MIDDLE[joint] + 0.6 * reached
    tight = with_limits(seven, lower, upper)
    plan = ReferencePlanner(tight, step=0.02, joint_step=0.01).plan(MIDDLE, guides)
    assert not plan.success
    assert plan.outcome.cause == Cause.JOINT_LIMIT
    assert plan.outcome.joint == joint
    margin = tight.margin(plan.q)
    assert abs(margin[-1, joint]) < 1e-9
    assert (np.delete(margin[-1], joint) > 0.0).all()
    assert (margin[:-1] > 0.0).all()
    assert plan.outcome.segment == plan.segment[-1]
    assert plan.outcome.fraction == pytest.approx(plan.s[-1])
    beyond = travel >= 0.6 * reached if at_upper else travel <= 0.6 * reached
    crossing = int(np.argmax(beyond))
    progress = free.segment + free.s
    done = plan.outcome.segment + plan.s[-1]
    assert progress[crossing - 1] - 1e-3 <= done <= progress[crossing] + 1e-3


@pytest.mark.parametrize("away", [[5.0, 0.0, 0.0], [0.0, 0.0, 3.0], [-2.0, -2.0, 0.5]])
def test_poses_out_of_reach_fail_before_they_are_reached(seven: Arm, away: list[float]) -> None:
    X_WE = seven.pose(MIDDLE)
    goal = X_WE.copy()
    goal[:3, 3] += away
    plan = ReferencePlanner(seven, step=0.02, joint_step=0.01).plan(MIDDLE, goal[None])
    assert plan.outcome.cause in (Cause.UNREACHABLE, Cause.JOINT_LIMIT)
    assert plan.outcome.segment == 0
    assert 0.0 < plan.outcome.fraction < 1.0
    assert (seven.margin(plan.q) >= -1e-12).all()


def test_a_stretched_arm_cannot_reach_further(planar: Arm) -> None:
    q = np.array([0.1, 0.3, 0.2])
    X_WE = planar.pose(q)
    goal = X_WE.copy()
    goal[:2, 3] *= 2.0
    plan = ReferencePlanner(planar, step=0.02, joint_step=0.01).plan(q, goal[None])
    assert plan.outcome.cause == Cause.UNREACHABLE
    assert plan.outcome.joint == -1
    assert plan.outcome.codes() == "1:n"
    assert np.linalg.norm(planar.pose(plan.q[-1])[:2, 3]) <= 1.0 + np.hypot(0.0, 0.01)


def test_the_second_segment_is_named_if_it_fails(planar: Arm) -> None:
    q = np.array([0.5, 0.8, 0.3])
    near, far = planar.pose(q + 0.1), planar.pose(q + 0.1)
    far[:2, 3] *= 3.0
    plan = ReferencePlanner(planar, step=0.02).plan(q, np.stack([near, far]))
    assert plan.outcome.segment == 1
    assert plan.outcome.codes() == "2:n"
    assert set(plan.segment) == {0, 1}


def test_fewer_than_six_joints_follow_what_they_can(planar: Arm) -> None:
    q = np.array([0.5, 0.8, 0.3])
    guides = planar.pose(np.add(q, [[0.2, -0.1, 0.3], [0.4, 0.2, -0.2]]))
    plan = ReferencePlanner(planar, step=0.02).plan(q, guides)
    check_success(planar, plan, q, guides)
    lifted = guides.copy()
    lifted[:, 2, 3] += 0.05
    assert ReferencePlanner(planar, step=0.02).plan(q, lifted).outcome.cause == Cause.UNREACHABLE


def test_a_motion_that_the_joints_do_not_have_fails_before_it_is_begun(planar: Arm) -> None:
    """Or else a path would lead to somewhere else, as far as the joints can go."""
    bent = np.array([0.3, 0.8, 0.4])
    lifted = planar.pose(np.add(bent, [0.2, -0.1, 0.1]))
    lifted[2, 3] += 0.1
    plan = ReferencePlanner(planar).plan(bent, lifted[None])
    assert plan.outcome.cause == Cause.UNREACHABLE
    assert plan.outcome.fraction == 0.0
    np.testing.assert_array_equal(plan.q, bent[None])


def test_a_residual_within_the_tolerances_does_no_harm_even_at_the_segments_end(
    planar: Arm,
) -> None:
    bent = np.array([0.3, 0.8, 0.4])
    lifted = planar.pose(np.add(bent, [0.2, -0.1, 0.1]))
    lifted[2, 3] += 5e-5
    assert ReferencePlanner(planar).plan(bent, lifted[None]).success


def test_nothing_to_do_is_success(seven: Arm) -> None:
    planner = ReferencePlanner(seven)
    none = planner.plan(MIDDLE, np.empty((0, 4, 4)))
    assert none.success
    np.testing.assert_array_equal(none.q, [MIDDLE])
    here = planner.plan(MIDDLE, np.tile(seven.pose(MIDDLE), (3, 1, 1)))
    assert here.success
    np.testing.assert_allclose(here.q, np.tile(MIDDLE, (len(here.q), 1)), atol=1e-12)


@pytest.mark.parametrize("beyond", [1e-6, 0.1, 0.5])
@pytest.mark.parametrize("inwards", [True, False])
def test_a_start_outside_the_limits_is_a_failure_at_once(
    seven: Arm, beyond: float, inwards: bool
) -> None:
    outside = MIDDLE.copy()
    outside[3] = seven.upper[3] + beyond
    goal = outside.copy()
    goal[3] += -0.7 if inwards else 0.2
    plan = ReferencePlanner(seven, step=0.02).plan(outside, seven.pose(goal)[None])
    assert plan.outcome.codes() == "1:4"
    assert plan.outcome.fraction == 0.0
    np.testing.assert_array_equal(plan.q[-1], outside)


def test_recorded_demonstrations_can_be_replayed_where_they_were_recorded(
    calibrated_arm: Arm,
    recorded: Mapping[str, tuple[Demonstration, ...]],
    task: str,
    q_start: np.ndarray,
) -> None:
    planner = ReferencePlanner(calibrated_arm, step=0.04, joint_step=0.02)
    for demonstration in recorded[task][::4]:
        guides = demonstration.transfer(demonstration.X_WO)
        plan = planner.plan(q_start, guides)
        check_success(calibrated_arm, plan, q_start, guides)
