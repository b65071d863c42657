"""The dual quaternion path and the matrix path are one."""

from __future__ import annotations

import numpy as np
import pytest
import pytransform3d.transformations as pt
from hypothesis import given
from hypothesis import strategies as st

from drake_screw.screws import (
    dual_quaternion_conjugate,
    dual_quaternion_from_pose,
    dual_quaternion_from_screw,
    dual_quaternion_multiply,
    dual_quaternion_power,
    exp,
    inverse,
    pose_from_dual_quaternion,
    sclerp,
    screw_from_twist,
)
from tests.screws.motions import PI, many, parts, poses, random_poses, twists


@many
@given(poses())
def test_pose_round_trip_and_unit_length(X: np.ndarray) -> None:
    Q = dual_quaternion_from_pose(X)
    assert Q[0] >= 0.0
    assert Q[:4] @ Q[:4] == pytest.approx(1.0)
    assert Q[:4] @ Q[4:] == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose(pose_from_dual_quaternion(Q), X, atol=1e-14)
    np.testing.assert_allclose(pose_from_dual_quaternion(-Q), X, atol=1e-14)


@many
@given(poses(), poses())
def test_product_composes_and_conjugate_inverts(A: np.ndarray, B: np.ndarray) -> None:
    a, b = dual_quaternion_from_pose(A), dual_quaternion_from_pose(B)
    np.testing.assert_allclose(
        pose_from_dual_quaternion(dual_quaternion_multiply(a, b)), A @ B, atol=1e-14
    )
    np.testing.assert_allclose(
        pose_from_dual_quaternion(dual_quaternion_conjugate(a)), inverse(A), atol=1e-14
    )
    np.testing.assert_allclose(
        dual_quaternion_multiply(a, b), pt.concatenate_dual_quaternions(a, b), atol=1e-12
    )


@many
@given(poses(), twists(), parts)
def test_power_interpolates_as_sclerp_does(A: np.ndarray, V: np.ndarray, s: float) -> None:
    B = exp(V) @ A
    a, b = dual_quaternion_from_pose(A), dual_quaternion_from_pose(B)
    for sign in (1.0, -1.0):
        step = dual_quaternion_power(
            dual_quaternion_multiply(dual_quaternion_conjugate(a), sign * b), s
        )
        between = pose_from_dual_quaternion(dual_quaternion_multiply(a, step))
        np.testing.assert_allclose(between, sclerp(A, B, s), atol=1e-11)


@many
@given(twists())
def test_screw_gives_the_dual_quaternion_of_its_displacement(V: np.ndarray) -> None:
    Q = dual_quaternion_from_screw(screw_from_twist(V))
    np.testing.assert_allclose(Q, dual_quaternion_from_pose(exp(V)), atol=1e-11)


@many
@given(poses(), twists(st.floats(1e-3, PI - 1e-3)), parts)
def test_power_and_sclerp_agree_with_pytransform3d(A: np.ndarray, V: np.ndarray, s: float) -> None:
    Q = dual_quaternion_from_pose(exp(V))
    np.testing.assert_allclose(
        dual_quaternion_power(Q, s), pt.dual_quaternion_power(Q, s), atol=1e-9
    )
    a = dual_quaternion_from_pose(A)
    b = dual_quaternion_multiply(a, Q)
    ours = dual_quaternion_multiply(a, dual_quaternion_power(Q, s))
    theirs = pt.transform_from_dual_quaternion(pt.dual_quaternion_sclerp(a, b, s))
    np.testing.assert_allclose(pose_from_dual_quaternion(ours), theirs, atol=1e-9)
    pt.assert_unit_dual_quaternion_equal(pt.dual_quaternion_from_transform(exp(V)), Q)


@pytest.mark.parametrize("shape", [(), (3,), (2, 3), (0,)])
def test_leading_axes_are_carried(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(10)
    A, s = random_poses(rng, shape), rng.random(shape)
    Q = dual_quaternion_from_pose(A)
    power = dual_quaternion_power(Q, s)
    assert Q.shape == power.shape == dual_quaternion_multiply(Q, Q).shape == (*shape, 8)
    assert dual_quaternion_conjugate(Q).shape == (*shape, 8)
    assert pose_from_dual_quaternion(Q).shape == (*shape, 4, 4)
    assert dual_quaternion_power(Q, 0.5).shape == (*shape, 8)
    for index in np.ndindex(shape):
        np.testing.assert_allclose(
            power[index], dual_quaternion_power(Q[index], s[index]), atol=1e-14
        )
