"""LeRobot datasets, their parquet files written by pyarrow."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drake_screw import RecordingError, Setup
from drake_screw.assembly.importing import read_recordings
from drake_screw.recordings import Mapping

pa = pytest.importorskip("pyarrow")
LEFT = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
NEAR = Mapping(objects={"bowl": (0.8, 0.5)})


def dataset(folder: Path, files: list[list[int]], ends: np.ndarray | None = None) -> np.ndarray:
    """Episodes of 40 frames at 30 Hz in degrees, so many in each file; returns q (40, 7) rad.

    In per cent instead where the ends (7, 2) of the joints' ends are given.
    """
    import pyarrow.parquet as pq

    q = np.tile([0.5, -0.2, -0.7, 1.5, 1.8, -0.9, -0.5], (40, 1))
    q[:, 0] += 0.01 * np.arange(40)
    order = [3, 0, 1, 2, 4, 6, 5]
    (folder / "meta").mkdir(parents=True)
    names = [f"{LEFT[j]}.pos" for j in order]
    info = {"fps": 30, "features": {"observation.state": {"names": names}}}
    (folder / "meta" / "info.json").write_text(json.dumps(info))
    (folder / "data" / "chunk-000").mkdir(parents=True)
    for i, episodes in enumerate(files):
        state = np.rad2deg(q)
        if ends is not None:
            state = (q - ends[:, 0]) / (ends[:, 1] - ends[:, 0]) * 200.0 - 100.0
        state = np.tile(state[:, order], (len(episodes), 1))
        frames = {
            "observation.state": state.tolist(),
            "timestamp": np.tile(np.arange(40) / 30.0, len(episodes)).astype(np.float32),
            "episode_index": np.repeat(episodes, 40),
        }
        pq.write_table(pa.table(frames), folder / "data" / "chunk-000" / f"file-{i:03d}.parquet")
    return q


@pytest.mark.parametrize("files", [[[0], [1]], [[0, 1]]], ids=["version 2", "version 3"])
def test_a_recording_for_each_episode(files: list[list[int]], setup: Setup, tmp_path: Path) -> None:
    q = dataset(tmp_path / "set", files)
    found = read_recordings(tmp_path / "set", setup, NEAR.with_(angles="deg"))
    assert [each.name for each in found] == ["set_000000", "set_000001"]
    for each in found:
        assert each.recording is not None
        np.testing.assert_allclose(each.recording.q, q, atol=1e-9)
        np.testing.assert_allclose(each.recording.t, np.arange(40) / 30.0, atol=1e-6)


def test_the_unit_is_never_guessed(setup: Setup, tmp_path: Path) -> None:
    dataset(tmp_path / "set", [[0]])
    with pytest.raises(RecordingError, match="unit of the joint angles is not said") as caught:
        read_recordings(tmp_path / "set", setup, NEAR)
    assert "angles: rad, angles: deg or angles: percent" in str(caught.value)


def test_other_folders_are_none(setup: Setup, tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="not a dataset of LeRobot"):
        read_recordings(tmp_path, setup, NEAR.with_(format="lerobot"))


def test_per_cent_are_of_the_models_limits_or_of_what_is_said(setup: Setup, tmp_path: Path) -> None:
    arm = setup.workcell.arm
    ends = np.column_stack([arm.lower, arm.upper])
    q = dataset(tmp_path / "limits", [[0]], ends)
    (found,) = read_recordings(tmp_path / "limits", setup, NEAR.with_(angles="percent"))
    assert found.recording is not None
    np.testing.assert_allclose(found.recording.q, q, atol=1e-6)
    assert "of all that is taken to be the model's limits" in dict(found.facts)["angles"]
    ends[0], ends[3] = (-1.0, 2.0), (2.5, 0.5)
    q = dataset(tmp_path / "said", [[0]], ends)
    ends = {LEFT[0]: (-1.0, 2.0), LEFT[3]: (2.5, 0.5)}
    mapping = NEAR.with_(angles="percent", ends=ends)
    (found,) = read_recordings(tmp_path / "said", setup, mapping)
    assert found.recording is not None
    np.testing.assert_allclose(found.recording.q, q, atol=1e-6)
    assert f"of {LEFT[1]}, {LEFT[2]}, {LEFT[4]}, " in dict(found.facts)["angles"]
    assert found.mapping.ends == ends


@pytest.mark.parametrize(
    ("changes", "message", "remedy"),
    [
        ({"angles": "percent"}, "angles: percent, but there is a", "Say angles: deg"),
        (
            {"angles": "percent", "ends": {"left_s9": (0.0, 1.0)}},
            "ends: 'left_s9' is no joint of the arm",
            "Did you mean",
        ),
        ({"angles": "deg", "ends": {LEFT[0]: (0.0, 1.0)}}, "not in per cent", "angles: percent"),
    ],
)
def test_per_cent_that_cannot_be(
    changes: dict, message: str, remedy: str, setup: Setup, tmp_path: Path
) -> None:
    """The data are degrees, up to 103."""
    ends = np.deg2rad(np.tile([-80.0, 80.0], (7, 1)))
    dataset(tmp_path / "set", [[0]], ends)
    with pytest.raises(RecordingError, match=message) as caught:
        read_recordings(tmp_path / "set", setup, NEAR.with_(**changes))
    assert remedy in str(caught.value)
