"""Whatever is wrong with another program's file, one message says which and what."""

from __future__ import annotations

import io
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drake_screw import RecordingError, Setup
from drake_screw.assembly.importing import read_recordings
from drake_screw.recordings import Mapping
from tests.recordings.bags import LEFT, bag, motion

h5py = pytest.importorskip("h5py")
pa = pytest.importorskip("pyarrow")
pytest.importorskip("rosbags")
NEAR = Mapping(objects={"bowl": (0.8, 0.5)}, angles="rad")


def refused(source: Path, setup: Setup, message: str, mapping: Mapping = NEAR) -> None:
    with pytest.raises(RecordingError, match=message) as caught:
        read_recordings(source, setup, mapping)
    assert caught.value.file is not None
    assert str(source) in str(caught.value)


@pytest.fixture(scope="module")
def bags(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One of each kind."""
    folder = tmp_path_factory.mktemp("bags")
    t, q = motion()
    for kind in ("bag", "db3", "mcap"):
        with bag(folder / ("demo.bag" if kind == "bag" else kind), kind) as write:
            for s, row in zip(t.tolist(), q, strict=True):
                write("/joint_states", s, "joints", LEFT, row)
    return folder


@pytest.mark.parametrize("name", ["demo.bag", "db3", "mcap"])
def test_no_byte_of_a_bag_leads_to_more_than_a_message(
    name: str, bags: Path, setup: Setup, tmp_path: Path
) -> None:
    rng = np.random.default_rng(len(name))
    read = 0
    for i in range(60):
        place = tmp_path / f"{i}_{name}"
        if name == "demo.bag":
            shutil.copyfile(bags / name, place)
            broken = place
        else:
            shutil.copytree(bags / name, place)
            broken = next(place.glob(f"*.{name}"))
        broken.write_bytes(_broken(rng, broken.read_bytes(), i % 4))
        read += _read_or_refused(place, setup)
    assert read < 60


def _broken(rng: np.random.Generator, data: bytes, way: int) -> bytes:
    at, end = np.sort(rng.integers(0, len(data), 2)).tolist()
    match way:
        case 0:
            return data[:at]
        case 1:
            return data[:at] + data[end:]
        case 2:
            return data[:at] + bytes(40) + data[at + 40 :]
        case _:
            return data[:at] + b"\xff" * 9 + data[at + 9 :]


def _read_or_refused(place: Path, setup: Setup) -> bool:
    try:
        read_recordings(place, setup, NEAR)
    except RecordingError as error:
        if str(place) not in str(error):
            raise
        return False
    return True


def _set(path: Path, change: Callable[[Any], None]) -> Path:
    """An episode of robosuite with something wrong."""
    _, q = motion()
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["env_args"] = json.dumps({"env_kwargs": {"control_freq": 20}})
        obs = data.create_group("demo_0/obs")
        obs["robot0_joint_pos"] = q
        obs["bowl_pos"] = np.tile([0.8, 0.5, -0.1], (50, 1))
        obs["bowl_quat"] = np.tile([0.0, 0.0, 0.0, 1.0], (50, 1))
        change(file)
    return path


def put(name: str, value: Any) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        del file[name]
        if value is not None:
            file[name] = value

    return change


def rate(text: Any) -> Callable[[Any], None]:
    return lambda file: file["data"].attrs.__setitem__("env_args", text)


OBS = "data/demo_0/obs"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put("data", np.zeros(3)), "no group 'data'"),
        (put("data/demo_0", 3.0), "has no observations"),
        (put(OBS, np.zeros(4)), "has no observations"),
        (put(f"{OBS}/robot0_joint_pos", np.zeros(4)), r"joint_pos is not a table of numbers"),
        (put(f"{OBS}/robot0_joint_pos", np.full((9, 7), b"x")), "not a table of numbers"),
        (put(f"{OBS}/bowl_pos", np.zeros((50, 2))), "bowl_pos has 2 columns"),
        (put(f"{OBS}/bowl_pos", np.zeros((0, 3))), "bowl_pos is not a table of numbers"),
        (put(f"{OBS}/bowl_quat", np.zeros((50, 4))), "are no pose"),
        (put(f"{OBS}/bowl_pos", np.full((50, 3), 1e308)), "are no pose"),
        (put(f"{OBS}/robot0_joint_pos", np.full((50, 7), 1e308)), "."),
        *[(rate(text), "no column of time|no time|rate") for text in ("", "[]", "[" * 9999, 3)],
        (rate('{"env_kwargs": []}'), "no column of time|no time|rate"),
        (rate('{"env_kwargs": {"control_freq": "+"}}'), "no column of time|no time|rate"),
        (rate('{"env_kwargs": {"control_freq": -1}}'), "no column of time|no time|rate"),
    ],
)
def test_what_an_episode_of_robosuite_may_hold(
    change: Callable[[Any], None], message: str, setup: Setup, tmp_path: Path
) -> None:
    path = _set(tmp_path / "demo.hdf5", change)
    with np.errstate(all="raise"):
        refused(path, setup, message, Mapping())


def test_a_damaged_hdf5_is_a_message(setup: Setup, tmp_path: Path) -> None:
    whole = _set(tmp_path / "demo.hdf5", lambda _: None).read_bytes()
    rng, read = np.random.default_rng(0), 0
    for i in range(60):
        at = int(rng.integers(0, 4000))
        path = tmp_path / f"{i}.hdf5"
        path.write_bytes(whole[:at] + rng.bytes(30) + whole[at + 30 :])
        read += _read_or_refused(path, setup)
    assert read < 60


STATE = "observation.state"


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({STATE: [[0.0] * 7] * 39 + [None]}, "cannot be read as frames"),
        ({STATE: [[0.0] * (i % 3) for i in range(40)]}, "cannot be read as frames"),
        ({STATE: ["x"] * 40}, "cannot be read as frames"),
        ({STATE: [1.0] * 40}, "is not a list of numbers"),
        ({"episode_index": ["x"] * 40}, "cannot be read as frames"),
        ({"episode_index": [None] * 40}, "cannot be read as frames"),
        ({"timestamp": ["now"] * 40}, "cannot be read as frames"),
        ({"timestamp": None}, "cannot be read as frames"),
        ({"timestamp": [[0.0] * 7] * 40}, "timestamp is not a number in each row"),
        ({"episode_index": [[0] * 7] * 40}, "episode_index is not a number in each row"),
        ({}, None),
    ],
)
@pytest.mark.parametrize("info", ["{}", "[]", "3", '{"features": {"observation.state": 3}}'])
def test_what_frames_of_lerobot_may_hold(
    columns: dict[str, Any], message: str | None, info: str, setup: Setup, tmp_path: Path
) -> None:
    import pyarrow.parquet as pq

    q = motion()[1][:40]
    frames: dict[str, Any] = {
        STATE: q.tolist(),
        "timestamp": (np.arange(40) / 30.0).tolist(),
        "episode_index": [0] * 40,
    }
    frames |= columns
    for folder in ("meta", "data"):
        (tmp_path / folder).mkdir()
    (tmp_path / "meta" / "info.json").write_text(info)
    table = pa.table({name: column for name, column in frames.items() if column is not None})
    out = io.BytesIO()
    pq.write_table(table, out)
    (tmp_path / "data" / "a.parquet").write_bytes(out.getvalue())
    if message is not None:
        refused(tmp_path, setup, message)
        return
    (found,) = read_recordings(tmp_path, setup, NEAR)
    assert found.recording is not None
    np.testing.assert_allclose(found.recording.q, q)


def test_episodes_of_one_number_with_other_widths_are_refused(setup: Setup, tmp_path: Path) -> None:
    import pyarrow.parquet as pq

    for folder in ("meta", "data"):
        (tmp_path / folder).mkdir()
    (tmp_path / "meta" / "info.json").write_text("{}")
    for name, width in (("a", 7), ("b", 6)):
        time = [0.0, 0.1]
        frames = {STATE: [[0.1] * width] * 2, "timestamp": time, "episode_index": [0, 0]}
        pq.write_table(pa.table(frames), tmp_path / "data" / f"{name}.parquet")
    refused(tmp_path, setup, "6 numbers in some rows of episode 0 and 7 in others")
