"""Time laws: limits, rests at the guiding poses, and the screw in between."""

from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np
import pytest

from drake_screw.execution import TimedPlan, TimeLimits
from drake_screw.execution.timing import TimedSegment, time_plan
from drake_screw.planning import Plan, ReferencePlanner
from drake_screw.planning.outcomes import Cause, one_outcome
from drake_screw.planning.rounding import rounded
from drake_screw.screws import exp, rotation_angle, sclerp, translation_distance


def largest_ratios(
    plan: TimedPlan, velocity: np.ndarray, acceleration: float, *, every: float = 1e-3
) -> tuple[float, float]:
    """The largest velocity and acceleration of a timed plan, over their limits.

    Accelerations are difference quotients of the velocity over `every` seconds.
    """
    _, _, v = plan.sampled(every)
    a = np.diff(v[:-1], axis=0) / every
    return float((np.abs(v) / velocity).max()), float((np.abs(a) / acceleration).max())


@pytest.mark.parametrize(
    "limits",
    [TimeLimits(), TimeLimits(0.05), TimeLimits(1.0, 8.0, 0.02), TimeLimits(0.3, 0.4, 0.3)],
)
def test_limits_hold_between_grid_points(arm, time_it, limits) -> None:
    timed = time_it(limits)
    velocity, acceleration = largest_ratios(
        timed, limits.speed * arm.velocity_limits, limits.acceleration, every=4e-4
    )
    assert velocity <= 1.0 + 1e-3
    assert acceleration <= 1.0 + 1e-3
    assert max(velocity, acceleration) > 0.8


@pytest.mark.parametrize("seed", [0, 1, 3, 4, 5, 6])
def test_random_plans_keep_the_limits(arm, seed) -> None:
    rng = np.random.default_rng(seed)
    q = (arm.lower + arm.upper) / 2 + 0.2 * (arm.upper - arm.lower) * rng.uniform(-1, 1, arm.n)
    X_WS = arm.pose(q)
    X_WG = exp(rng.uniform(-1, 1, 6) * [0.3, 0.3, 0.3, 0.0, 0.0, 0.0]) @ X_WS
    X_WG[:3, 3] = X_WS[:3, 3] + rng.uniform(-0.05, 0.05, 3)
    plan = ReferencePlanner(arm, step=0.02).plan(q, X_WG[None])
    assert plan.success
    timed = time_plan(plan, np.stack([X_WS, X_WG]), arm)
    ratios = largest_ratios(timed, 0.5 * arm.velocity_limits, 2.0, every=4e-4)
    assert max(ratios) <= 1.0 + 1e-3


def test_each_segment_runs_from_rest_to_rest_in_order(timed) -> None:
    for piece in timed.segments:
        assert piece.s[0] == 0.0
        assert piece.s[-1] == pytest.approx(1.0, abs=1e-12)
        assert (np.diff(piece.s) >= 0.0).all()
        np.testing.assert_allclose(piece.v[[0, -1]], 0.0, atol=1e-12)
    np.testing.assert_allclose(timed.segments[0].q[-1], timed.segments[1].q[0], atol=1e-9)


def test_the_joint_path_stays_on_the_screws(arm, timed, guides) -> None:
    for t in np.linspace(0.0, timed.duration, 60):
        point = timed.at(t)
        X_WA, X_WB = timed.poses[point.segment], timed.poses[point.segment + 1]
        X_WE, X_WS = arm.pose(point.q), sclerp(X_WA, X_WB, point.s)
        assert translation_distance(X_WE, X_WS) < 1e-5
        assert rotation_angle(X_WE, X_WS) < 1e-5
    np.testing.assert_allclose(arm.pose(timed.at(timed.duration).q), guides[-1], atol=1e-6)


def test_velocities_are_derivatives(timed) -> None:
    for t in np.linspace(0.05, timed.duration - 0.05, 40):
        before, here, after = (timed.at(t + h) for h in (-1e-4, 0.0, 1e-4))
        if before.segment == after.segment:
            np.testing.assert_allclose((after.q - before.q) / 2e-4, here.v, atol=2e-5)
            assert (after.s - before.s) / 2e-4 == pytest.approx(here.rate, abs=2e-4)


def test_slower_limits_take_longer(time_it) -> None:
    fast, slow = time_it(TimeLimits(0.5)), time_it(TimeLimits(0.05))
    assert slow.duration > 1.5 * fast.duration


