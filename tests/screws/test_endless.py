"""Joints without limits: they turn on and on, and full turns do not matter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drake_screw.errors import ModelError
from drake_screw.screws.endless import (
    brought_near,
    drawn_range,
    is_endless,
    middles,
    unwrapped,
    within_a_turn,
)
from tests.robot.small_arms import PLANAR, SLIDING, arm_of

LOWER, UPPER = np.array([-np.inf, -1.0, 0.0]), np.array([np.inf, 2.0, 0.5])


def test_which_they_are_and_what_stands_for_their_limits() -> None:
    np.testing.assert_array_equal(is_endless(LOWER, UPPER), [True, False, False])
    lower, upper = within_a_turn(LOWER, UPPER)
    np.testing.assert_allclose(lower, [-np.pi, -1.0, 0.0])
    np.testing.assert_allclose(upper, [np.pi, 2.0, 0.5])
    np.testing.assert_allclose(middles(LOWER, UPPER), [0.0, 0.5, 0.25])


def test_an_arm_takes_them_and_leaves_them_out_of_its_margins() -> None:
    arm = arm_of((replace(PLANAR[0], limits=None), *PLANAR[1:]))
    np.testing.assert_array_equal(arm.endless, [True, False, False])
    np.testing.assert_array_equal(arm.middle, 0.0)
    np.testing.assert_array_equal(arm.margin([50.0, 1.0, -2.6]), [np.inf, 1.5, pytest.approx(-0.1)])
    np.testing.assert_allclose(arm.pose([0.3, 0.2, 0.1]), arm.pose([0.3 + 6 * np.pi, 0.2, 0.1]))
    chain = arm.screw_chain()
    assert (np.isneginf(chain.lower[0]), np.isposinf(chain.upper[0])) == (True, True)
    assert np.isfinite([chain.reach, *chain.shoulder]).all()


def test_a_prismatic_joint_needs_limits() -> None:
    with pytest.raises(ModelError, match="joint 'rail' has no position limits"):
        arm_of((replace(SLIDING[0], limits=None), *SLIDING[1:]))


def test_brought_near_is_the_same_pose_within_half_a_turn() -> None:
    endless = np.array([True, False, True])
    q = np.array([[7.0, 7.0, -20.0], [0.1, 0.2, 0.3]])
    near = brought_near(q, [1.0, 0.0, 2.0], endless)
    assert (np.abs(near - [1.0, 0.0, 2.0])[:, [0, 2]] <= np.pi).all()
    np.testing.assert_array_equal(near[:, 1], q[:, 1])
    np.testing.assert_allclose(np.cos(near), np.cos(q), atol=1e-12)
    np.testing.assert_allclose(np.sin(near), np.sin(q), atol=1e-12)


def test_jumps_by_full_turns_are_taken_out_of_a_path() -> None:
    t = np.linspace(0.0, 1.0, 200)
    smooth = np.column_stack([1.0 + 9.0 * t, 1.0 + 9.0 * t])
    jumping = (smooth + np.pi) % (2.0 * np.pi) - np.pi
    found = unwrapped(jumping, np.array([True, False]))
    np.testing.assert_allclose(found[:, 0], smooth[:, 0], atol=1e-12)
    np.testing.assert_array_equal(found[:, 1], jumping[:, 1])
    np.testing.assert_allclose(unwrapped(smooth + 8 * np.pi, np.ones(2, bool)), smooth, atol=1e-12)


def test_ranges_to_draw_them_in() -> None:
    q = np.array([[0.0, 0.0, 0.1], [1.0, 1.0, 0.2]])
    lower, upper = drawn_range(LOWER, UPPER, q)
    np.testing.assert_allclose(lower, [0.5 - np.pi, -1.0, 0.0])
    np.testing.assert_allclose(upper, [0.5 + np.pi, 2.0, 0.5])
    lower, upper = drawn_range(LOWER, UPPER, np.array([[0.0, 0, 0], [10.0, 0, 0]]))
    assert (lower[0], upper[0]) == (0.0, 10.0)
