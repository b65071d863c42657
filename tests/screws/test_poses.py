"""SE(3): group axioms, exponential and logarithm near 0 and near pi, adjoint, distances."""

from __future__ import annotations

import numpy as np
import pytest
import pytransform3d.transformations as pt
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from drake_screw.screws import (
    adjoint,
    exp,
    inverse,
    log,
    normalized,
    pose,
    pose_from_planar,
    quaternion_distance,
    quaternion_from_rotation,
    rotation_angle,
    skew,
    translation_distance,
)
from tests.screws.motions import PI, angles, directions, many, poses, random_poses, seeds, twists

IDENTITY = np.eye(4)


def twist_matrix(V: np.ndarray) -> np.ndarray:
    M = np.zeros((4, 4))
    M[:3, :3], M[:3, 3] = skew(V[:3]), V[3:]
    return M


@many
@given(poses(), poses(), poses())
def test_group_axioms(A: np.ndarray, B: np.ndarray, C: np.ndarray) -> None:
    np.testing.assert_allclose((A @ B) @ C, A @ (B @ C), atol=1e-14)
    np.testing.assert_allclose(A @ inverse(A), IDENTITY, atol=1e-14)
    np.testing.assert_allclose(inverse(A) @ A, IDENTITY, atol=1e-14)
    np.testing.assert_allclose(inverse(A @ B), inverse(B) @ inverse(A), atol=1e-14)


@many
@given(twists())
def test_log_inverts_exp_below_half_a_turn(V: np.ndarray) -> None:
    X = exp(V)
    np.testing.assert_allclose(X[:3, :3] @ X[:3, :3].T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(log(X), V, atol=2e-14)


@many
@given(twists(angles(1e-6)))
def test_log_keeps_relative_precision_of_small_rotations(V: np.ndarray) -> None:
    np.testing.assert_allclose(log(exp(V))[:3], V[:3], rtol=1e-12, atol=1e-30)


@many
@given(twists(st.sampled_from([PI - 1e-9, PI - 1e-12, PI])))
def test_exp_inverts_log_around_half_a_turn(V: np.ndarray) -> None:
    back = log(exp(V))
    assert np.linalg.norm(back[:3]) <= PI + 1e-15
    np.testing.assert_allclose(exp(back), exp(V), atol=1e-14)


@pytest.mark.parametrize("axis", np.eye(3))
@pytest.mark.parametrize("p", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.5)])
def test_exact_half_turns(axis: np.ndarray, p: tuple[float, ...]) -> None:
    X = pose(2.0 * np.outer(axis, axis) - np.eye(3), p)
    V = log(X)
    assert np.linalg.norm(V[:3]) == pytest.approx(PI, abs=1e-15)
    np.testing.assert_allclose(exp(V), X, atol=1e-15)


@many
@given(directions(), st.floats(0.0, 100.0))
def test_pure_translations_are_exact(l: np.ndarray, length: float) -> None:
    V = np.concatenate([np.zeros(3), length * l])
    np.testing.assert_array_equal(exp(V), pose(np.eye(3), length * l))
    np.testing.assert_array_equal(log(exp(V)), V)


@many
@given(twists(), twists())
def test_exp_is_the_matrix_exponential(V: np.ndarray, X: np.ndarray) -> None:
    np.testing.assert_allclose(exp(V), expm(twist_matrix(V)), atol=1e-13)
    np.testing.assert_allclose(
        exp(3.0 * V), exp(V) @ exp(V) @ exp(V), atol=1e-13, err_msg="more than half a turn"
    )


@many
@given(twists(st.floats(1e-3, PI - 1e-3)))
def test_exponential_coordinates_agree_with_pytransform3d(V: np.ndarray) -> None:
    np.testing.assert_allclose(exp(V), pt.transform_from_exponential_coordinates(V), atol=1e-12)
    np.testing.assert_allclose(
        log(exp(V)), pt.exponential_coordinates_from_transform(exp(V)), atol=1e-10
    )


