"""Object poses of task instances, and back."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_screw.screws import exp, pose
from drake_screw.tasks import ObjectArea, WorkArea

PI = np.pi
BOWL = ObjectArea("bowl", (0.7, -0.2, -0.5), (1.1, 0.8, 1.5), -0.06)
CUP = ObjectArea("cup", (0.5, 0.1, 0.0), (0.5, 0.4, 0.0), 0.02)
ROUND = ObjectArea("round", (0.0, 0.0, 0.0), (1.0, 1.0, 1.99 * PI), 0.0)
AREAS = [WorkArea((BOWL,)), WorkArea((BOWL, CUP)), WorkArea((CUP, BOWL, ROUND))]


@settings(deadline=None)
@given(st.sampled_from(AREAS), st.integers(0, 2**32 - 1))
def test_coordinates_are_recovered_from_the_poses(area: WorkArea, seed: int) -> None:
    rng = np.random.default_rng(seed)
    coordinates = rng.uniform(area.lower, area.upper, (5, len(area.objects), 3))
    np.testing.assert_allclose(area.coordinates(area.X_WO(coordinates)), coordinates, atol=1e-14)
    assert area.contains(area.coordinates(area.X_WO(coordinates))).all()


def test_pose_of_an_instance() -> None:
    area = WorkArea((BOWL, CUP))
    bowl, cup = area.X_WO([[0.8, 0.1, PI / 2], [0.5, 0.3, 0.0]])
    np.testing.assert_allclose(bowl[:3, 3], [0.8, 0.1, -0.06])
    turned = exp([0.0, 0.0, PI / 2, 0.0, 0.0, 0.0])[:3, :3]
    np.testing.assert_allclose(bowl[:3, :3], turned, atol=1e-15)
    np.testing.assert_array_equal(cup, pose(np.eye(3), [0.5, 0.3, 0.02]))


def test_bounds_by_object() -> None:
    area = WorkArea((BOWL, CUP))
    np.testing.assert_array_equal(area.lower, [[0.7, -0.2, -0.5], [0.5, 0.1, 0.0]])
    np.testing.assert_array_equal(area.upper, [[1.1, 0.8, 1.5], [0.5, 0.4, 0.0]])
    np.testing.assert_array_equal(area.z, [-0.06, 0.02])


def test_contains_all_objects_and_borders() -> None:
    area = WorkArea((BOWL, CUP))
    middle = (area.lower + area.upper) / 2.0
    assert area.contains(middle)
    assert area.contains(area.lower)
    assert area.contains(area.upper)
    for i in range(2):
        for j in range(3):
            outside = middle.copy()
            outside[i, j] = area.upper[i, j] + 1e-6
            assert not area.contains(outside)
            assert area.contains(outside, tolerance=1e-5)


@pytest.mark.parametrize("shape", [(), (4,), (2, 3), (0,)])
def test_leading_axes_are_carried(shape: tuple[int, ...]) -> None:
    area = WorkArea((BOWL, CUP))
    coordinates = np.broadcast_to(area.lower, (*shape, 2, 3))
    X_WO = area.X_WO(coordinates)
    assert X_WO.shape == (*shape, 2, 4, 4)
    assert area.coordinates(X_WO).shape == (*shape, 2, 3)
    assert area.contains(coordinates).shape == shape


@pytest.mark.parametrize("x", [np.nan, -np.inf, 1e308, 1000.1])
def test_numbers_that_are_no_place_are_refused(x: float) -> None:
    area = WorkArea((ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), z=-0.1),))
    with pytest.raises(ValueError, match="numbers from -1000 to 1000"):
        area.complete([[x, 0.3]])
