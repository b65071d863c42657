"""The measure of fidelity does not depend on how guiding poses were found."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw.demonstrations import SegmentationConfig, guiding_poses, read_library
from drake_screw.demonstrations.deviations import deviations, on_screws
from drake_screw.demonstrations.faithful import FaithfulConfig, faithful_guiding_poses
from drake_screw.demonstrations.fidelity import Fidelity, fidelity, turn
from drake_screw.demonstrations.refusal import NoMotionKept, require_motion
from drake_screw.errors import RecordingError
from drake_screw.robot import Arm
from drake_screw.screws import exp, pose, pose_from_planar

DEFAULT = FaithfulConfig()
BOWL = np.eye(4)[None]


def measured(path: np.ndarray, guides: np.ndarray, t: np.ndarray | None = None) -> Fidelity:
    t = 0.01 * np.arange(len(path)) if t is None else t
    objects = np.zeros(len(guides), dtype=np.int64)
    (result,) = fidelity(path, t, BOWL, guides, objects, ["bowl"], DEFAULT)
    return result


def dip(depth: float = 0.1, turned: float = 1.0) -> np.ndarray:
    """Down beside the bowl, a turn there, up again; with time to spare at the start."""
    coordinates = np.zeros((400, 3))
    coordinates[:, 0] = 0.1
    coordinates[:, 2] = np.clip(np.linspace(-1.0, 2.0, 400), 0.0, 1.0) * turned
    z = np.interp(np.arange(400), [0, 133, 266, 399], [0.5, depth, depth, 0.5])
    return pose_from_planar(coordinates, z)


def test_all_samples_as_guiding_poses_are_kept_exactly() -> None:
    path = dip()
    near = DEFAULT.regions(path, BOWL).samples(0)
    found = measured(path, path[near])
    assert found.position <= 2e-4
    assert found.rotation <= 2e-3
    assert found.turn_kept == pytest.approx(found.turn_shown)
    assert found.time == pytest.approx(len(near) / (len(path) - 1))


def test_what_the_ends_leave_out_is_told_by_turn_and_time() -> None:
    path = dip()
    near = DEFAULT.regions(path, BOWL).samples(0)
    half = near[: len(near) // 2]
    found = measured(path, path[half])
    assert found.position <= 2e-4
    assert found.turn_shown == pytest.approx(1.0, abs=0.01)
    assert found.turn_kept == pytest.approx(0.5, abs=0.02)
    assert found.time == pytest.approx(len(half) / (len(path) - 1), abs=0.02)


def test_a_known_deviation_is_found() -> None:
    path = dip(turned=0.0)
    near = DEFAULT.regions(path, BOWL).samples(0)
    path[200, 1, 3] += 0.02
    path[near[50], :3, :3] = exp([0.0, 0.3, 0.0, 0.0, 0.0, 0.0])[:3, :3]
    guides = path[[near[0], 133, 266, near[-1]]]
    found = measured(path, guides)
    assert found.position == pytest.approx(0.02, abs=1e-3)
    assert found.rotation == pytest.approx(0.3, abs=1e-3)


def test_order_counts() -> None:
    """Out, half-way back, out: a straight screw passes every sample, but not in this order."""
    x = np.interp(np.arange(300), [0, 100, 200, 299], [0.0, 0.1, 0.05, 0.15])
    path = pose(np.eye(3), np.stack([x, np.zeros(300), np.full(300, 0.2)], axis=1))
    place, _ = deviations(path, on_screws(path[[0, -1]]), DEFAULT)
    assert place.max() == pytest.approx(0.025, abs=2e-4)


def test_a_deviation_is_measured_at_one_point_of_the_screw() -> None:
    """Turning first and moving afterwards is not turning while moving."""
    coordinates = np.zeros((200, 3))
    coordinates[:100, 2], coordinates[100:, 2] = np.linspace(0.0, 0.4, 100), 0.4
    coordinates[100:, 0] = np.linspace(0.0, 0.2, 100)
    path = pose_from_planar(coordinates)
    place, angle = deviations(path, on_screws(path[[0, -1]]), DEFAULT)
    assert max(place.max() / 0.010, angle.max() / 0.1) > 1.5


def test_screws_are_sampled_densely() -> None:
    guides = np.stack([np.eye(4), exp([0.0, 0.0, 2.9, 0.0, 0.3, 0.1]), pose(np.eye(3), [1, 0, 0])])
    track = on_screws(guides)
    steps = np.linalg.norm(np.diff(track[:, :3, 3], axis=0), axis=1)
    assert steps.max() <= 2.5e-4
    np.testing.assert_allclose(track[[0, -1]], guides[[0, -1]], atol=1e-12)


@pytest.mark.parametrize(
    ("angles", "expected"),
    [
        ([0.0, 1.38], 1.38),
        ([0.0, 1.2, 0.0], 2.4),
        ([0.0, 5.0, -1.0], 11.0),
        ([0.0, 0.5, 0.4, 1.0], 1.0),
        ([0.0, 0.0], 0.0),
    ],
)
def test_turn_is_the_total_variation_without_trembling(
    angles: list[float], expected: float
) -> None:
    shown = np.interp(np.linspace(0.0, len(angles) - 1.0, 1001), np.arange(len(angles)), angles)
    path = pose_from_planar(np.stack([0.0 * shown, 0.0 * shown, shown], axis=1))
    assert turn(path, 0.2) == pytest.approx(expected, abs=0.02)
    noise = np.random.default_rng(0).uniform(-0.01, 0.01, (len(path), 6)) * ([1.0] * 3 + [0.0] * 3)
    assert turn(path @ exp(noise), 0.2) == pytest.approx(expected, abs=0.1)


def test_runs_of_two_objects_are_measured_apart() -> None:
    X_WO = pose(np.eye(3), [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]])
    z = np.interp(np.arange(1401), 200 * np.arange(8), [0.3, 0.1, 0.3, 0.3, 0.1, 0.3, 0.3, 0.1])
    x = np.interp(np.arange(1401), 200 * np.arange(8), [0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 0.0, 0.0])
    path, t = pose(np.eye(3), np.stack([x, 0.0 * x, z], axis=1)), 0.01 * np.arange(1401)
    X_OE, objects, _ = faithful_guiding_poses(path, X_WO, DEFAULT, t=t)
    first, second = fidelity(path, t, X_WO, X_OE, objects, ["jug", "mug"], DEFAULT)
    assert (first.object, second.object) == ("jug", "mug")
    assert first.guiding_poses + second.guiding_poses == len(objects)
    assert max(first.position, second.position) <= 0.010
    assert first.time > 1.2 * second.time
    lost = fidelity(path, t, X_WO, X_OE[objects == 0], objects[objects == 0], "ab", DEFAULT)[1]
    assert lost.position == np.inf
    assert str(lost) == "no guiding pose of the b; 0.00 rad of turn lost"


def test_one_line() -> None:
    kept = Fidelity("bowl", 7, 0.0061, 0.0795, 0.4, 1.381, 1.358)
    assert str(kept) == (
        "7 guiding poses of the bowl; kept to 6 mm and 0.08 rad; turn 1.36 of 1.38 rad"
    )


def test_published_guiding_poses_lose_what_is_known_of_them(
    shared: Path, calibrated_arm: Arm
) -> None:
    arm = calibrated_arm
    library = read_library(shared / "demos" / "pouring", arm.joint_names, arm.lower, arm.upper)
    recording = {r.name: r for r in library}["demo_30"]
    path = arm.pose(recording.q)
    X_OE, objects, _ = guiding_poses(path, recording.X_WO, SegmentationConfig())
    (found,) = fidelity(path, recording.t, recording.X_WO, X_OE, objects, ["bowl"], DEFAULT)
    assert found.rotation == pytest.approx(0.62, abs=0.01)
    assert found.turn_shown - found.turn_kept > 1.0


# demonstrations that keep no motion


def refused(path: np.ndarray, X_WO: np.ndarray, config: FaithfulConfig = DEFAULT) -> NoMotionKept:
    t, names = 0.01 * np.arange(len(path)), ["bowl", "cup"][: len(X_WO)]
    _, objects, kept = faithful_guiding_poses(path, X_WO, config, t=t)
    with pytest.raises(NoMotionKept) as caught:
        require_motion(path, t, X_WO, objects, kept, config.regions(path, X_WO), names, config)
    assert isinstance(caught.value, RecordingError)
    assert caught.value.remedy
    return caught.value


def test_an_object_far_away_is_told() -> None:
    error = refused(dip(), pose(np.eye(3), [[0.1, 0.9, 0.1], [0.1, -0.7, 0.1]]))
    assert error.reason == "far"
    assert "no nearer than 0.70 m to an object (cup)" in error.message
    assert "0.35 m" in error.message


def test_an_object_at_the_very_place_of_the_end_effector_is_named() -> None:
    path = dip()
    error = refused(path, path[60:61])
    assert error.reason == "at the end effector"
    assert "bowl is at the end effector's very place" in error.message
    assert "holds 1 of 400 samples" in error.message


def test_a_region_in_which_the_end_effector_does_not_move_is_named() -> None:
    z = np.abs(np.linspace(-0.4, 0.4, 401)) + 0.1
    path = pose(np.eye(3), np.stack([0.0 * z, 0.0 * z, z], axis=1))
    error = refused(path, BOWL, FaithfulConfig(region_of_interest=1.0))
    assert error.reason == "small region"
    assert "holds 1 of 401 samples (0.00 s), in which the end effector moves by 0" in error.message


def test_next_to_nothing_of_what_was_shown_near_the_object_is_told() -> None:
    y = np.linspace(-0.4, 0.4, 801)
    path = pose(np.eye(3), np.stack([0.0 * y, y, 0.0 * y + 0.012], axis=1))
    error = refused(path, BOWL)
    assert error.reason == "small region"
    assert "moves by 26 mm and turns by 0.00 rad; of 698 mm" in error.message


def test_motion_is_not_refused() -> None:
    turning = pose_from_planar(np.linspace([0.2, 0.0, 0.0], [0.2, 0.0, 0.5], 50))
    for path in dip(), turning:
        t = 0.01 * np.arange(len(path))
        _, objects, kept = faithful_guiding_poses(path, BOWL, DEFAULT, t=t)
        regions = DEFAULT.regions(path, BOWL)
        require_motion(path, t, BOWL, objects, kept, regions, ["bowl"], DEFAULT)
