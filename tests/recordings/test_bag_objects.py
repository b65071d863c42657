"""Where objects were by a bag: chains of transforms, poses that jitter, objects that move."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drake_screw import RecordingError, Setup
from drake_screw.assembly.importing import read_recordings
from drake_screw.demonstrations import Recording
from drake_screw.recordings import Mapping, Understood
from drake_screw.screws import (
    inverse,
    pose,
    quaternion_from_rotation,
    rotation_angle,
    rotation_from_quaternion,
)
from drake_screw.typing import Array
from tests.recordings.bags import LEFT, START, bag, motion

pytest.importorskip("rosbags")
Write = Callable[..., None]
BOWL = pose(rotation_from_quaternion([0.97, 0.0, 0.0, 0.24]), [0.8, 0.5, -0.1])
CAMERA = pose(rotation_from_quaternion([0.3, -0.8, 0.4, 0.1]), [0.3, -0.2, 1.1])
MARKER = pose(rotation_from_quaternion([0.5, 0.5, -0.5, 0.5]), [0.05, 0.02, -0.03])
BASE = pose(rotation_from_quaternion([0.9, 0.1, 0.0, -0.2]), [1.0, 2.0, 0.8])


def joints(write: Write) -> None:
    t, q = motion()
    for s, row in zip(t.tolist(), q, strict=True):
        write("/joint_states", s, "joints", LEFT, row)


def quaternion(X: Array) -> tuple[float, ...]:
    w, x, y, z = quaternion_from_rotation(X[:3, :3]).tolist()
    return x, y, z, w


def shifted(X: Array, p: tuple[float, float, float]) -> Array:
    moved = X.copy()
    moved[:3, 3] += p
    return moved


def imported(
    folder: Path, setup: Setup, fill: Callable[[Write], None], kind: str = "bag", **keys: object
) -> Understood:
    path = folder / ("demo.bag" if kind == "bag" else "demo")
    with bag(path, kind) as write:
        fill(write)
    (found,) = read_recordings(path, setup, Mapping.model_validate(keys))
    return found


def recording(found: Understood) -> Recording:
    assert found.recording is not None
    return found.recording


def said(found: Understood) -> str:
    return dict(found.facts)["object"]


@pytest.mark.parametrize("kind", ["bag", "db3", "mcap"])
def test_a_chain_of_static_and_moving_frames(kind: str, setup: Setup, tmp_path: Path) -> None:
    """World to camera to marker to bowl, and the base in that world: slashes, too, as in ROS 1."""
    X_CB = inverse(BASE @ CAMERA) @ BASE @ BOWL

    def fill(write: Write) -> None:
        static = [("world", "/base", BASE), ("world", "camera", BASE @ CAMERA)]
        write("/tf_static", START - 5.0, "tree", static)
        write("/tf_static", START - 5.0, "tree", [("marker", "bowl", MARKER)])
        for i in range(20):
            X_CM = X_CB @ inverse(MARKER)
            write("/tf", START + 0.1 * i, "tree", [("camera", "marker", X_CM)])
        joints(write)

    found = imported(tmp_path, setup, fill, kind)
    np.testing.assert_allclose(recording(found).X_WO[0], BOWL, atol=1e-6)
    assert "by frame:bowl: the median of 20 poses all along" in said(found)
    assert "seen from 'base' by way of world, camera, marker" in said(found)
    assert recording(found).notes == ()


def test_frames_that_move_are_interpolated_at_the_objects_times(
    setup: Setup, tmp_path: Path
) -> None:
    """A camera on a slide, told of every 0.4 s, sees a bowl that stands still every 0.1 s."""

    def camera(s: float) -> Array:
        return shifted(CAMERA, (0.5 * s, -0.2 * s, 0.1 * s))

    def fill(write: Write) -> None:
        for i in range(7):
            write("/tf", START + 0.4 * i, "tree", [("base", "camera", camera(0.4 * i))])
        for i in range(24):
            X_CB = inverse(camera(0.1 * i)) @ BOWL
            write("/bowl", START + 0.1 * i, "pose", X_CB[:3, 3], quaternion(X_CB), "camera")
        joints(write)

    found = imported(tmp_path, setup, fill, objects={"bowl": "topic:/bowl"})
    np.testing.assert_allclose(recording(found).X_WO[0], BOWL, atol=1e-6)
    assert recording(found).notes == ()


def test_a_topic_of_transforms_goes_by_its_own_name_too(setup: Setup, tmp_path: Path) -> None:
    def fill(write: Write) -> None:
        write("/vicon/pot", START, "transform", ("base", "pot", BOWL))
        joints(write)

    for i, place in enumerate(("topic:/vicon/pot", "frame:pot", "frame:/pot")):
        folder = tmp_path / str(i)
        folder.mkdir()
        found = imported(folder, setup, fill, objects={"bowl": place})
        np.testing.assert_allclose(recording(found).X_WO[0], BOWL, atol=1e-6)
        assert "the only pose, at 0.00 s, seen from 'base'" in said(found)


def test_the_first_version_of_tf_and_the_scoped_names_of_models(
    setup: Setup, tmp_path: Path
) -> None:
    def fill(write: Write) -> None:
        for i in range(3):
            links = [("/world", "/left::base", BASE), ("/world", "/pot", BASE @ BOWL)]
            write("/tf", START + i, "old tree", [*links, ("/world", "/right::base", CAMERA)])
        joints(write)

    found = imported(tmp_path, setup, fill, objects={"bowl": "frame:pot"}, base_frame="left::base")
    np.testing.assert_allclose(recording(found).X_WO[0], BOWL, atol=1e-6)
    assert "seen from 'left::base' by way of world" in said(found)


def test_a_missing_link_is_named_with_the_frames_that_there_are(
    setup: Setup, tmp_path: Path
) -> None:
    def fill(write: Write) -> None:
        write("/tf_static", START, "tree", [("torso", "base", BASE), ("camera", "marker", MARKER)])
        write("/tf", START, "tree", [("marker", "bowl", MARKER)])
        joints(write)

    with pytest.raises(RecordingError) as caught:
        imported(tmp_path, setup, fill)
    assert caught.value.message == (
        "no chain of transforms from the robot's base 'base' to 'bowl': 'bowl' is seen from "
        "'marker', 'marker' is seen from 'camera'; nothing says where 'camera' is, seen from "
        "'torso', which 'base' hangs from"
    )
    assert caught.value.remedy is not None
    assert "Record that transform, too" in caught.value.remedy
    assert caught.value.remedy.endswith("Frames: base, bowl, camera, marker, torso")
    (found,) = read_recordings(
        tmp_path / "demo.bag", setup, Mapping(objects={"bowl": (0.8, 0.5, 0.1)})
    )
    assert "given" in said(found)


def test_a_base_that_is_called_otherwise(setup: Setup, tmp_path: Path) -> None:
    def fill(write: Write) -> None:
        write("/tf_static", START, "tree", [("world", "torso_base", BASE)])
        write("/bowl", START, "pose", (BASE @ BOWL)[:3, 3], quaternion(BASE @ BOWL), "world")
        joints(write)

    at = {"bowl": "topic:/bowl"}
    with pytest.raises(RecordingError) as caught:
        imported(tmp_path, setup, fill, objects=at)
    assert "'/bowl' is seen from 'world'; no frame of the bag is called 'base'" in str(caught.value)
    assert "Say base_frame: world (or as the bag calls the robot's base)" in str(caught.value)
    named = Mapping(objects=at, base_frame="torso_base")
    (found,) = read_recordings(tmp_path / "demo.bag", setup, named)
    np.testing.assert_allclose(recording(found).X_WO[0], BOWL, atol=1e-6)
    with pytest.raises(RecordingError, match="Did you mean 'torso_base'"):
        read_recordings(tmp_path / "demo.bag", setup, named.with_(base_frame="torso_bse"))
    (tmp_path / "recording.yaml").write_text("base_frame: torso_base\nobjects: {bowl: topic:/bowl}")
    (found,) = read_recordings(tmp_path / "demo.bag", setup, Mapping())
    assert "seen from 'torso_base' by way of world" in said(found)


def test_a_frame_without_a_name_is_the_base(setup: Setup, tmp_path: Path) -> None:
    def fill(write: Write) -> None:
        write("/bowl", START - 1.25, "pose", BOWL[:3, 3], quaternion(BOWL), "")
        joints(write)

    found = imported(tmp_path, setup, fill, objects={"bowl": "topic:/bowl"})
    np.testing.assert_allclose(recording(found).X_WO[0], BOWL, atol=1e-6)
    assert "the last pose before the recording, 1.25 s before its start" in said(found)
    assert "seen from a frame without a name, taken for 'base'" in said(found)


def test_jitter_is_no_motion_and_gives_its_median(setup: Setup, tmp_path: Path) -> None:
    """Half of the samples to either side, and three that are far off or lost: the middle stays."""
    rng = np.random.default_rng(0)
    side = rng.uniform(0.002, 0.012, (24, 3))
    off = np.concatenate([[np.zeros(3)], side, -side])[rng.permutation(49)]

    def fill(write: Write) -> None:
        for i, shift in enumerate(off):
            X = shifted(BOWL, tuple(shift))
            write("/bowl", START + 0.05 * i, "pose", X[:3, 3], quaternion(X))
        write("/bowl", START + 0.51, "pose", (3.0, 0.0, 0.0), (0, 0, 0, 1))
        write("/bowl", START + 1.51, "pose", (-3.0, 1.0, -2.0), (0, 0, 1, 0))
        write("/bowl", START + 1.62, "pose", (np.nan, 0.0, 0.0), (0, 0, 0, 1))
        write("/bowl", START + 1.63, "pose", (0.0, 0.0, 0.0), (0, 0, 0, 0))
        joints(write)

    found = imported(tmp_path, setup, fill, objects={"bowl": "topic:/bowl"})
    X = recording(found).X_WO[0]
    np.testing.assert_allclose(X[0, 3], BOWL[0, 3], atol=1e-6)
    assert np.abs(X[:3, 3] - BOWL[:3, 3]).max() < 0.003
    assert rotation_angle(X, BOWL) < 1e-6
    (note,) = recording(found).notes
    assert note.startswith("the bowl is taken to be at the median of 51 poses all along, half of")
    assert "moved" not in note


def stood_at_first(found: Understood, note: str) -> None:
    """The bowl is taken to be where it was before what a note says."""
    np.testing.assert_allclose(recording(found).X_WO[0], BOWL, atol=1e-6)
    assert recording(found).notes == (f"{note}; its pose is the one before that",)


def test_an_object_that_moves_is_where_it_was_before(setup: Setup, tmp_path: Path) -> None:
    def fill(write: Write) -> None:
        for i in range(49):
            X = shifted(BOWL, (0.0, 0.0, 0.12 * min(max(0.05 * i - 1.5, 0.0) / 0.5, 1.0)))
            write("/bowl", START + 0.05 * i, "pose", X[:3, 3], quaternion(X))
        joints(write)

    found = imported(tmp_path, setup, fill, objects={"bowl": "topic:/bowl"})
    stood_at_first(found, "the bowl moved by 12.0 cm at 1.60 s")
    assert "the median of 32 poses before it moved" in said(found)


def test_an_object_told_of_only_when_it_changes(setup: Setup, tmp_path: Path) -> None:
    def fill(write: Write) -> None:
        write("/bowl", START - 3.0, "pose", BOWL[:3, 3], quaternion(BOWL))
        turned = BOWL @ pose(rotation_from_quaternion([np.cos(0.2), 0, 0, np.sin(0.2)]), [0, 0, 0])
        write("/bowl", START + 2.0, "pose", turned[:3, 3], quaternion(turned))
        joints(write)

    found = imported(tmp_path, setup, fill, objects={"bowl": "topic:/bowl"})
    stood_at_first(found, "the bowl turned by 0.40 rad at 2.00 s")
    assert "the only pose before it moved" in said(found)


def test_poses_count_until_the_hand_is_near(setup: Setup, tmp_path: Path) -> None:
    """From then on the hand hides part of the marker, which shows it 1 cm aside."""
    t, q = motion()
    p_WE = setup.workcell.arm.pose(q)[:, :3, 3]
    end = pose(np.eye(3), p_WE[-1])
    far = np.linalg.norm(p_WE - end[:3, 3], axis=-1) >= 0.2
    assert 3 < np.count_nonzero(far) < len(t) // 2

    def fill(write: Write) -> None:
        for s, away in zip(t.tolist(), far.tolist(), strict=True):
            X = end if away else shifted(end, (0.01, 0.0, 0.0))
            write("/bowl", s, "pose", X[:3, 3], quaternion(X))
        joints(write)

    found = imported(tmp_path, setup, fill, objects={"bowl": "topic:/bowl"})
    np.testing.assert_allclose(recording(found).X_WO[0], end, atol=1e-6)
    until = float(t[np.argmin(far)] - t[0])
    words = re.search(r"poses until the hand came within 0.2 m of it at (.*) s, most", said(found))
    assert words is not None
    assert abs(float(words.group(1)) - until) < 0.051


def test_each_episode_has_its_own_place(setup: Setup, tmp_path: Path) -> None:
    """The bowl is carried to another place between two demonstrations."""
    other = shifted(BOWL, (0.1, -0.15, 0.0))
    t = 0.05 * np.arange(201)
    s = np.interp(t, [0.0, 3.0, 7.0, 10.0], [0.0, 0.5, 0.5, 0.0])
    rest = np.array([0.5, -0.2, -0.7, 1.5, 1.8, -0.9, -0.5])

    def fill(write: Write) -> None:
        for at, angle in zip(t.tolist(), s.tolist(), strict=True):
            write("/joint_states", START + at, "joints", LEFT, rest + angle * np.eye(7)[0])
            X = shifted(BOWL, tuple(np.interp(at, [4.0, 6.0], [0, 1]) * (other - BOWL)[:3, 3]))
            write("/bowl", START + at, "pose", X[:3, 3], quaternion(X))

    with bag(tmp_path / "demo.bag", "bag") as write:
        fill(write)
    mapping = Mapping(objects={"bowl": "topic:/bowl"}, episodes="pauses")
    first, second = read_recordings(tmp_path / "demo.bag", setup, mapping)
    np.testing.assert_allclose(recording(first).X_WO[0], BOWL, atol=1e-6)
    np.testing.assert_allclose(recording(second).X_WO[0], other, atol=1e-6)
    assert not any("moved" in note for each in (first, second) for note in recording(each).notes)
    (whole,) = read_recordings(
        tmp_path / "demo.bag", setup, mapping.model_copy(update={"episodes": None})
    )
    assert any(note.startswith("the bowl moved by 18.0 cm at ") for note in recording(whole).notes)


@pytest.mark.parametrize("known", [True, False])
def test_hand_poses_seen_from_another_frame(known: bool, setup: Setup, tmp_path: Path) -> None:
    t, q = motion()
    X_WE = setup.workcell.arm.pose(q)
    X_VE = BASE @ X_WE if known else X_WE

    def fill(write: Write) -> None:
        if known:
            write("/tf_static", START - 1.0, "tree", [("vicon", "base", BASE)])
        for s, X in zip(t.tolist(), X_VE, strict=True):
            write("/hand", s, "pose", X[:3, 3], quaternion(X), "vicon")

    found = imported(tmp_path, setup, fill, topic="/hand", objects={"bowl": (0.8, 0.5)})
    path = recording(found).X_WE
    assert path is not None
    np.testing.assert_allclose(path, X_WE, atol=1e-6)
    (note,) = recording(found).notes
    assert note == (
        "the hand's poses were seen from 'vicon', and are from 'base' now"
        if known
        else "the hand's poses are seen from 'vicon'; that is taken for the robot's base 'base', "
        "since no transforms lead from there to it"
    )
