from __future__ import annotations

import numpy as np
import pytest

from drake_screw.acquisition.guided_arm import LIMIT_MARGIN, LINEAR_SPEED, GuidedArm
from drake_screw.robot import RobotConfig, build_workcell
from drake_screw.screws import exp, rotation_angle, translation_distance

JOINTS = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
PERIOD = 0.02


@pytest.fixture(scope="module")
def arm():
    start = (1.04, -0.22, -0.75, 1.52, 1.88, -0.97, -0.49)
    return build_workcell(RobotConfig("baxter", JOINTS, "left_hand", start)).arm


@pytest.fixture
def guided(arm) -> GuidedArm:
    return GuidedArm(arm, [1.04, -0.22, -0.75, 1.52, 1.88, -0.97, -0.49], PERIOD)


def test_the_end_effector_goes_where_it_is_guided(guided, arm) -> None:
    X_WG = arm.pose(guided.q) @ exp([0.1, -0.2, 0.5, 0.05, 0.1, -0.05])
    for _ in range(500):
        if not guided.guide_end_effector(X_WG):
            break
    X_WE = arm.pose(guided.q)
    assert translation_distance(X_WE, X_WG) < 1e-3
    assert rotation_angle(X_WE, X_WG) < 1e-3
    assert not guided.stuck


def test_the_end_effector_keeps_its_speed(guided, arm) -> None:
    X_WG = arm.pose(guided.q)
    X_WG[:3, 3] += [0.2, -0.2, 0.0]
    for _ in range(20):
        before = arm.pose(guided.q)
        guided.guide_end_effector(X_WG)
        assert translation_distance(before, arm.pose(guided.q)) <= 1.05 * LINEAR_SPEED * PERIOD


def test_limits_hold_and_are_reported(guided, arm) -> None:
    X_WG = arm.pose(guided.q)
    X_WG[:3, 3] += [1.5, 0.5, 0.0]
    stuck = False
    for _ in range(800):
        guided.guide_end_effector(X_WG)
        stuck |= guided.stuck
        assert (arm.margin(guided.q) >= LIMIT_MARGIN - 1e-9).all()
    assert stuck


def test_joints_go_where_they_are_guided_as_fast_as_they_may(guided, arm) -> None:
    goal = guided.q.copy()
    goal[6] = 10.0
    steps = 0
    while guided.guide_joints(goal):
        steps += 1
    assert guided.q[6] == pytest.approx(arm.upper[6] - LIMIT_MARGIN)
    assert np.allclose(np.delete(guided.q, 6), np.delete(goal, 6))
    assert steps * PERIOD > (arm.upper[6] + 0.49) / arm.velocity_limits[6]


def test_an_arm_that_was_stretched_out_comes_back(guided, arm) -> None:
    X_WG = arm.pose(guided.q)
    for place in ([0.46, 1.17, -0.10], [0.3, 0.6, 0.0], [1.25, 0.7, 0.0], [0.9, 0.4, 0.1]):
        X_WG[:3, 3] = place
        for _ in range(300):
            guided.guide_end_effector(X_WG)
            assert (arm.margin(guided.q) >= LIMIT_MARGIN - 1e-9).all()
        if place[0] in (0.3, 0.9):
            assert translation_distance(arm.pose(guided.q), X_WG) < 1e-3
            assert rotation_angle(arm.pose(guided.q), X_WG) < 1e-3
