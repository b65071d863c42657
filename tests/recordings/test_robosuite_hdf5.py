"""Episodes of robosuite, written by h5py as robomimic does."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drake_screw import RecordingError, Setup
from drake_screw.assembly.importing import read_recordings
from drake_screw.demonstrations import Recording
from drake_screw.recordings import Mapping

h5py = pytest.importorskip("h5py")


def test_episodes_come_in_with_their_objects(setup: Setup, tmp_path: Path) -> None:
    q = np.tile([0.5, -0.2, -0.7, 1.5, 1.8, -0.9, -0.5], (50, 1))
    q[:, 0] += 0.01 * np.arange(50)
    with h5py.File(tmp_path / "demo.hdf5", "w") as file:
        data = file.create_group("data")
        data.attrs["env_args"] = json.dumps({"env_kwargs": {"control_freq": 20}})
        for name in ("demo_10", "demo_2"):
            obs = data.create_group(f"{name}/obs")
            obs["robot0_joint_pos"] = q
            obs["robot0_joint_vel"] = 0.0 * q
            obs["bowl_pos"] = np.tile([0.8, 0.5, -0.1], (50, 1))
            obs["bowl_quat"] = np.tile([0.0, 0.0, np.sin(0.25), np.cos(0.25)], (50, 1))
    found = read_recordings(tmp_path / "demo.hdf5", setup)
    assert [each.name for each in found] == ["demo_demo_2", "demo_demo_10"]
    recording = found[0].recording
    assert isinstance(recording, Recording)
    np.testing.assert_allclose(recording.q, q)
    np.testing.assert_allclose(recording.t, np.arange(50) / 20.0)
    np.testing.assert_allclose(
        setup.area.coordinates(recording.X_WO)[0], [0.8, 0.5, 0.5], atol=1e-12
    )
    (moved, _) = read_recordings(
        tmp_path / "demo.hdf5", setup, Mapping(objects={"bowl": (0.75, 0.5)})
    )
    assert moved.recording is not None
    assert moved.recording.X_WO[0, 0, 3] == 0.75


def test_other_hdf5_is_refused(setup: Setup, tmp_path: Path) -> None:
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["table"] = np.zeros(3)
    with pytest.raises(RecordingError, match="no group 'data'") as caught:
        read_recordings(tmp_path / "other.h5", setup)
    assert "Groups found: table" in str(caught.value)
    (tmp_path / "text.h5").write_text("no")
    with pytest.raises(RecordingError, match="cannot be read as HDF5"):
        read_recordings(tmp_path / "text.h5", setup)
