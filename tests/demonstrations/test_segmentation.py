"""Paths made of known constant screws are cut where the screws change; near objects they count."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from drake_screw.demonstrations import SegmentationConfig, guiding_poses, segment
from drake_screw.demonstrations.segmentation import fits_screw, thin
from drake_screw.screws import (
    exp,
    inverse,
    pose,
    quaternion_distance,
    sclerp,
    translation_distance,
)

DEFAULT = SegmentationConfig()
STRICT = SegmentationConfig(position_tolerance=1e-6, rotation_tolerance=1e-6)


def path_through(knots: Sequence[np.ndarray], spacing: float = 0.001) -> np.ndarray:
    """Constant screws from knot to knot, the knots among the poses, about `spacing` m apart."""
    parts = [np.asarray(knots[0])[None]]
    for A, B in pairwise(knots):
        coarse = sclerp(A, B, np.linspace(0.0, 1.0, 200))[:, :3, 3]
        length = np.linalg.norm(np.diff(coarse, axis=0), axis=1).sum()
        steps = max(2, int(np.ceil(length / spacing)))
        parts.append(sclerp(A, B, np.arange(1, steps + 1) / steps))
    return np.concatenate(parts)


def straight(*points: tuple[float, float, float]) -> np.ndarray:
    return path_through([pose(np.eye(3), p) for p in points])


@st.composite
def knots(draw: st.DrawFn, count: int) -> list[np.ndarray]:
    """Poses 0.08 to 0.2 m apart, each turned by 0.3 to 0.9 rad from the one before."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    poses = [exp(rng.uniform(-1.0, 1.0, 6))]
    while len(poses) < count:
        w, p = rng.normal(size=(2, 3))
        turn = exp([*(w / np.linalg.norm(w) * rng.uniform(0.3, 0.9)), 0.0, 0.0, 0.0])
        turn[:3, 3] = p / np.linalg.norm(p) * rng.uniform(0.08, 0.2)
        poses.append(poses[-1] @ turn)
    return poses


def test_thinned_poses_are_far_enough_apart_and_none_is_passed_over() -> None:
    path = path_through([np.eye(4), exp([0.5, 0.2, 0.1, 0.2, 0.1, 0.0])], 0.0007)
    kept = thin(path, 0.005)
    assert kept[0] == 0
    p = path[:, :3, 3]
    assert (np.linalg.norm(np.diff(p[kept], axis=0), axis=1) >= 0.005).all()
    for a, b in zip(kept, [*kept[1:], len(path)], strict=True):
        assert (np.linalg.norm(p[a + 1 : b] - p[a], axis=1) < 0.005).all()


