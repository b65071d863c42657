"""Which object a sample belongs to, and which visits to it are kept."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

from drake_screw.demonstrations.faithful import FaithfulConfig, faithful_guiding_poses
from drake_screw.demonstrations.regions import Visit
from drake_screw.screws import exp, inverse, pose

DEFAULT = FaithfulConfig()


def along(*points: Sequence[float], step: float = 0.001) -> np.ndarray:
    """An end effector that goes straight from point to point."""
    parts = [np.array(points[:1], dtype=float)]
    for a, b in pairwise(points):
        count = max(1, round(float(np.linalg.norm(np.subtract(b, a))) / step))
        parts.append(np.linspace(a, b, count + 1)[1:])
    return pose(np.eye(3), np.concatenate(parts))


def at(*points: Sequence[float]) -> np.ndarray:
    return pose(np.eye(3), np.array(points, dtype=float))


def test_the_region_is_decided_on_samples() -> None:
    path = along((0.4, 0.0, 0.1), (0.0, 0.0, 0.1), (0.0, 0.4, 0.1))
    X_WO = at((0.0, 0.0, 0.0))
    (visit,) = DEFAULT.regions(path, X_WO).visits
    distance = np.linalg.norm(path[:, :3, 3], axis=1)
    np.testing.assert_array_equal(
        np.arange(visit.start, visit.stop), np.flatnonzero(distance <= 0.15)
    )
    _, _, kept = faithful_guiding_poses(path, X_WO, DEFAULT)
    assert (kept[0], kept[-1]) == (visit.start, visit.stop - 1)


def test_a_bystander_owns_no_pose_and_may_stand_anywhere_beyond_reach() -> None:
    path = along((0.3, 0.0, 0.3), (0.1, 0.0, 0.1), (0.1, 0.0, 0.2), (0.3, 0.2, 0.3))
    bowl = at((0.0, 0.0, 0.0))
    expected = faithful_guiding_poses(path, bowl, DEFAULT)
    for cup in (0.0, -0.5, 0.0), (-0.3, -0.4, 0.0), (0.1, 0.9, 0.2):
        X_WO = np.concatenate([bowl, at(cup)])
        regions = DEFAULT.regions(path, X_WO)
        assert regions.task.tolist() == [True, False]
        assert regions.smallest[1] > DEFAULT.reach
        found = faithful_guiding_poses(path, X_WO, DEFAULT)
        for a, b in zip(found, expected, strict=True):
            np.testing.assert_array_equal(a, b)


def test_named_objects_alone_own_poses_whatever_their_distance() -> None:
    path = along((0.3, 0.0, 0.3), (0.1, 0.0, 0.1), (0.1, 0.0, 0.2), (0.3, 0.2, 0.3))
    X_WO = at((0.0, 0.0, 0.0), (0.0, 0.7, 0.0))
    assert set(faithful_guiding_poses(path, X_WO, DEFAULT, named=[0])[1]) == {0}
    assert set(faithful_guiding_poses(path, X_WO, DEFAULT, named=[1])[1]) == {1}


def test_nearest_is_in_metres_not_in_proportion() -> None:
    """On the way past the bowl the can is at its own nearest, but farther than the bowl."""
    path = along((0.0, 0.10, 0.0), (0.10, 0.0, 0.0))
    X_WO = at((0.0, 0.0, 0.0), (0.35, 0.0, 0.0))
    _, objects, _ = faithful_guiding_poses(path, X_WO, DEFAULT)
    assert set(objects) == {0}


A, B = (0.0, 0.0, 0.0), (0.5, 0.0, 0.0)
AT_A, AT_B = (0.0, 0.0, 0.1), (0.5, 0.0, 0.1)
OVER_A, OVER_B = (0.0, 0.0, 0.3), (0.5, 0.0, 0.3)


def test_each_object_visited_in_turn_has_a_run_of_poses_also_on_return() -> None:
    path = along(OVER_A, AT_A, OVER_A, OVER_B, AT_B, OVER_B, OVER_A, AT_A, OVER_A)
    X_WO = at(A, B)
    X_OE, objects, kept = faithful_guiding_poses(path, X_WO, DEFAULT)
    changes = np.flatnonzero(np.diff(objects)) + 1
    assert [int(run[0]) for run in np.split(objects, changes)] == [0, 1, 0]
    assert (np.diff(kept) > 0).all()
    np.testing.assert_allclose(X_OE, inverse(X_WO[objects]) @ path[kept], atol=1e-14)
    for run in np.split(kept, changes):
        assert path[run, 2, 3].min() == pytest.approx(0.1, abs=0.004)
        np.testing.assert_allclose(path[run[[0, -1]], 2, 3], 0.15, atol=0.0011)


def test_of_visits_that_follow_on_each_other_the_first_is_kept() -> None:
    path = along(OVER_A, AT_A, OVER_A, (0.0, 0.0, 0.095), OVER_A)
    regions = DEFAULT.regions(path, at(A))
    (visit,), (left_out,) = regions.visits, regions.left_out
    assert visit.stop < left_out.start
    np.testing.assert_array_equal(regions.samples(0), np.arange(visit.start, visit.stop))
    assert len(regions.samples(0, all_visits=True)) == len(regions.samples(0)) + (
        left_out.stop - left_out.start
    )


def test_a_graze_of_the_region_is_not_the_visit() -> None:
    path = along(OVER_A, (0.0, 0.0, 0.14), OVER_A, AT_A, OVER_A)
    regions = DEFAULT.regions(path, at(A))
    (visit,), (graze,) = regions.visits, regions.left_out
    assert graze.stop < visit.start
    assert path[visit.start : visit.stop, 2, 3].min() == pytest.approx(0.1)


def test_trembling_breaks_no_visit_and_changes_no_owner() -> None:
    rng = np.random.default_rng(0)
    path = along((0.16, 0.0, 0.1), (-0.2, 0.0, 0.1), step=2e-4)
    path[:, :3, 3] += rng.uniform(-0.002, 0.002, (len(path), 3))
    X_WO = at((-0.1, 0.0, 0.0), (0.1, 0.0, 0.0))
    visits = DEFAULT.regions(path, X_WO).visits
    assert [visit.object for visit in visits] == [1, 0]


def test_a_visit_that_never_ends() -> None:
    path = along(AT_A, (0.0, 0.04, 0.1))
    assert DEFAULT.regions(path, at(A)).visits == (Visit(0, 0, len(path)),)


def test_no_object_within_reach() -> None:
    path = along((0.6, 0.0, 0.3), (0.6, 0.0, 0.1))
    X_OE, objects, kept = faithful_guiding_poses(path, at(A), DEFAULT)
    assert (X_OE.shape, objects.shape, kept.shape) == ((0, 4, 4), (0,), (0,))


def test_all_moves_with_path_and_objects() -> None:
    path = along(OVER_A, AT_A, OVER_A, OVER_B, AT_B, OVER_B)
    X_WO, Y = at(A, B), exp([0.2, -0.1, 0.5, 0.3, 0.2, 0.1])
    one, other = (faithful_guiding_poses(X @ path, X @ X_WO, DEFAULT) for X in (np.eye(4), Y))
    np.testing.assert_array_equal(one[1], other[1])
    np.testing.assert_allclose(one[0][[0, -1]], other[0][[0, -1]], atol=2e-3)
    assert len(one[2]) == len(other[2])
