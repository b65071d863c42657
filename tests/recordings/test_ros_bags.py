"""Bags of ROS 1 and ROS 2, written by rosbags."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw import RecordingError, Setup
from drake_screw.assembly.importing import read_recordings
from drake_screw.recordings import Mapping
from tests.recordings.bags import LEFT, bag, motion

pytest.importorskip("rosbags")


@pytest.mark.parametrize("kind", ["bag", "db3", "mcap"])
def test_joint_states_with_an_objects_pose(kind: str, setup: Setup, tmp_path: Path) -> None:
    t, q = motion()
    path = tmp_path / ("demo.bag" if kind == "bag" else "demo")
    order = [6, 2, 0, 1, 3, 5, 4]
    with bag(path, kind) as write:
        write("/bowl", t[0], "pose", (0.8, 0.5, -0.1), (0.0, 0.0, np.sin(0.25), np.cos(0.25)))
        for s, row in zip(t.tolist(), q, strict=True):
            write("/joint_states", s, "joints", [LEFT[j] for j in order], row[order])
            write("/joint_states", s, "joints", ["left_gripper"], [0.1])
    source = path if kind == "bag" else next(path.glob(f"*.{kind}"))
    for place in (source, path):
        (found,) = read_recordings(place, setup, Mapping(objects={"bowl": "topic:/bowl"}))
        assert found.recording is not None
        np.testing.assert_allclose(found.recording.q, q)
        np.testing.assert_allclose(found.recording.t, t - t[0], atol=1e-6)
        assert found.recording.notes == ("left out 50 messages with the names of other joints",)
        assert "seen from 'base'" in dict(found.facts)["object"]
        place_found = setup.area.coordinates(found.recording.X_WO)[0]
        np.testing.assert_allclose(place_found, [0.8, 0.5, 0.5], atol=1e-12)


def test_the_hands_poses_and_topics_that_there_are_not(setup: Setup, tmp_path: Path) -> None:
    t, q = motion()
    X = setup.workcell.arm.pose(q)
    from drake_screw.screws import quaternion_from_rotation

    with bag(tmp_path / "demo.bag", "bag") as write:
        for s, X_WE in zip(t.tolist(), X, strict=True):
            w, x, y, z = quaternion_from_rotation(X_WE[:3, :3])
            write("/hand", s, "pose", X_WE[:3, 3], (x, y, z, w))
    near = Mapping(objects={"bowl": (0.8, 0.5)})
    with pytest.raises(RecordingError, match="no topic of joint states") as caught:
        read_recordings(tmp_path / "demo.bag", setup, near)
    assert "/hand (geometry_msgs/msg/PoseStamped)" in str(caught.value)
    with pytest.raises(RecordingError, match="no topic '/hnd'"):
        read_recordings(tmp_path / "demo.bag", setup, near.with_(topic="/hnd"))
    with pytest.raises(RecordingError, match="no topic or frame '/bowl'"):
        read_recordings(
            tmp_path / "demo.bag",
            setup,
            Mapping(topic="/hand", objects={"bowl": "topic:/bowl"}),
        )
    (found,) = read_recordings(tmp_path / "demo.bag", setup, near.with_(topic="/hand"))
    assert found.recording is not None
    assert found.recording.X_WE is not None
    np.testing.assert_allclose(found.recording.X_WE, X, atol=1e-9)