def test_thinning_drops_turns_on_the_spot() -> None:
    turning = exp(np.linspace(0.0, 1.0, 50)[:, None] * [0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(thin(turning, 0.005), [0])


@settings(deadline=None, max_examples=25)
@given(knots(2))
def test_one_screw_has_two_ends(ends: list[np.ndarray]) -> None:
    path = path_through(ends)
    kept = thin(path, 0.005)
    for config in (DEFAULT, STRICT):
        np.testing.assert_array_equal(segment(path[kept], config), [0, len(kept) - 1])


def there_and_back() -> list[np.ndarray]:
    """101 steps of 0.99901 mm and 100 back of 0.9994 mm, then aside.

    Thinning keeps every sixth pose. The path turns 5 steps, 4.995 mm, behind one that is kept, and
    10 steps back are 9.994 mm: all but 5 mm on the other side of it, so the next one is kept.
    """
    x_y = [(0.0, 0.0), (0.1009, 0.0), (0.1009 - 0.09994, 0.0), (0.1009 - 0.09994, 0.1)]
    return [pose(np.eye(3), [x, y, 0.0]) for x, y in x_y]


@settings(deadline=None, max_examples=25)
@given(knots(4))
@example(there_and_back())
def test_strict_tolerances_cut_at_the_first_pose_kept_behind_each_change(
    poses: list[np.ndarray],
) -> None:
    """Which is nearer to the change than twice the spacing of thinning and a step of the path.

    Let a be the last pose kept up to the change c, and b the first one kept behind it, where the
    path is cut. Thinning drops what is nearer to a than the spacing d: |p_c - p_a| < d, and
    |p_i - p_a| < d for i = b - 1, too. With steps of the path of at most h,
    |p_b - p_c| <= |p_b - p_i| + |p_i - p_a| + |p_a - p_c| < h + 2 d.
    """
    path, spacing = path_through(poses), 0.005
    kept = thin(path, spacing)
    cuts = kept[segment(path[kept], STRICT)]
    p = path[:, :3, 3]
    step = np.linalg.norm(np.diff(p, axis=0), axis=1).max()
    changes = [
        int(np.argmin(np.linalg.norm(p - X[:3, 3], axis=1) + quaternion_distance(path, X)))
        for X in poses[1:-1]
    ]
    assert len(cuts) == 4
    for cut, change in zip(cuts[1:-1], changes, strict=True):
        first_after = kept[np.searchsorted(kept, change, side="right")]
        assert cut == first_after
        assert np.linalg.norm(p[cut] - p[change]) < 2.0 * spacing + step


def test_a_cut_can_be_as_far_from_its_change_as_thinning_allows() -> None:
    poses = there_and_back()
    path = path_through(poses)
    kept = thin(path, 0.005)
    cut = kept[segment(path[kept], STRICT)][1]
    away = np.linalg.norm(path[cut, :3, 3] - poses[1][:3, 3])
    assert away == pytest.approx(2 * 0.005 + 0.001, abs=1e-5)


def fits_by_search(path: np.ndarray, config: SegmentationConfig) -> bool:
    """The definition in slow motion: the nearest point of 4,001, then of 4,001 around it."""
    A, B, grid = path[0], path[-1], np.linspace(0.0, 1.0, 4001)
    track, s = sclerp(A, B, grid)[:, :3, 3], []
    for p in path[1:-1, :3, 3]:
        best = grid[np.argmin(np.linalg.norm(track - p, axis=1))]
        fine = np.clip(best + np.linspace(-1.0, 1.0, 4001) / 4000, 0.0, 1.0)
        near = sclerp(A, B, fine)[:, :3, 3]
        s.append(fine[np.argmin(np.linalg.norm(near - p, axis=1))])
    on_screw = sclerp(A, B, np.array(s))
    return bool(
        (translation_distance(on_screw, path[1:-1]) <= config.position_tolerance).all()
        and (quaternion_distance(on_screw, path[1:-1]) <= config.rotation_tolerance).all()
        and (np.abs(np.diff([*s, 1.0])) >= config.min_progress).all()
    )


@settings(deadline=None, max_examples=10)
@given(knots(3), st.integers(0, 2**32 - 1))
def test_fits_screw_says_what_its_definition_says(poses: list[np.ndarray], seed: int) -> None:
    rng = np.random.default_rng(seed)
    path = path_through(poses, 0.012)
    tremble = rng.normal(size=(len(path), 6)) * [0.02, 0.02, 0.02, 0.004, 0.004, 0.004]
    path = path @ exp(tremble)
    ends = np.array([1, 2, *rng.choice(np.arange(3, len(path)), 5, replace=False)])
    expected = [True] + [fits_by_search(path[: end + 1], DEFAULT) for end in ends[1:]]
    np.testing.assert_array_equal(fits_screw(path, ends, DEFAULT), expected)


@settings(deadline=None, max_examples=15)
@given(knots(4))
def test_each_segment_is_the_longest_that_fits(poses: list[np.ndarray]) -> None:
    path = path_through(poses, 0.006)
    cuts = segment(path, DEFAULT)
    assert cuts[0] == 0
    assert cuts[-1] == len(path) - 1
    assert (np.diff(cuts) > 0).all()
    for i, start in enumerate(cuts[:-1]):
        ends = np.arange(start + 1, cuts[i + 1] + 1)
        fits = fits_screw(path[start:], ends - start, DEFAULT)
        assert fits[:-1].all()
        assert i == len(cuts) - 2 or not fits[-1]


def test_a_bend_is_cut_once_the_way_round_it_is_too_far() -> None:
    bend, turn = np.array([0.2, 0.0, 0.0]), np.deg2rad(60.0)
    end = bend + 0.2 * np.array([np.cos(turn), np.sin(turn), 0.0])
    p = straight((0.0, 0.0, 0.0), tuple(bend), tuple(end))[:, :3, 3]
    away_from_bend = np.abs(np.cross(p, bend)[:, 2]) / np.maximum(np.linalg.norm(p, axis=1), 1e-9)
    first = int(np.argmax(away_from_bend > DEFAULT.position_tolerance))
    assert np.linalg.norm(p[first] - bend) > DEFAULT.position_tolerance
    np.testing.assert_array_equal(segment(pose(np.eye(3), p), DEFAULT), [0, first, len(p) - 1])


def test_a_right_angle_is_cut_at_once_because_the_path_stops_advancing() -> None:
    path = straight((0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.2, 0.2, 0.0))
    cuts = segment(path, DEFAULT)
    assert len(cuts) == 3
    assert 0.0 < path[cuts[1], 1, 3] < 0.002


def test_a_turn_within_a_straight_line_is_cut_by_rotation() -> None:
    knots = [pose(np.eye(3), [0.0, 0.0, 0.0]), pose(np.eye(3), [0.2, 0.0, 0.0])]
    knots.append(knots[1] @ exp([0.8, 0.0, 0.0, 0.1, 0.0, 0.0]))
    path = path_through(knots, 0.002)
    assert len(segment(path, DEFAULT)) == 3
    tolerant = SegmentationConfig(rotation_tolerance=1.0)
    assert len(segment(path, tolerant)) == 2


def test_lingering_ends_a_segment() -> None:
    path = straight((0.0, 0.0, 0.0), (0.1, 0.0, 0.0))
    lingering = np.concatenate(
        [path[:50], path[49:50] @ pose(np.eye(3), [1e-5, 0, 0])[None], path[50:]]
    )
    assert len(segment(path, DEFAULT)) == 2
    assert len(segment(lingering, DEFAULT)) > 2


def test_going_back_a_little_is_tremor_and_ends_no_segment() -> None:
    """The end effector trembles aside, and by 1.6 mm back as seen along the screw."""
    x_y = [(0, 0), (12, 0), (11, 8), (30, -2), (45, 0), (60, 0), (75, 0), (90, 0)]
    p = np.array([(x / 1000, y / 1000, 0.0) for x, y in x_y])
    along = p @ p[3] / np.linalg.norm(p[3])
    assert along[2] < along[1] - 1e-3
    path = pose(np.eye(3), p)
    assert fits_screw(path, np.arange(1, len(p)), DEFAULT).all()
    np.testing.assert_array_equal(segment(path, DEFAULT), [0, len(p) - 1])


@pytest.mark.parametrize("m", [1, 2, 3])
def test_short_paths(m: int) -> None:
    path = straight((0.0, 0.0, 0.0), (0.0, 0.0, 0.5))[:m]
    expected = [0] if m == 1 else [0, m - 1]
    np.testing.assert_array_equal(segment(path, DEFAULT), expected)


def test_cuts_do_not_depend_on_the_frame() -> None:
    rng = np.random.default_rng(5)
    poses = [exp(rng.uniform(-0.5, 0.5, 6)) for _ in range(5)]
    path = path_through(poses, 0.01)
    moved = exp(rng.uniform(-1.0, 1.0, 6)) @ path
    np.testing.assert_array_equal(segment(path, DEFAULT), segment(moved, DEFAULT))


# guiding poses

WAYPOINTS = [(0.5, 0.0, 0.3), (0.5, 0.0, 0.1), (0.1, 0.0, 0.1), (0.1, 0.0, 0.3), (0.1, 0.4, 0.3)]


def ends_of(path: np.ndarray, config: SegmentationConfig = DEFAULT) -> np.ndarray:
    kept = thin(path, config.spacing)
    return kept[segment(path[kept], config)]


def test_region_of_interest_is_what_is_near_the_object() -> None:
    path = straight(*WAYPOINTS)
    X_WO = exp([0.0, 0.0, 0.6, 0.0, 0.0, 0.0])
    X_WO[:3, 3] = [0.1, 0.0, 0.0]
    X_OE, objects, kept = guiding_poses(path, X_WO[None], DEFAULT)
    ends = ends_of(path)
    distances = np.linalg.norm(path[ends, :3, 3] - X_WO[:3, 3], axis=1)
    near = distances <= 1.5 * distances.min()
    assert 0 < near.sum() < len(ends)
    np.testing.assert_array_equal(kept, ends[near])
    np.testing.assert_array_equal(objects, 0)
    np.testing.assert_allclose(X_WO @ X_OE, path[kept], atol=1e-14)

    every = guiding_poses(path, X_WO[None], SegmentationConfig(region_of_interest=1e3))
    np.testing.assert_array_equal(every[2], ends)
    nearest = guiding_poses(path, X_WO[None], SegmentationConfig(region_of_interest=1.0))
    np.testing.assert_array_equal(nearest[2], ends[[np.argmin(distances)]])


def test_only_the_first_visit_counts() -> None:
    path = straight((0.5, 0, 0.1), (0.1, 0, 0.1), (0.1, 0, 0.5), (0.4, 0, 0.5), (0.1, 0.03, 0.1))
    X_WO = pose(np.eye(3), [0.1, 0.0, 0.0])[None]
    ends = ends_of(path)
    distances = np.linalg.norm(path[ends, :3, 3] - X_WO[0, :3, 3], axis=1)
    near = np.flatnonzero(distances <= 1.5 * distances.min())
    assert (np.diff(near) > 1).any(), "the path comes back"
    _, _, kept = guiding_poses(path, X_WO, DEFAULT)
    first = near[: int(np.argmax(np.diff(near) > 1)) + 1]
    np.testing.assert_array_equal(kept, ends[first])


def test_poses_belong_to_the_object_they_are_nearest_to_in_proportion() -> None:
    path = straight(
        (0.3, 0.3, 0.3), (0.0, 0.0, 0.1), (0.3, 0.0, 0.3), (0.6, 0.0, 0.1), (0.6, 0.4, 0.3)
    )
    X_WO = np.stack([exp([0.0, 0.0, 1.0, 0.0, 0.0, 0.0]), pose(np.eye(3), [0.6, 0.0, 0.0])])
    X_OE, objects, kept = guiding_poses(path, X_WO, DEFAULT)
    ends = ends_of(path)
    expected: dict[int, int] = {}
    distances = np.linalg.norm(path[ends, None, :3, 3] - X_WO[:, :3, 3], axis=2)
    for i, end in enumerate(ends):
        ratios = distances[i] / distances.min(axis=0)
        if (ratios <= 1.5).any():
            expected[int(end)] = int(np.argmin(ratios))
    assert list(kept) == list(expected)
    assert list(objects) == list(expected.values())
    assert {0, 1} == set(objects)
    np.testing.assert_allclose(X_WO[objects] @ X_OE, path[kept], atol=1e-14)


def test_nearness_counts_in_proportion_to_the_smallest_distance() -> None:
    path = straight((0.1, 0.0, 0.0), (0.0, 0.14, 0.0))
    X_WO = pose(np.eye(3), [[0.0, 0.0, 0.0], [0.0, 0.47, 0.0]])
    _, objects, kept = guiding_poses(path, X_WO, DEFAULT)
    # at the end object 0 is 0.14 m away, 1.4 times its least; object 1 0.33 m, which is its least
    np.testing.assert_allclose(path[kept, :3, 3], path[[0, -1], :3, 3], atol=0.005)
    np.testing.assert_array_equal(objects, [0, 1])


def test_a_pose_in_two_regions_is_kept_once() -> None:
    path = straight((0.3, 0.0, 0.3), (0.0, 0.0, 0.2))
    X_WO = np.stack([pose(np.eye(3), [0.0, 0.1, 0.0]), pose(np.eye(3), [0.0, -0.1, 0.0])])
    X_OE, objects, kept = guiding_poses(path, X_WO, DEFAULT)
    assert len(kept) == len(np.unique(kept)) == len(X_OE)
    np.testing.assert_array_equal(objects, 0)


def test_an_end_effector_that_passes_through_the_objects_origin() -> None:
    path = straight((0.3, 0.0, 0.0), (0.0, 0.0, 0.0))
    X_OE, _, kept = guiding_poses(path, np.eye(4)[None], DEFAULT)
    assert list(kept) == [len(path) - 1]
    np.testing.assert_allclose(X_OE[0], np.eye(4), atol=1e-15)


def test_guiding_poses_move_with_path_and_object() -> None:
    path = path_through([pose(np.eye(3), p) for p in WAYPOINTS], 0.0013)
    X_WO = pose(np.eye(3), [0.1, 0.0, 0.0])[None]
    Y = exp([0.2, -0.1, 0.5, 0.3, 0.2, 0.1])
    one, other = guiding_poses(path, X_WO, DEFAULT), guiding_poses(Y @ path, Y @ X_WO, DEFAULT)
    np.testing.assert_array_equal(one[2], other[2])
    np.testing.assert_allclose(one[0], other[0], atol=1e-12)
    np.testing.assert_allclose(one[0], inverse(X_WO) @ path[one[2]], atol=1e-14)
