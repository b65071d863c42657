"""Quaternions and matrices of one rotation say the same, at every angle."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from drake_screw.screws import (
    quaternion_conjugate,
    quaternion_from_rotation,
    quaternion_from_rotation_vector,
    quaternion_multiply,
    rotation_from_quaternion,
    rotation_vector_from_quaternion,
    skew,
)
from drake_screw.screws.rotations import cross
from tests.screws.motions import PI, angles, directions, many, random_poses


@many
@given(directions(), angles(PI))
def test_rotation_vector_is_recovered_through_the_quaternion(l: np.ndarray, angle: float) -> None:
    q = quaternion_from_rotation_vector(angle * l)
    np.testing.assert_allclose(np.linalg.norm(q), 1.0, atol=1e-15)
    w = rotation_vector_from_quaternion(q)
    if angle == PI and w @ l < 0.0:
        w = -w
    np.testing.assert_allclose(w, angle * l, rtol=1e-14, atol=1e-15)


@many
@given(directions(), angles(PI))
def test_rotation_vector_is_recovered_through_the_matrix(l: np.ndarray, angle: float) -> None:
    R = rotation_from_quaternion(quaternion_from_rotation_vector(angle * l))
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(R) == pytest.approx(1.0)
    np.testing.assert_allclose(R @ l, l, atol=1e-15)
    w = rotation_vector_from_quaternion(quaternion_from_rotation(R))
    if angle > PI - 1e-12 and w @ l < 0.0:
        w = -w
    np.testing.assert_allclose(w, angle * l, atol=3e-15)


@pytest.mark.parametrize("turned", [(0, [1, 0, 0]), (1, [0, 1, 0]), (2, [0, 0, 1])])
def test_half_turns_about_the_axes_are_exact(turned: tuple[int, list[float]]) -> None:
    i, axis = turned
    R = -np.eye(3)
    R[i, i] = 1.0
    np.testing.assert_array_equal(quaternion_from_rotation(R), [0.0, *axis])


def test_quaternion_of_a_rotation_has_nonnegative_w() -> None:
    R = random_poses(np.random.default_rng(1), (500,))[:, :3, :3]
    q = quaternion_from_rotation(R)
    assert (q[:, 0] >= 0.0).all()
    np.testing.assert_allclose(rotation_from_quaternion(q), R, atol=1e-14)
    np.testing.assert_allclose(rotation_from_quaternion(-3.0 * q), R, atol=1e-14)


def test_both_signs_of_a_quaternion_have_one_rotation_vector() -> None:
    q = np.random.default_rng(2).normal(size=(50, 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    w = rotation_vector_from_quaternion(q)
    np.testing.assert_allclose(rotation_vector_from_quaternion(-q), w, atol=1e-15)
    assert (np.linalg.norm(w, axis=1) <= PI + 1e-12).all()


def test_product_composes_and_conjugate_inverts() -> None:
    R = random_poses(np.random.default_rng(3), (2, 20))[..., :3, :3]
    a, b = quaternion_from_rotation(R)
    np.testing.assert_allclose(
        rotation_from_quaternion(quaternion_multiply(a, b)), R[0] @ R[1], atol=1e-14
    )
    identity = np.tile([1.0, 0.0, 0.0, 0.0], (20, 1))
    np.testing.assert_allclose(
        quaternion_multiply(a, quaternion_conjugate(a)), identity, atol=1e-15
    )


@pytest.mark.parametrize("shape", [(), (3,), (2, 3), (0,)])
def test_cross_products_agree(shape: tuple[int, ...]) -> None:
    a, b = np.random.default_rng(4).normal(size=(2, *shape, 3))
    np.testing.assert_allclose(cross(a, b), np.cross(a, b), atol=1e-15)
    np.testing.assert_allclose((skew(a) @ b[..., None])[..., 0], np.cross(a, b), atol=1e-15)
    np.testing.assert_allclose(cross([1.0, 2.0, 3.0], b), np.cross([1.0, 2.0, 3.0], b), atol=1e-15)


@pytest.mark.parametrize("shape", [(), (3,), (2, 3)])
def test_leading_axes_are_carried(shape: tuple[int, ...]) -> None:
    R = random_poses(np.random.default_rng(5), shape)[..., :3, :3]
    q = quaternion_from_rotation(R)
    w = rotation_vector_from_quaternion(q)
    assert q.shape == (*shape, 4)
    assert w.shape == (*shape, 3)
    assert rotation_from_quaternion(q).shape == (*shape, 3, 3)
    assert quaternion_from_rotation_vector(w).shape == (*shape, 4)
    for index in np.ndindex(shape):
        np.testing.assert_allclose(q[index], quaternion_from_rotation(R[index]), atol=1e-15)
