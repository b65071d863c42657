from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from drake_screw.acquisition import Suggestion
from drake_screw.acquisition.interactive import KEEP_OFF, SPEED, InteractiveTeacher, LedArm
from drake_screw.demonstrations import Recording
from drake_screw.robot import RobotConfig, build_workcell
from drake_screw.screws import exp, pose_from_planar, rotation_angle, translation_distance

JOINTS = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
PERIOD = 0.02


@pytest.fixture(scope="module")
def arm():
    start = (1.04, -0.22, -0.75, 1.52, 1.88, -0.97, -0.49)
    return build_workcell(RobotConfig("baxter", JOINTS, "left_hand", start)).arm


@pytest.fixture
def led(arm) -> LedArm:
    return LedArm(arm, [1.04, -0.22, -0.75, 1.52, 1.88, -0.97, -0.49], PERIOD)


def test_the_hand_goes_where_it_is_led(led, arm) -> None:
    X_WG = arm.pose(led.q) @ exp([0.1, -0.2, 0.5, 0.05, 0.1, -0.05])
    for _ in range(500):
        if not led.lead_hand(X_WG):
            break
    X_WE = arm.pose(led.q)
    assert translation_distance(X_WE, X_WG) < 1e-3
    assert rotation_angle(X_WE, X_WG) < 1e-3
    assert not led.stuck


def test_the_hand_keeps_its_speed(led, arm) -> None:
    X_WG = arm.pose(led.q)
    X_WG[:3, 3] += [0.2, -0.2, 0.0]
    for _ in range(20):
        before = arm.pose(led.q)
        led.lead_hand(X_WG)
        assert translation_distance(before, arm.pose(led.q)) <= 1.05 * SPEED * PERIOD


def test_limits_hold_and_are_told(led, arm) -> None:
    X_WG = arm.pose(led.q)
    X_WG[:3, 3] += [1.5, 0.5, 0.0]
    stuck = False
    for _ in range(800):
        led.lead_hand(X_WG)
        stuck |= led.stuck
        assert (arm.margin(led.q) >= KEEP_OFF - 1e-9).all()
    assert stuck


def test_joints_go_where_they_are_led_as_fast_as_they_may(led, arm) -> None:
    goal = led.q.copy()
    goal[6] = 10.0
    steps = 0
    while led.lead_joints(goal):
        steps += 1
    assert led.q[6] == pytest.approx(arm.upper[6] - KEEP_OFF)
    assert np.allclose(np.delete(led.q, 6), np.delete(goal, 6))
    assert steps * PERIOD > (arm.upper[6] + 0.49) / arm.velocity_limits[6]


@dataclass
class FakeDesk:
    recording: Recording | None

    def teach(self, suggestion: Suggestion, number: int) -> Recording | None:
        return self.recording


def test_the_teacher_says_how_far_off_it_was() -> None:
    X_WO = pose_from_planar(np.array([[0.8, 0.3, 0.0]]), np.zeros(1))
    recording = Recording("demo_01", JOINTS, np.arange(2.0), np.zeros((2, 7)), X_WO)
    place = Suggestion(3, np.array([[0.8, 0.34, 0.0]]))
    arguments = {"number": 0, "used": (), "rng": np.random.default_rng(0)}
    lesson = InteractiveTeacher(FakeDesk(recording)).demonstrate(place, **arguments)
    assert lesson.recording is recording
    assert lesson.remark == "led by hand, 4 cm from the suggestion"
    lesson = InteractiveTeacher(FakeDesk(None)).demonstrate(place, **arguments)
    assert lesson.recording is None
