"""Demonstrations carry over to other places of the objects."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drake_screw.demonstrations import (
    Demonstration,
    FaithfulConfig,
    NoMotionKept,
    Recording,
    SegmentationConfig,
    demonstration_from_recording,
    read_library,
)
from drake_screw.robot import Arm, ScrewChain
from drake_screw.screws import exp, pose

COUNTS = {
    "pouring": [7, 5, 6, 6, 6, 6, 4, 6, 4, 5, 7, 7, 3, 3, 4, 6],
    "scooping": [5, 5, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3, 4, 3, 3, 4],
}


def sliding_hand() -> ScrewChain:
    """Three prismatic joints along x, y, z and a wrist about z: q is the end effector's place."""
    screws = np.zeros((4, 6))
    screws[:3, 3:] = np.eye(3)
    screws[3, 2] = 1.0
    return ScrewChain(("x", "y", "z", "wrist"), screws, np.eye(4), -np.ones(4), np.ones(4))


def reach(objects: int = 1) -> Recording:
    """Down beside object 0 at (0.5, 0, 0), on to the place of object 1 at (0.5, 0.6, 0), and up."""
    corners = np.array(
        [[0.2, 0, 0.5], [0.5, 0, 0.1], [0.5, 0, 0.4], [0.5, 0.6, 0.1], [0.1, 0.6, 0.5]]
    )
    s = np.linspace(0.0, 4.0, 801)
    q = np.stack([np.interp(s, np.arange(5), corners[:, i]) for i in range(3)], axis=1)
    q = np.concatenate([q, np.zeros((801, 1))], axis=1)
    X_WO = pose(np.eye(3), [[0.5, 0.0, 0.0], [0.5, 0.6, 0.0]])[:objects]
    return Recording("demo_01", ("x", "y", "z", "wrist"), 0.01 * np.arange(801), q, X_WO)


def made(recording: Recording, config: SegmentationConfig | None = None) -> Demonstration:
    return demonstration_from_recording(recording, sliding_hand(), config)  # type: ignore[arg-type]


@pytest.mark.parametrize("objects", [1, 2])
def test_transfer_to_where_it_was_recorded_gives_the_recorded_poses(objects: int) -> None:
    demonstration = made(reach(objects))
    assert demonstration.name == "demo_01"
    assert set(demonstration.objects) == set(range(objects))
    np.testing.assert_allclose(
        demonstration.transfer(demonstration.X_WO),
        demonstration.path[demonstration.kept],
        atol=1e-14,
    )
    np.testing.assert_allclose(demonstration.path[:, :3, 3], reach().q[:, :3], atol=1e-15)


@pytest.mark.parametrize("shape", [(), (3,), (2, 3), (0,)])
def test_transfer_is_equivariant_and_carries_leading_axes(shape: tuple[int, ...]) -> None:
    demonstration = made(reach(2))
    rng = np.random.default_rng(0)
    X_WO, Y = exp(rng.uniform(-1, 1, (*shape, 2, 6))), exp(rng.uniform(-1, 1, 6))
    X_WE = demonstration.transfer(X_WO)
    assert X_WE.shape == (*shape, len(demonstration.X_OE), 4, 4)
    np.testing.assert_allclose(demonstration.transfer(Y @ X_WO), Y @ X_WE, atol=1e-14)
    for index in np.ndindex(shape):
        for g, owner in enumerate(demonstration.objects):
            expected = X_WO[index][owner] @ demonstration.X_OE[g]
            np.testing.assert_allclose(X_WE[index][g], expected, atol=1e-14)


def test_poses_follow_the_object_they_belong_to_only() -> None:
    demonstration = made(reach(2))
    X_WO = demonstration.X_WO.copy()
    X_WO[1, 0, 3] += 0.2
    moved = (
        demonstration.transfer(X_WO)[:, :3, 3]
        - demonstration.transfer(demonstration.X_WO)[:, :3, 3]
    )
    np.testing.assert_allclose(moved[:, 0], 0.2 * (demonstration.objects == 1), atol=1e-14)


@pytest.mark.parametrize("method", [SegmentationConfig, FaithfulConfig])
def test_a_recordings_own_region_of_interest_overrides_the_configuration(method: type) -> None:
    recording = reach()
    wide = replace(recording, region_of_interest=1e3)
    usual, config = made(recording, method()), method(region_of_interest=1e3)
    found = made(wide, method())
    assert found.kept[0] < usual.kept[0] <= usual.kept[-1] < found.kept[-1]
    np.testing.assert_array_equal(found.kept, made(recording, config).kept)
    narrow = replace(recording, region_of_interest=1.0)
    if method is FaithfulConfig:
        with pytest.raises(NoMotionKept):
            made(narrow, config)
    else:
        assert len(made(narrow, config).X_OE) == 1


@pytest.mark.parametrize("task", ["pouring", "scooping"])
def test_recorded_demonstrations_have_the_published_number_of_guiding_poses(
    shared: Path, calibrated_arm: Arm, task: str
) -> None:
    arm = calibrated_arm
    library = read_library(
        shared / "demos" / task, arm.joint_names, arm.lower, arm.upper, objects=1
    )
    config = SegmentationConfig()
    demonstrations = [demonstration_from_recording(recording, arm, config) for recording in library]
    assert [len(d.X_OE) for d in demonstrations] == COUNTS[task]
    for d, recording in zip(demonstrations, library, strict=True):
        assert d.name == recording.name
        assert (np.diff(d.kept) > 0).all()
        np.testing.assert_allclose(d.transfer(d.X_WO), arm.pose(recording.q[d.kept]), atol=1e-12)
        away = np.linalg.norm(d.X_OE[:, :3, 3], axis=1)
        assert away.max() <= 1.5 * away.min()