@many
@given(poses(), poses(), twists())
def test_adjoint_identities(A: np.ndarray, B: np.ndarray, V: np.ndarray) -> None:
    np.testing.assert_allclose(adjoint(A @ B), adjoint(A) @ adjoint(B), atol=1e-13)
    np.testing.assert_allclose(adjoint(inverse(A)), np.linalg.inv(adjoint(A)), atol=1e-13)
    np.testing.assert_allclose(exp(adjoint(A) @ V), A @ exp(V) @ inverse(A), atol=1e-13)
    np.testing.assert_allclose(adjoint(A), pt.adjoint_from_transform(A), atol=1e-13)
    bracket = A @ twist_matrix(V) @ inverse(A)
    np.testing.assert_allclose(twist_matrix(adjoint(A) @ V), bracket, atol=1e-13)


@many
@given(poses(), directions(), angles(PI))
def test_distances_measure_a_known_displacement(A: np.ndarray, l: np.ndarray, angle: float) -> None:
    B = A @ exp([*(angle * l), 0.0, 0.0, 0.0])
    B[:3, 3] += 0.25 * l
    assert rotation_angle(A, B) == pytest.approx(angle, abs=1e-14)
    assert translation_distance(A, B) == pytest.approx(0.25)
    a, b = quaternion_from_rotation(A[:3, :3]), quaternion_from_rotation(B[:3, :3])
    chord = min(np.linalg.norm(a - b), np.linalg.norm(a + b))
    assert quaternion_distance(A, B) == pytest.approx(chord, abs=1e-14)
    assert quaternion_distance(A, B) == pytest.approx(2.0 * np.sin(angle / 4.0), abs=1e-14)


@many
@given(poses(), poses(), poses())
def test_distances_do_not_depend_on_the_frame(X: np.ndarray, A: np.ndarray, B: np.ndarray) -> None:
    for distance in (rotation_angle, quaternion_distance, translation_distance):
        assert distance(X @ A, X @ B) == pytest.approx(float(distance(A, B)), abs=1e-13)
        assert distance(A, B) == pytest.approx(float(distance(B, A)), abs=1e-13)
        assert distance(A, A) == pytest.approx(0.0, abs=1e-14)


@many
@given(seeds)
def test_normalized_repairs_small_errors_and_keeps_poses(seed: int) -> None:
    rng = np.random.default_rng(seed)
    X = random_poses(rng)
    np.testing.assert_allclose(normalized(X), X, atol=1e-14)
    noisy = X + np.pad(rng.uniform(-1e-4, 1e-4, (3, 3)), (0, 1))
    repaired = normalized(noisy)
    np.testing.assert_allclose(repaired[:3, :3].T @ repaired[:3, :3], np.eye(3), atol=1e-14)
    np.testing.assert_allclose(repaired, X, atol=5e-4)
    np.testing.assert_array_equal(repaired[:3, 3], X[:3, 3])


def test_planar_pose_turns_about_z_then_moves() -> None:
    X = pose_from_planar([[0.8, -0.2, PI / 2], [0.0, 0.0, 0.0]], [0.1, 0.2])
    np.testing.assert_allclose(X[0] @ [1.0, 0.0, 0.0, 1.0], [0.8, 0.8, 0.1, 1.0], atol=1e-15)
    np.testing.assert_array_equal(X[1], pose(np.eye(3), [0.0, 0.0, 0.2]))
    yaw = pose_from_planar([0.0, 0.0, 0.7])
    np.testing.assert_allclose(yaw, exp([0.0, 0.0, 0.7, 0.0, 0.0, 0.0]), atol=1e-15)


@pytest.mark.parametrize("shape", [(), (3,), (2, 3), (0,)])
def test_leading_axes_are_carried(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(6)
    A, B = random_poses(rng, shape), random_poses(rng, shape)
    assert A.shape == (*shape, 4, 4)
    expected = {
        inverse: (4, 4),
        log: (6,),
        adjoint: (6, 6),
        normalized: (4, 4),
    }
    for function, tail in expected.items():
        result = function(A)
        assert result.shape == (*shape, *tail)
        for index in np.ndindex(shape):
            np.testing.assert_allclose(result[index], function(A[index]), atol=1e-14)
    for distance in (translation_distance, rotation_angle, quaternion_distance):
        result = distance(A, B)
        assert result.shape == shape
        assert distance(A, IDENTITY).shape == shape
        for index in np.ndindex(shape):
            assert result[index] == pytest.approx(float(distance(A[index], B[index])))
    assert pose(A[..., :3, :3], [1.0, 2.0, 3.0]).shape == (*shape, 4, 4)
    assert pose_from_planar(rng.normal(size=(*shape, 3)), 0.5).shape == (*shape, 4, 4)
