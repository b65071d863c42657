"""A recording of people, written by the formats' own libraries, gives the same demonstration."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drake_screw import Setup
from drake_screw.assembly.importing import read_recordings
from drake_screw.demonstrations import Recording
from drake_screw.recordings import Mapping
from drake_screw.screws import quaternion_from_rotation
from tests.recordings.bags import LEFT, START, bag

SHUFFLED = [4, 1, 6, 0, 2, 5, 3]


def as_bag(kind: str) -> Callable[[Path, Recording], Mapping]:
    """Joints in another order, and the bowl's pose, that of a topic."""

    def write_bag(path: Path, demo: Recording) -> Mapping:
        pytest.importorskip("rosbags")
        w, x, y, z = quaternion_from_rotation(demo.X_WO[0, :3, :3])
        with bag(path, kind) as write:
            write("/bowl", START, "pose", demo.X_WO[0, :3, 3], (x, y, z, w))
            for t, q in zip(demo.t.tolist(), demo.q, strict=True):
                names = [LEFT[j] for j in SHUFFLED]
                write("/robot/joint_states", START + t, "joints", names, q[SHUFFLED])
        return Mapping(objects={"bowl": "topic:/bowl"})

    return write_bag


def as_hdf5(path: Path, demo: Recording) -> Mapping:
    """At one rate, as simulators have it, with the bowl's pose."""
    h5py = pytest.importorskip("h5py")
    w, x, y, z = quaternion_from_rotation(demo.X_WO[0, :3, :3])
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["env_args"] = json.dumps({"env_kwargs": {"control_freq": 100}})
        obs = data.create_group("demo_0/obs")
        obs["robot0_joint_pos"] = demo.q
        obs["bowl_pos"] = np.tile(demo.X_WO[0, :3, 3], (len(demo.t), 1))
        obs["bowl_quat"] = np.tile([x, y, z, w], (len(demo.t), 1))
    return Mapping()


def as_lerobot(path: Path, demo: Recording) -> Mapping:
    """In degrees, time in single precision."""
    pa = pytest.importorskip("pyarrow")
    import pyarrow.parquet as pq

    (path / "meta").mkdir(parents=True)
    (path / "data" / "chunk-000").mkdir(parents=True)
    names = [f"{LEFT[j]}.pos" for j in SHUFFLED]
    info = {"features": {"observation.state": {"names": names}}}
    (path / "meta" / "info.json").write_text(json.dumps(info))
    frames = {
        "observation.state": np.rad2deg(demo.q[:, SHUFFLED]).tolist(),
        "timestamp": demo.t.astype(np.float32),
        "episode_index": np.zeros(len(demo.t), dtype=int),
    }
    pq.write_table(pa.table(frames), path / "data" / "chunk-000" / "episode_000000.parquet")
    return Mapping(angles="deg", objects={"bowl": tuple(demo.X_WO[0].ravel().tolist())})


WAYS = {
    "demo.bag": as_bag("bag"),
    "demo_db3": as_bag("db3"),
    "demo_mcap": as_bag("mcap"),
    "demo.hdf5": as_hdf5,
    "demo_set": as_lerobot,
}


@pytest.mark.parametrize("name", WAYS)
def test_the_same_guiding_poses(name: str, setup: Setup, demo: Recording, tmp_path: Path) -> None:
    mapping = WAYS[name](tmp_path / name, demo)
    (found,) = read_recordings(tmp_path / name, setup, mapping)
    assert found.recording is not None
    want, have = setup.learn(demo), setup.learn(found.recording)
    np.testing.assert_allclose(have.X_OE, want.X_OE, atol=1e-6)
    np.testing.assert_array_equal(have.objects, want.objects)
    assert len(have.X_OE) > 5
