"""Plans with their joint paths: the batch planner's own, from the start to where they end."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner, Cause, Outcomes, Plan
from drake_screw.planning.compiled.step_code import TABLEAU
from drake_screw.planning.compiled.trace import BEND
from drake_screw.planning.contract import POSITION_TOLERANCE, ROTATION_TOLERANCE
from drake_screw.planning.paths import SPACING, dense_output
from drake_screw.robot import Arm
from drake_screw.screws import exp, rotation_angle, sclerp, translation_distance

N = 200
STARTS = {"seven": [0.2, -0.2, 0.1, 1.4, 0.2, -0.3, -0.1], "planar": [0.4, 0.9, 0.4]}
SPREAD = {"seven": [0.3, 0.3, 0.5, 0.15, 0.15, 0.1], "planar": [0.0, 0.0, 1.5, 0.2, 0.2, 0.0]}


@pytest.fixture(scope="module", params=STARTS)
def case(request: pytest.FixtureRequest) -> tuple[Arm, np.ndarray]:
    """An arm and where it starts."""
    return request.getfixturevalue(request.param), np.array(STARTS[request.param])


@pytest.fixture(scope="module")
def lessons(case: tuple[Arm, np.ndarray]) -> tuple[Demonstration, ...]:
    """Three random walks of the joints, of 2 to 4 segments."""
    (arm, start), rng = case, np.random.default_rng(3)
    one = np.eye(4)[None]
    walks = [
        arm.pose(start + np.cumsum(rng.uniform(-0.4, 0.4, (g, arm.n)), axis=0)) for g in (2, 3, 4)
    ]
    return tuple(
        Demonstration(f"walk_{len(X)}", X, np.zeros(len(X), int), one, X, np.arange(len(X)))
        for X in walks
    )


@pytest.fixture(scope="module")
def planned(
    case: tuple[Arm, np.ndarray], lessons: tuple[Demonstration, ...]
) -> tuple[BatchPlanner, np.ndarray, np.ndarray, tuple[Plan, ...]]:
    """Planner, X_WO (N, 1, 4, 4), the demonstration of each, and the plans."""
    (arm, start), rng = case, np.random.default_rng(4)
    spread = SPREAD["seven" if arm.n == 7 else "planar"]
    X_WO = exp(rng.normal(size=(N, 1, 6)) * spread)
    which = rng.integers(3, size=N)
    planner = BatchPlanner(arm.screw_chain())
    return planner, X_WO, which, planner.plans(lessons, X_WO, start, which)


def test_outcomes_are_those_of_all_pairs(case, lessons, planned) -> None:
    planner, X_WO, which, plans = planned
    answers = planner.all_outcomes(lessons, X_WO, case[1])[np.arange(N), which]
    for name in ("cause", "segment", "joint", "fraction"):
        own = np.array([getattr(plan.outcome, name) for plan in plans])
        assert own.tobytes() == getattr(answers, name).tobytes(), name
    for cause in (Cause.SUCCESS, Cause.JOINT_LIMIT, Cause.UNREACHABLE):
        assert (answers.cause == cause).sum() >= 5, cause


def test_a_path_leads_from_the_start_to_where_its_plan_ends(case, lessons, planned) -> None:
    arm, start = case
    _, _, which, plans = planned
    for plan, d in zip(plans, which, strict=True):
        assert plan.q.shape == (len(plan.s), arm.n)
        np.testing.assert_array_equal(plan.q[0], start)
        assert (plan.segment[0], plan.s[0]) == (0, 0.0)
        progress = plan.segment + plan.s
        assert (np.diff(progress) >= 0.0).all()
        end = len(lessons[d].X_OE)
        if not plan.success:
            end = float(plan.outcome.segment) + float(plan.outcome.fraction)
        assert progress[-1] == pytest.approx(end, abs=1e-6)


def test_points_are_close_to_one_another_also_where_a_segment_ends(planned) -> None:
    for plan in planned[-1]:
        motion = np.abs(np.diff(plan.q, axis=0)).sum(axis=1)
        assert motion.max(initial=0.0) < 1.2 * SPACING


def test_paths_keep_the_limits_and_end_at_the_one_that_they_meet(case, planned) -> None:
    arm, _ = case
    for plan in planned[-1]:
        margin = arm.margin(plan.q)
        assert margin.min() >= 0.0
        if plan.outcome.cause == Cause.JOINT_LIMIT:
            assert margin[-1, plan.outcome.joint] == 0.0
            assert (margin[:-1, plan.outcome.joint] > 0.0).all()


def test_paths_stay_on_their_screws_and_pass_all_guiding_poses(case, lessons, planned) -> None:
    """By the plant's kinematics, not the planner's own."""
    arm, start = case
    _, X_WO, which, plans = planned
    off = []
    for plan, X, d in zip(plans, X_WO, which, strict=True):
        guides = lessons[d].transfer(X)
        X_WA = np.concatenate([arm.pose(start)[None], guides])[plan.segment]
        X_WS = sclerp(X_WA, guides[plan.segment], plan.s)
        X_WE = arm.pose(plan.q)
        off.append([translation_distance(X_WE, X_WS).max(), rotation_angle(X_WE, X_WS).max()])
        done = len(guides) if plan.success else int(plan.outcome.segment)
        for segment in range(done):
            last = int(np.flatnonzero(plan.segment == segment)[-1])
            assert plan.s[last] == 1.0
            assert translation_distance(X_WE[last], guides[segment]) <= POSITION_TOLERANCE
            assert rotation_angle(X_WE[last], guides[segment]) <= ROTATION_TOLERANCE
    assert np.median(off, axis=0) == pytest.approx(0.0, abs=2e-4)
    assert np.max(off) < 5e-3


def test_a_single_plan_is_one_of_many(case, lessons, planned) -> None:
    planner, X_WO, which, plans = planned
    for i in (0, 17, 150):
        alone = planner.plan(lessons[which[i]], X_WO[i], case[1])
        for name in ("q", "segment", "s"):
            np.testing.assert_array_equal(getattr(alone, name), getattr(plans[i], name))
        assert alone.outcome.codes() == plans[i].outcome.codes()


def test_a_start_outside_the_limits_is_where_the_plan_ends(case, lessons, planned) -> None:
    planner, X_WO, which, _ = planned
    outside = case[1].copy()
    outside[1] = planner.chain.upper[1] + 0.1
    plans = planner.plans(lessons, X_WO[:3], outside, which[:3])
    answers = planner.all_outcomes(lessons, X_WO[:3], outside)
    assert [str(plan.outcome.codes()) for plan in plans] == ["1:2"] * 3
    assert (answers.codes() == "1:2").all()
    for plan in plans:
        assert isinstance(plan.outcome, Outcomes)
        np.testing.assert_array_equal(plan.q, outside[None])


@pytest.mark.parametrize("which", [[0, 1], [0, 1, 3], [0, -1, 2], [[0, 1, 2]]])
def test_indices_must_be_those_of_demonstrations(case, lessons, planned, which) -> None:
    planner, X_WO, _, _ = planned
    with pytest.raises(ValueError, match="which must be 3 indices from 0 to 2"):
        planner.plans(lessons, X_WO[:3], case[1], which)


@pytest.mark.parametrize("u", [0.0, 0.2, 0.5, 0.9, 1.0])
def test_between_its_ends_a_step_is_known_to_fourth_order(u: float) -> None:
    """On q' = q^2 with q(0) = 1, which is 1 / (1 - s): halving a step divides the error by 32."""

    def error(h: float) -> float:
        slopes = [1.0]
        for row in TABLEAU:
            slopes.append((1.0 + h * np.dot(row, slopes[: len(row)])) ** 2)
        end = 1.0 + h * np.dot(TABLEAU[-1], slopes[:6])
        step = np.array([1.0, end, h * slopes[0], h * slopes[6], h * np.dot(BEND, slopes)])
        (value,) = dense_output(step[None, :, None], np.array([u]))[0]
        return abs(float(value) - 1.0 / (1.0 - u * h))

    assert error(0.05) <= error(0.1) / 24.0
