"""Joints without limits: they turn on and on, and full turns do not matter."""

from __future__ import annotations

import numpy as np

from drake_screw.screws.endless import (
    brought_near,
    drawn_range,
    is_endless,
    middles,
    unwrapped,
    within_a_turn,
)

LOWER, UPPER = np.array([-np.inf, -1.0, 0.0]), np.array([np.inf, 2.0, 0.5])


def test_which_they_are_and_what_stands_for_their_limits() -> None:
    np.testing.assert_array_equal(is_endless(LOWER, UPPER), [True, False, False])
    lower, upper = within_a_turn(LOWER, UPPER)
    np.testing.assert_allclose(lower, [-np.pi, -1.0, 0.0])
    np.testing.assert_allclose(upper, [np.pi, 2.0, 0.5])
    np.testing.assert_allclose(middles(LOWER, UPPER), [0.0, 0.5, 0.25])


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