def test_it_rests_before_and_after(timed) -> None:
    np.testing.assert_array_equal(timed.at(-1.0).q, timed.segments[0].q[0])
    np.testing.assert_allclose(timed.at(timed.duration + 9.0).q, timed.segments[-1].q[-1])
    assert timed.at(timed.duration + 9.0).segment == 1


def test_samples_include_both_ends(timed) -> None:
    t, q, v = timed.sampled(0.1)
    assert t[0] == 0.0
    assert t[-1] == timed.duration
    assert len(t) == len(q) == len(v)
    np.testing.assert_allclose(np.diff(t)[:-1], 0.1)


def test_segments_follow_one_another_without_a_gap(timed) -> None:
    begins = np.cumsum([0.0, *(piece.duration for piece in timed.segments)])
    assert begins[-1] == pytest.approx(timed.duration)
    assert timed.at(begins[1] - 1e-6).segment == 0
    assert timed.at(begins[1] + 1e-6).segment == 1


def test_a_segment_without_motion_takes_the_smoothing_time(arm, plan) -> None:
    X = arm.pose(plan.q[0])
    still = Plan(
        np.repeat(plan.q[:1], 3, axis=0),
        np.zeros(3, dtype=int),
        np.array([0.0, 0.5, 1.0]),
        one_outcome(Cause.SUCCESS),
        X[None],
    )
    timed = time_plan(still, np.stack([X, X]), arm)
    assert timed.duration == pytest.approx(TimeLimits().smoothing)
    np.testing.assert_array_equal(timed.at(0.05).q, plan.q[0])


def test_few_points_are_enough(arm, plan, guides) -> None:
    """A plan may come with its ends only."""
    ends = [0, int(np.flatnonzero(plan.segment == 0)[-1])]
    s = np.array([0.0, 1.0])
    short = replace(plan, q=plan.q[ends], segment=plan.segment[ends], s=s)
    timed = time_plan(short, np.stack([arm.pose(plan.q[0]), guides[0]]), arm)
    np.testing.assert_allclose(timed.segments[0].q[[0, -1]], short.q, atol=1e-12)


@pytest.mark.parametrize(
    "twist",
    [
        [0.4, -0.2, 0.9, 0.3, 0.1, -0.2],
        [0, 0, 0, 0.1, -0.3, 0.2],
        [0, 0, 0, 0, 0, 0],
        [1e-7, 0, 2e-7, 0.1, 0, 0],
        [0, 3.1, 0, 0.2, 0.1, 0],
    ],
)
def test_pose_is_the_exponential(twist) -> None:
    X_WA = exp(np.array([0.3, 0.2, -0.5, 0.7, 0.1, 0.4]))
    X_WB = exp(np.array(twist, dtype=float)) @ X_WA
    piece = TimedSegment(X_WA, X_WB, 0.1, *(np.zeros((2, 1)) for _ in range(4)))
    for s in (0.0, 0.37, 1.0):
        np.testing.assert_allclose(piece.pose(s), sclerp(X_WA, X_WB, s), atol=1e-12)


def test_a_plan_is_its_own_copy_and_an_empty_one_is_empty(timed) -> None:
    assert copy.deepcopy(timed) is timed
    assert TimedPlan(()).duration == 0.0
    assert replace(timed, segments=timed.segments[:1]).duration < timed.duration


def test_samples_are_the_set_points(timed) -> None:
    t, q, v = timed.sampled(0.013)
    points = [timed.at(time) for time in t]
    np.testing.assert_allclose(q, [p.q for p in points], atol=1e-12)
    np.testing.assert_allclose(v, [p.v for p in points], atol=1e-9)


def test_the_more_tightly_corners_are_followed_the_law_is_no_slower_for_it(arm) -> None:
    """The grid has the path's own points, so that limits are kept at tight corners, too.

    Where they are kept at a few places only, the law is slowed down as a whole for what it exceeds
    in between: by a factor of seven, on the tightest of these.
    """
    around = np.random.default_rng(1).uniform(-0.5, 0.5, (5, arm.n))
    corners = (arm.lower + arm.upper) / 2.0 + around
    durations = []
    for q in rounded(corners):
        s, segment = np.linspace(0.0, 1.0, len(q)), np.zeros(len(q), dtype=int)
        X = arm.pose(q[[0, -1]])
        found = Plan(q, segment, s, one_outcome(Cause.SUCCESS), X[1:])
        timed = time_plan(found, X, arm)
        ratios = largest_ratios(timed, 0.5 * arm.velocity_limits, 2.0, every=4e-4)
        assert max(ratios) <= 1.0 + 1e-3
        durations.append(timed.duration)
    assert max(durations) < 1.25 * min(durations)
