"""Velocity limits that a model does not state."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.errors import ModelError
from drake_screw.robot import Arm
from tests.robot.six_joints import NAMES, urdf
from tests.robot.small_arms import SLIDING, arm_of, plant_of

LACKING = {"j2": 'velocity="0" effort="100"', "j5": 'effort="100"'}


def arm(**kwargs: object) -> Arm:
    return Arm(plant_of(urdf(limits=LACKING), suffix=".urdf"), NAMES, "hand", **kwargs)


def test_what_is_stated_holds_and_what_is_not_is_said_once() -> None:
    found = arm()
    np.testing.assert_array_equal(found.velocity_limits, [2.0, 1.0, 2.0, 2.0, 1.0, 2.0])
    assert found.assumed_velocities == ("j2", "j5")
    (line,) = found.assumptions
    assert "1 rad/s for j2, j5 taken" in line
    assert "robot.velocity_limits" in line


def test_joints_that_slide_have_a_default_of_their_own() -> None:
    found = arm_of(SLIDING)
    np.testing.assert_array_equal(found.velocity_limits, [0.25, 1.0, 1.0, 0.25, 1.0])
    (line,) = found.assumptions
    assert "1 rad/s for turn, tilt, roll and 0.25 m/s for rail, reach taken" in line


def test_limits_can_be_given_instead() -> None:
    found = arm(velocity_limits={"j2": 1.5, "j5": 2.5, "j1": 0.5})
    np.testing.assert_array_equal(found.velocity_limits, [0.5, 1.5, 2.0, 2.0, 2.5, 2.0])
    assert found.assumptions == ()


def test_a_limit_of_no_joint_is_refused() -> None:
    with pytest.raises(ModelError, match="'j22' is no joint") as caught:
        arm(velocity_limits={"j22": 1.5})
    assert "Did you mean 'j2'?" in str(caught.value)
