"""Constant screws: ScLERP, Chasles' parameters, nearest points."""

from __future__ import annotations

import numpy as np
import pytest
import pytransform3d.transformations as pt
from hypothesis import given
from hypothesis import strategies as st

from drake_screw.screws import (
    Screw,
    exp,
    inverse,
    log,
    nearest_on_screw,
    pose,
    sclerp,
    sclerp_position,
    screw_between,
    screw_from_twist,
)
from tests.screws.motions import (
    PI,
    angles,
    directions,
    many,
    parts,
    poses,
    random_poses,
    seeds,
    some,
    twists,
)


@many
@given(poses(), poses())
def test_sclerp_ends_on_the_poses(A: np.ndarray, B: np.ndarray) -> None:
    np.testing.assert_allclose(sclerp(A, B, 0.0), A, atol=1e-15)
    np.testing.assert_allclose(sclerp(A, B, 1.0), B, atol=1e-14)


def test_each_translation_of_a_batch_keeps_its_own_length() -> None:
    V = np.array([[0.0, 0.0, 0.0, 0.3, 0.0, 0.4], [0.0, 0.0, 0.0, 0.0, 2.0, 0.0]])
    screw = screw_from_twist(V)
    np.testing.assert_allclose(screw.axis, [[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]], atol=1e-15)
    np.testing.assert_allclose(screw.translation, [0.5, 2.0], atol=1e-15)
    np.testing.assert_array_equal(screw.angle, 0.0)
    np.testing.assert_allclose(screw.twist, V, atol=1e-15)


@many
@given(poses(), twists(), parts, parts)
def test_twist_is_constant_along_sclerp(A: np.ndarray, V: np.ndarray, s1: float, s2: float) -> None:
    B = exp(V) @ A
    step = sclerp(A, B, s2) @ inverse(sclerp(A, B, s1))
    np.testing.assert_allclose(log(step), (s2 - s1) * V, atol=1e-13)


@many
@given(poses(), poses(), twists(), parts)
def test_sclerp_does_not_depend_on_the_frame(
    X: np.ndarray, A: np.ndarray, V: np.ndarray, s: float
) -> None:
    B = exp(V) @ A
    between = sclerp(A, B, s)
    np.testing.assert_allclose(sclerp(X @ A, X @ B, s), X @ between, atol=3e-14)
    np.testing.assert_allclose(sclerp(A @ X, B @ X, s), between @ X, atol=3e-14)


@many
@given(poses(), twists(), parts)
def test_sclerp_backwards_is_the_same_motion(A: np.ndarray, V: np.ndarray, s: float) -> None:
    B = exp(V) @ A
    np.testing.assert_allclose(sclerp(B, A, 1.0 - s), sclerp(A, B, s), atol=1e-13)


@many
@given(poses(), twists(st.floats(1e-3, PI - 1e-3)), parts)
def test_sclerp_agrees_with_pytransform3d(A: np.ndarray, V: np.ndarray, s: float) -> None:
    B = exp(V) @ A
    np.testing.assert_allclose(sclerp(A, B, s), pt.transform_sclerp(A, B, s), atol=1e-9)


@many
@given(poses(), twists(), parts)
def test_sclerp_position_is_that_of_sclerp(A: np.ndarray, V: np.ndarray, s: float) -> None:
    """Up to a picometre: a turn of 1e-12 rad counts as none."""
    B = exp(V) @ A
    np.testing.assert_allclose(sclerp_position(A, B, s), sclerp(A, B, s)[:3, 3], atol=1e-12)


@many
@given(twists())
def test_screw_gives_back_its_twist(V: np.ndarray) -> None:
    screw = screw_from_twist(V)
    assert np.linalg.norm(screw.axis) == pytest.approx(1.0)
    assert 0.0 <= screw.angle <= PI
    far = np.linalg.norm(V[3:]) / max(float(screw.angle), 1e-12)
    assert abs(screw.point @ screw.axis) <= 1e-15 * (1.0 + 4.0 * far)
    np.testing.assert_allclose(screw.twist, V, atol=2e-12)


@many
@given(directions(), angles(PI), st.floats(-1.0, 1.0), directions(), st.floats(0.0, 2.0))
def test_parameters_of_a_known_screw_are_recovered(
    l: np.ndarray, angle: float, translation: float, away: np.ndarray, distance: float
) -> None:
    if angle < 1e-6:
        angle = 0.5
    point = distance * np.cross(l, away)
    given_screw = Screw(l, point, np.array(angle), np.array(translation))
    found = screw_from_twist(given_screw.twist)
    np.testing.assert_allclose(found.axis, l, atol=1e-9)
    np.testing.assert_allclose(found.point, point, atol=1e-8)
    assert found.angle == pytest.approx(angle)
    assert found.translation == pytest.approx(translation, abs=1e-9)
    assert found.pitch == pytest.approx(translation / angle, abs=1e-3)
    np.testing.assert_allclose(found.moment, np.cross(point, l), atol=1e-8)


@many
@given(twists(st.floats(1e-3, PI - 1e-3)))
def test_screw_parameters_agree_with_pytransform3d(V: np.ndarray) -> None:
    screw, angle = screw_from_twist(V), np.linalg.norm(V[:3])
    point, axis, pitch = pt.screw_parameters_from_screw_axis(V / angle)
    np.testing.assert_allclose(screw.point, point, atol=1e-9)
    np.testing.assert_allclose(screw.axis, axis, atol=1e-12)
    assert screw.pitch == pytest.approx(pitch, abs=1e-9)
    assert screw.angle == pytest.approx(angle)


