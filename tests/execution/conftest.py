"""Baxter, and a short plan of two segments for its left arm: 8 cm along, then a turn."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_screw.execution import TimedPlan, TimeLimits, time_plan
from drake_screw.planning import Plan, ReferencePlanner
from drake_screw.robot import Arm, RobotConfig
from drake_screw.robot.parts import add_robot
from drake_screw.screws import exp, pose

START = (1.0434904, -0.2201262, -0.7470486, 1.5243934, 1.8818109, -0.9687089, -0.4908739)
JOINTS = ("s0", "s1", "e0", "e1", "w0", "w1", "w2")


@pytest.fixture(scope="session")
def robot() -> RobotConfig:
    return RobotConfig(
        "baxter",
        tuple(f"left_{joint}" for joint in JOINTS),
        "left_hand",
        START,
        parked={"right_s0": -0.767, "right_e1": 1.575},
    )


@pytest.fixture(scope="session")
def arm(robot) -> Arm:
    plant = MultibodyPlant(0.0)
    add_robot(Parser(plant), robot)
    plant.Finalize()
    return Arm(plant, robot.joints, robot.end_effector, parked=robot.parked)


@pytest.fixture(scope="session")
def guides(arm) -> np.ndarray:
    """(2, 4, 4) guiding poses."""
    X_WS = arm.pose(START)
    X_WA = X_WS.copy()
    X_WA[:3, 3] += [0.05, -0.06, -0.02]
    turn = exp(np.array([0.1, -0.2, 0.3, 0.0, 0.0, 0.0]))
    X_WB = X_WA @ pose(turn[:3, :3], [0.0, 0.02, 0.0])
    return np.stack([X_WA, X_WB])


@pytest.fixture(scope="session")
def plan(arm, guides) -> Plan:
    plan = ReferencePlanner(arm, step=0.02).plan(START, guides)
    assert plan.success
    return plan


@pytest.fixture(scope="session")
def timed(arm, plan, guides) -> TimedPlan:
    return timed_plan(arm, plan, guides)


def timed_plan(arm: Arm, plan: Plan, guides: np.ndarray, limits: TimeLimits | None = None):
    return time_plan(plan, np.concatenate([arm.pose(plan.q[:1]), guides]), arm, limits)


@pytest.fixture(scope="session")
def time_it(arm, plan, guides) -> Callable[[TimeLimits], TimedPlan]:
    """Times the short plan within other limits."""
    return lambda limits: timed_plan(arm, plan, guides, limits)
