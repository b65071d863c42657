"""Where a watched object stood, and frames over time, on arrays."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from drake_screw.recordings.frames import ALWAYS, Frames, Track
from drake_screw.recordings.resting import at_rest, median_pose
from drake_screw.screws import pose, quaternion_from_rotation, rotation_angle
from drake_screw.typing import Array

T = 0.02 * np.arange(300)
NOWHERE = (T, np.full((300, 3), 9.0))
"""The hand's times and positions, far away."""


def poses(seed: int, scatter: float, turn: float) -> Array:
    """300 poses about one that scatter normally, by m and rad along and about each axis."""
    rng = np.random.default_rng(seed)
    R = Rotation.from_rotvec([0.4, -1.0, 2.5]) * Rotation.from_rotvec(rng.normal(0, turn, (300, 3)))
    return pose(R.as_matrix(), rng.normal([0.5, 0.1, -0.2], scatter, (300, 3)))


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize(("scatter", "turn"), [(0.002, 0.02), (0.006, 0.05), (0.02, 0.2)])
def test_noise_of_any_size_is_no_motion_and_motion_beyond_it_is(
    seed: int, scatter: float, turn: float
) -> None:
    X = poses(seed, scatter, turn)
    found = at_rest("cup", T, X, *NOWHERE)
    assert not any("moved" in note or "turned" in note for note in found.notes)
    true = pose(Rotation.from_rotvec([0.4, -1.0, 2.5]).as_matrix(), [0.5, 0.1, -0.2])
    assert np.linalg.norm(found.X[:3, 3] - true[:3, 3]) < 0.4 * scatter
    assert rotation_angle(found.X, true) < 0.4 * turn
    X[200:, 0, 3] += 0.3
    found = at_rest("cup", T, X, *NOWHERE)
    assert "the cup moved by 3" in found.notes[0]
    assert " at 4.00 s; its pose is the one before that" in found.notes[0]
    assert np.linalg.norm(found.X[:3, 3] - true[:3, 3]) < 0.4 * scatter


def test_an_object_that_is_put_back_was_moved_all_the_same() -> None:
    X = poses(0, 0.0, 0.0)
    X[100:130, 2, 3] += 0.25
    found = at_rest("cup", T, X, *NOWHERE)
    assert found.notes == ("the cup moved by 25.0 cm at 2.00 s; its pose is the one before that",)


def test_a_median_that_most_of_the_rotations_share() -> None:
    """Two fifths of them are flipped, as of a marker that is seen two ways."""
    X = poses(0, 0.0, 0.0)
    X[::5, :3, :3] = X[0, :3, :3] @ Rotation.from_rotvec([0.0, 2.0, 0.0]).as_matrix()
    X[1::5, :3, :3] = X[1, :3, :3] @ Rotation.from_rotvec([1.5, 0.0, 0.3]).as_matrix()
    assert rotation_angle(median_pose(X), X[2]) < 1e-9


def test_interpolation_is_that_of_scipy() -> None:
    rng = np.random.default_rng(1)
    t = np.sort(rng.uniform(0.0, 10.0, 12))
    R = Rotation.random(12, rng=rng)
    p = rng.normal(size=(12, 3))
    track = Track.of(t, p, quaternion_from_rotation(R.as_matrix()), static=False)
    assert track is not None
    at = rng.uniform(t[0], t[-1], 50)
    X = track.at(at)
    np.testing.assert_allclose(X[:, :3, :3], Slerp(t, R)(at).as_matrix(), atol=1e-9)
    for j in range(3):
        np.testing.assert_allclose(X[:, j, 3], np.interp(at, t, p[:, j]), atol=1e-12)
    np.testing.assert_allclose(track.at(np.array([-1.0, 99.0]))[:, :3, 3], p[[0, -1]], atol=1e-12)


def test_chains_go_up_and_down_the_tree_whatever_its_root() -> None:
    rng = np.random.default_rng(2)
    names = ("base", "a", "b", "c", "bowl")
    R = Rotation.random(5, rng=rng).as_matrix()
    X = dict(zip(names, pose(R, rng.normal(size=(5, 3))), strict=True))

    def link(parent: str, child: str) -> tuple[tuple[str, str], Track]:
        X_PC = np.linalg.inv(X[parent]) @ X[child]
        q = quaternion_from_rotation(X_PC[:3, :3])[None]
        track = Track.of(np.zeros(1), X_PC[None, :3, 3], q, static=True)
        assert track is not None
        return (parent, child), track

    expected = np.linalg.inv(X["base"]) @ X["bowl"]
    for links in (
        [("base", "a"), ("a", "b"), ("b", "c"), ("c", "bowl")],
        [("bowl", "c"), ("c", "b"), ("b", "a"), ("a", "base")],
        [("b", "a"), ("b", "c"), ("a", "base"), ("c", "bowl")],
    ):
        seen = Frames(dict(link(*pair) for pair in links)).seen("bowl", "base")
        assert seen.t.tolist() == [ALWAYS]
        np.testing.assert_allclose(seen.X[0], expected, atol=1e-12)