def test_pure_translation_and_identity_have_screws() -> None:
    screw = screw_between(np.eye(4), pose(np.eye(3), [0.0, -0.4, 0.3]))
    np.testing.assert_allclose(screw.axis, [0.0, -0.8, 0.6])
    assert screw.translation == pytest.approx(0.5)
    assert screw.angle == 0.0
    assert np.isinf(screw.pitch)
    np.testing.assert_array_equal(screw.point, 0.0)
    still = screw_between(np.eye(4), np.eye(4))
    assert still.translation == 0.0
    np.testing.assert_array_equal(still.twist, 0.0)
    np.testing.assert_allclose(np.linalg.norm(still.axis), 1.0)


@many
@given(poses(), twists())
def test_screw_between_leads_from_one_pose_to_the_other(A: np.ndarray, V: np.ndarray) -> None:
    B = exp(V) @ A
    np.testing.assert_allclose(exp(screw_between(A, B).twist) @ A, B, atol=1e-11)


def distance_along(A: np.ndarray, B: np.ndarray, p: np.ndarray, s: np.ndarray) -> np.ndarray:
    return np.linalg.norm(sclerp(A, B, s)[..., :3, 3] - p, axis=-1)


@some
@given(poses(), twists(), seeds)
def test_nearest_on_screw_beats_brute_force(A: np.ndarray, V: np.ndarray, seed: int) -> None:
    B = exp(V) @ A
    rng = np.random.default_rng(seed)
    points = A[:3, 3] + rng.uniform(-1.0, 1.0, (20, 3)) * rng.choice([0.05, 0.5, 2.0], (20, 1))
    s = nearest_on_screw(A, B, points)
    assert ((s >= 0.0) & (s <= 1.0)).all()
    searched = distance_along(A, B, points[:, None], np.linspace(0.0, 1.0, 2001)).min(axis=1)
    assert (distance_along(A, B, points, s) <= searched + 1e-9).all()


@some
@given(poses(), twists(), st.lists(parts, min_size=1, max_size=9))
def test_nearest_on_screw_finds_points_of_the_screw(
    A: np.ndarray, V: np.ndarray, parameters: list[float]
) -> None:
    s = np.array(parameters)
    B = exp(V) @ A
    found = nearest_on_screw(A, B, sclerp(A, B, s)[:, :3, 3])
    np.testing.assert_allclose(sclerp(A, B, found)[:, :3, 3], sclerp(A, B, s)[:, :3, 3], atol=1e-8)
    if np.linalg.norm(sclerp_position(A, B, 1e-3) - A[:3, 3]) > 1e-5:
        np.testing.assert_allclose(found, s, atol=1e-7)


@pytest.mark.parametrize("angle", [0.0, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5])
def test_nearest_on_screw_of_an_almost_pure_translation(angle: float) -> None:
    A = random_poses(np.random.default_rng(7))
    B = A @ exp([0.0, angle, 0.0, 0.0, 0.0, 0.0])
    B[:3, 3] += [0.3, 0.1, -0.2]
    s = np.linspace(0.0, 1.0, 14)
    points = A[:3, 3] + s[:, None] * [0.3, 0.1, -0.2]
    np.testing.assert_allclose(nearest_on_screw(A, B, points), s, atol=2.0 * angle + 1e-12)


def test_nearest_on_screw_stays_within_its_ends() -> None:
    A, B = np.eye(4), pose(np.eye(3), [1.0, 0.0, 0.0])
    points = [[-5.0, 1.0, 0.0], [9.0, 0.0, 2.0], [0.25, 3.0, 0.0]]
    np.testing.assert_allclose(nearest_on_screw(A, B, points), [0.0, 1.0, 0.25])
    assert np.isfinite(nearest_on_screw(A, A, points)).all()


@pytest.mark.parametrize("shape", [(), (3,), (2, 3), (0,)])
def test_leading_axes_are_carried(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(8)
    A, B = random_poses(rng, shape), random_poses(rng, shape)
    s, p = rng.random(shape), rng.normal(size=(*shape, 3))
    screw = screw_between(A, B)
    assert screw.axis.shape == screw.point.shape == screw.moment.shape == (*shape, 3)
    assert screw.angle.shape == screw.pitch.shape == screw.translation.shape == shape
    results = sclerp(A, B, s), sclerp_position(A, B, s), nearest_on_screw(A, B, p)
    assert [r.shape for r in results] == [(*shape, 4, 4), (*shape, 3), shape]
    for index in np.ndindex(shape):
        np.testing.assert_allclose(results[0][index], sclerp(A[index], B[index], s[index]))
        np.testing.assert_allclose(
            results[1][index], sclerp_position(A[index], B[index], s[index]), atol=1e-14
        )
        np.testing.assert_allclose(
            results[2][index], nearest_on_screw(A[index], B[index], p[index]), atol=1e-9
        )


def test_parameters_broadcast_against_poses() -> None:
    rng = np.random.default_rng(9)
    A, B = random_poses(rng, (4, 1)), random_poses(rng, (4, 1))
    s, points = rng.random(5), rng.normal(size=(5, 3))
    assert sclerp(A, B, s).shape == (4, 5, 4, 4)
    assert sclerp(A[0, 0], B[0, 0], s).shape == (5, 4, 4)
    assert sclerp_position(A, B, s).shape == (4, 5, 3)
    found = nearest_on_screw(A, B, points)
    assert found.shape == (4, 5)
    np.testing.assert_allclose(found[2], nearest_on_screw(A[2, 0], B[2, 0], points), atol=1e-9)
    one_start = nearest_on_screw(A[0, 0], B, points)
    np.testing.assert_allclose(one_start[3], nearest_on_screw(A[0, 0], B[3, 0], points), atol=1e-9)
