from __future__ import annotations

import numpy as np
import pytest

from drake_screw.visualization.camera import FILLED, HALF_HEIGHT, NARROW, camera_pose

BACK = np.array([1.12, -0.15, 0.84])


@pytest.mark.parametrize("size", [0.01, 1.0, 40.0])
def test_all_points_are_in_a_narrow_picture_and_fill_it(size) -> None:
    rng = np.random.default_rng(3)
    points = size * rng.normal(size=(200, 3)) * [1.0, 2.0, 0.5]
    pivot = points.mean(axis=0)
    at, target = camera_pose(points, BACK, pivot)
    u = (at - target) / np.linalg.norm(at - target)
    np.testing.assert_allclose(u, BACK / np.linalg.norm(BACK))
    assert u @ target == pytest.approx(u @ pivot)
    right = np.cross([0.0, 0.0, 1.0], u)
    right /= np.linalg.norm(right)
    away = points - at
    deep = -away @ u
    across = np.abs(away @ right / deep).max() / (HALF_HEIGHT * NARROW * FILLED)
    up = np.abs(away @ np.cross(u, right) / deep).max() / (HALF_HEIGHT * FILLED)
    assert (deep > 0.0).all()
    assert max(across, up) == pytest.approx(1.0)
