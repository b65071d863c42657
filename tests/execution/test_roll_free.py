"""A plan that leaves the roll about an axis of the hand free is executed, and measured likewise."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.execution import TimedPlan, build_station, simulate
from drake_screw.planning import ReferencePlanner
from drake_screw.planning.roll import turned_apart
from drake_screw.robot import Arm, RobotConfig
from drake_screw.screws import exp
from tests.execution.conftest import START, timed_plan

X, Z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


@pytest.fixture(scope="module", params=[X, Z])
def axis(request) -> tuple[float, float, float]:
    return request.param


@pytest.fixture(scope="module")
def timed(arm: Arm, guides: np.ndarray, axis) -> TimedPlan:
    """The short plan, with a roll of half a radian more at its end that need not be followed."""
    more = np.concatenate([0.5 * np.array(axis), np.zeros(3)])
    guides = np.stack([guides[0], guides[1] @ exp(more)])
    plan = ReferencePlanner(arm, step=0.02, free_axis=axis).plan(START, guides)
    assert plan.success
    return timed_plan(arm, plan, guides)


def test_it_is_executed_and_measured_in_position_and_axis(
    robot: RobotConfig, arm: Arm, timed: TimedPlan, axis
) -> None:
    np.testing.assert_array_equal(timed.free_axis, axis)
    done = simulate(build_station(robot), timed, np.empty((0, 4, 4)))
    report = done.report
    assert report.flawless, str(report.status)
    assert max(s.position for s in report.screws) < 1e-3
    assert max(s.rotation for s in report.screws) < 3e-3
    assert report.final.rotation < 2e-3
    ended, planned = arm.pose(done.q[-1]), arm.pose(timed.segments[-1].q[-1])
    assert turned_apart(ended, timed.segments[-1].X_WB, None) > 0.1  # its roll is not followed
    assert turned_apart(ended, planned, None) < 5e-3  # but is that of the planned joint path
