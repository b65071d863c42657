"""What other programs record: bags, data sets and trajectories, right at first and then broken."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore
from soak_breaking import BREAKERS, break_file, broken_bytes
from soak_values import BYTES, NUMBERS, WORDS, Random, pick, word

SETS = ("sets/bag", "sets/lerobot", "sets/demo.hdf5", "sets/joints.bag", "sets/plan.yaml")
JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
NAMES = tuple(f"{joint}_joint" for joint in JOINTS)
Q = np.array([1.14, -1.9, -1.97, 0.11, 0.64, -0.28]) + np.linspace(0.0, 0.3, 40)[:, None]
"""rad, what is recorded where nothing was exported."""


def import_of(name: str) -> list[str]:
    """The command that brings one of `SETS` in."""
    rest = ["--scenario", "task.yaml", "--output", "new", "--object", "bowl=0.55,0.0"]
    return ["import", name, *rest]


def make_data_sets(folder: Path, export: Callable[..., None]) -> None:
    """Make `SETS`; what drake-screw exports is exported from the run, the rest is written here."""
    (folder / "sets").mkdir()
    place = ("run", "--instance", "0.5", "0.1")
    for kind, name in zip(
        ("ros2-bag", "lerobot", "moveit-trajectory"), (*SETS[:2], SETS[4]), strict=True
    ):
        export("export", *place, "--format", kind, "--output", name)
    (folder / SETS[1] / "recording.yaml").write_text("angles: rad\n")
    _hdf5(folder / SETS[2])
    (folder / SETS[3]).write_bytes(_bag(folder / "made.bag", None))


def broken_set(rng: Random, name: str) -> None:
    """Break one of `SETS` where it lies: its bytes, one of its files, or what they hold."""
    place = Path(name)
    match place.suffix if rng.random() < 0.6 else "":
        case ".bag":
            place.write_bytes(_bag(Path("again.bag"), rng))
            return
        case ".hdf5":
            _break_hdf5(rng, place)
            return
    files = [f for f in sorted(place.rglob("*")) if f.is_file()] if place.is_dir() else [place]
    break_file(rng, pick(rng, files))


def _hdf5(file: Path) -> None:
    with h5py.File(file, "w") as made:
        data = made.create_group("data")
        data.attrs["env_args"] = json.dumps({"env_kwargs": {"control_freq": 20}})
        for name in ("demo_0", "demo_1"):
            obs = data.create_group(f"{name}/obs")
            obs["robot0_joint_pos"] = Q
            obs["bowl_pos"] = np.tile([0.55, 0.0, 0.0], (len(Q), 1))
            obs["bowl_quat"] = np.tile([0.0, 0.0, 0.0, 1.0], (len(Q), 1))


def _break_hdf5(rng: Random, file: Path) -> None:
    with h5py.File(file, "r+") as made:
        found: list[Any] = [made]
        made.visititems(lambda _, item: found.append(item))
        if rng.random() < 0.25:
            attributes = "", "[]", "[" * 100_000, '{"env_kwargs": []}', word(rng), 3, np.zeros(4)
            text = json.dumps({"env_kwargs": {"control_freq": word(rng)}})
            value = pick(rng, (*attributes, text, text, '{"env_kwargs": {"control_freq": [1]}}'))
            made["data"].attrs["env_args"] = value if not isinstance(value, str) else _plain(value)
            return
        item = pick(rng, found[1:])
        name, parent = item.name, item.parent
        other = _other(rng, np.asarray(item) if isinstance(item, h5py.Dataset) else Q)
        del made[name]
        if rng.random() < 0.8:
            last = name.rpartition("/")[2]
            put_at = last if rng.random() < 0.8 else _plain(word(rng)).replace("/", "").strip(".")
            if put_at and put_at not in parent:
                parent[put_at] = other


def _plain(text: str) -> str:
    return "".join(c for c in text if c.isprintable() and not "\ud800" <= c <= "\udfff")


def _other(rng: Random, array: Any) -> Any:
    """An array that is not what it should be."""
    ways: tuple[Callable[[], Any], ...] = (
        lambda: array[:0],
        lambda: array[:1],
        lambda: array[..., None],
        lambda: array.ravel(),
        lambda: array[:, :1] if array.ndim > 1 else array[:1],
        lambda: np.full(array.shape, np.nan),
        lambda: np.full(array.shape, 1e308),
        lambda: np.zeros(array.shape),
        lambda: np.full(array.shape, b"x"),
        lambda: np.float64(1.0),
        lambda: np.repeat(array, 2, axis=0)[1:],
        lambda: array * 57.3,
    )
    return pick(rng, ways)()


def _broken_parquet(rng: Random, data: bytes) -> bytes:
    """Columns of another type, length or name, or missing; or broken bytes."""
    if rng.random() < 0.3:
        return broken_bytes(rng, data)
    table = pq.read_table(io.BytesIO(data))
    at = int(rng.integers(table.num_columns))
    column, name = table.column(at).to_pylist(), table.column_names[at]
    ways: tuple[Callable[[], Any], ...] = (
        lambda: [None] * len(column),
        lambda: [*column[:-1], None],
        lambda: [_plain(word(rng))] * len(column),
        lambda: [[0.0] * (i % 3) for i in range(len(column))],
        lambda: [[float("nan")] * len(JOINTS)] * len(column),
        lambda: [[["x"]]] * len(column),
        lambda: list(reversed(column)),
        lambda: [10**18] * len(column),
        lambda: [-1e308] * len(column),
    )
    if rng.random() < 0.15:
        table = table.remove_column(at)
    elif rng.random() < 0.15:
        table = table.slice(0, int(rng.integers(3)))
    else:
        table = table.set_column(at, name, pa.array(pick(rng, ways)()))
    out = io.BytesIO()
    pq.write_table(table, out)
    return out.getvalue()


def _bag(file: Path, rng: Random | None) -> bytes:
    """A bag of ROS 1 with joint states; one message of it, or all, with something wrong."""
    store = get_typestore(Stores.ROS1_NOETIC)
    T = store.types
    kind = "sensor_msgs/msg/JointState"
    wrong = range(len(Q)) if rng is not None and rng.random() < 0.5 else [17 if rng else -1]
    way = int(rng.integers(10)) if rng is not None else -1
    with Writer(file) as writer:
        topic = _plain(word(rng)) or "/x" if rng is not None and way == 9 else "/joint_states"
        connection = writer.add_connection(topic, kind, typestore=store)
        for i, q in enumerate(Q):
            t, names, position, frame = 1_700_000_000.0 + 0.05 * i, list(NAMES), q, "base"
            if rng is not None and i in wrong:
                if way == 0:
                    names = []
                elif way == 1:
                    names = [_plain(pick(rng, WORDS)) for _ in names]
                elif way == 2:
                    names = [names[0]] * len(names)
                elif way == 3:
                    position = q[: int(rng.integers(len(q)))]
                elif way == 4:
                    position = np.full(len(q), pick(rng, (np.nan, np.inf, 1e308, -1e308, 1e-320)))
                elif way == 5:
                    t = pick(rng, (0.0, 1.0, 2e9, 1_700_000_000.0))
                elif way == 6:
                    frame = _plain(pick(rng, (*WORDS, *NUMBERS)))
                elif way == 7:
                    names, position = [*names, "finger"], np.append(q, 0.02)
                elif way == 8:
                    position = q * 57.3
            stamp = T["builtin_interfaces/msg/Time"](int(t), round(t % 1 * 1e9))
            header = T["std_msgs/msg/Header"](seq=i, stamp=stamp, frame_id=frame)
            empty = np.zeros(0)
            message = T[kind](header, names, np.array(position), empty, empty)
            raw = store.serialize_ros1(message, kind)
            writer.write(connection, round(max(t, 1.0) * 1e9), raw)
    data = file.read_bytes()
    file.unlink()
    return data


def _broken_hdf5_bytes(rng: Random, data: bytes) -> bytes:
    return broken_bytes(rng, data) if rng.random() < 0.7 else data + pick(rng, BYTES) * 100


BREAKERS[".parquet"] = _broken_parquet
BREAKERS[".hdf5"] = _broken_hdf5_bytes
