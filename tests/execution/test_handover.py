"""From one motion to the next: continuous, within limits, and at the latest one after the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drake_screw.execution import TimeLimits
from drake_screw.execution.handover import PERIOD, Braking, braking, overlapped
from drake_screw.execution.timing import time_plan
from drake_screw.planning import ReferencePlanner

LIMITS = TimeLimits()


def first_end(timed) -> float:
    return timed.segments[0].duration


@pytest.mark.parametrize("part", [0.15, 0.3, 0.5, 0.7, 0.9])
def test_an_arm_brakes_on_its_path_from_its_own_velocity(arm, timed, part) -> None:
    t = part * first_end(timed)
    brakes = braking(timed, t, LIMITS.accelerations(arm))
    q, v = timed.path(np.array([t]))
    np.testing.assert_allclose(brakes.q[0], q[0], atol=1e-12)
    np.testing.assert_allclose(brakes.v[0], v[0], atol=1e-12)
    np.testing.assert_array_equal(brakes.v[-1], 0.0)
    path, _ = timed.path(np.arange(t, first_end(timed), 1e-3))
    away = np.linalg.norm(brakes.q[:, None] - path[None], axis=-1).min(axis=1)
    assert away.max() < 1e-3  # samples of the path are that far apart
    np.testing.assert_allclose(np.diff(brakes.q, axis=0) / PERIOD, brakes.v[:-1], atol=0.02)


def test_it_brakes_no_harder_than_it_may_or_than_it_does(arm, timed) -> None:
    for t in np.linspace(0.0, first_end(timed), 13):
        brakes = braking(timed, t, LIMITS.accelerations(arm))
        _, v = timed.path(np.array([t, min(t + PERIOD, first_end(timed))]))
        allowed = np.maximum(LIMITS.acceleration, np.abs(v[1] - v[0]) / PERIOD)
        assert (np.abs(np.diff(brakes.v, axis=0)) <= 1.03 * PERIOD * allowed).all()


def test_it_does_not_leave_the_segment(arm, timed) -> None:
    end = first_end(timed)
    brakes = braking(timed, end - 0.01, LIMITS.accelerations(arm))
    np.testing.assert_allclose(brakes.q[-1], timed.segments[0].q[-1], atol=1e-9)
    assert len(braking(timed, end, LIMITS.accelerations(arm)).q) == 1
    assert braking(timed, end + 0.05, LIMITS.accelerations(arm)).duration > PERIOD


@pytest.fixture(scope="module")
def onwards(arm, timed, guides):
    """A plan to elsewhere from where braking in the middle of the first segment ends."""

    def plan(shift):
        t = 0.5 * first_end(timed)
        brakes = braking(timed, t, LIMITS.accelerations(arm))
        X_WG = guides[:1].copy()
        X_WG[:, :3, 3] += shift
        found = ReferencePlanner(arm, step=0.02).plan(brakes.q[-1], X_WG)
        assert found.success
        poses = np.concatenate([arm.pose(brakes.q[-1:]), X_WG])
        return brakes, time_plan(found, poses, arm, LIMITS).segments[0]

    return plan


@pytest.mark.parametrize("shift", [(0.05, -0.06, 0.0), (-0.08, 0.08, 0.0), (0.0, 0.0, 0.06)])
def test_motions_overlap_within_limits_whichever_way_they_lead(arm, onwards, shift) -> None:
    brakes, after = onwards(shift)
    ways = list(overlapped(brakes, after, arm, LIMITS))
    fastest = np.maximum(LIMITS.speed * arm.velocity_limits, np.abs(brakes.v[0]))
    for way in ways:
        assert not way.screw
        np.testing.assert_allclose(way.q[0], brakes.q[0], atol=1e-9)
        np.testing.assert_allclose(way.v[0], brakes.v[0], atol=1e-9)
        np.testing.assert_allclose(way.q[-1], after.q[-1], atol=1e-9)
        np.testing.assert_allclose(way.v[-1], 0.0, atol=1e-9)
        assert (np.abs(way.v) <= 1.03 * fastest).all()
        assert np.abs(np.diff(way.v, axis=0)).max() / PERIOD <= 1.1 * LIMITS.acceleration
        step = np.diff(way.q, axis=0) / PERIOD
        assert np.abs(step - (way.v[1:] + way.v[:-1]) / 2.0).max() < 5e-3
    lengths = [way.duration for way in ways]
    assert lengths == sorted(lengths)
    assert lengths[-1] == pytest.approx(brakes.duration + after.duration, abs=2 * PERIOD)


def test_going_on_the_same_way_takes_less_than_stopping_first(arm, onwards) -> None:
    brakes, after = onwards((0.02, -0.03, -0.01))
    ways = list(overlapped(brakes, after, arm, LIMITS))
    assert ways[0].duration < ways[-1].duration - 0.5 * brakes.duration


def test_an_arm_at_rest_has_one_way_that_is_the_new_motion(arm, timed) -> None:
    still = braking(timed, 0.0, LIMITS.accelerations(arm))
    (way,) = overlapped(still, timed.segments[0], arm, LIMITS)
    times = PERIOD * np.arange(len(way.q))
    q, _ = timed.path(np.minimum(times, first_end(timed)))
    np.testing.assert_allclose(way.q, q, atol=1e-9)


def test_a_joint_limit_makes_the_new_motion_wait(arm, timed, monkeypatch) -> None:
    """The first joint still comes from below as the new motion leads down again, and quickly."""

    def course(seconds: float, way: float) -> tuple[np.ndarray, np.ndarray]:
        u = np.linspace(0.0, 1.0, round(seconds / PERIOD) + 1)[:, None] * np.eye(arm.n)[:1]
        return way * (3 * u**2 - 2 * u**3), way * 6 * (u - u**2) / seconds

    rest = arm.middle
    up, down = course(2.0, 0.2), course(0.4, -0.2)
    half = len(up[0]) // 2
    brakes = Braking(rest + up[0][half:] - up[0][-1], up[1][half:])
    s = np.linspace(0.0, 1.0, len(down[0]))
    after = replace(timed.segments[0], period=PERIOD, s=s, rate=s, q=rest + down[0], v=down[1])
    quick = TimeLimits(1.0, 50.0)
    assert min(way.q[:, 0].min() for way in overlapped(brakes, after, arm, quick)) < rest[0] - 0.22
    monkeypatch.setattr(arm, "lower", np.append(rest[0] - 0.2 - 1e-6, arm.lower[1:]))
    kept = list(overlapped(brakes, after, arm, quick))
    assert all(way.q[:, 0].min() >= arm.lower[0] for way in kept)
    assert kept[-1].duration == pytest.approx(brakes.duration + after.duration, abs=2 * PERIOD)


def test_it_leads_to_the_pose_that_the_new_motion_leads_to(arm, onwards) -> None:
    brakes, after = onwards((0.05, -0.06, 0.0))
    (first, *_) = overlapped(brakes, after, arm, LIMITS)
    np.testing.assert_array_equal(first.X_WB, after.X_WB)
    np.testing.assert_allclose(first.X_WA, arm.pose(brakes.q[0]), atol=1e-9)
