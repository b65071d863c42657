"""Plans exported in the formats of other programs, imported again and read by those programs."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from drake_screw import RecordingError, Setup
from drake_screw.acquisition import Suggestion
from drake_screw.assembly.importing import read_recordings
from drake_screw.demonstrations import Recording
from drake_screw.errors import PluginError, RunDirectoryError
from drake_screw.execution import TimedPlan, TimeLimits
from drake_screw.execution.setting import PERIOD
from drake_screw.recordings import Mapping
from drake_screw.runs.run import new_run, open_run
from drake_screw.runs.trajectory import write_trajectory
from drake_screw.scenario.loader import load_scenario

PLACE = (0.85, 0.3, 0.4)
FORMATS = {"ros2-bag": "rosbags", "lerobot": "pyarrow", "moveit-trajectory": "yaml"}
"""And what each is written with."""
FOLDERS = ("ros2-bag", "lerobot")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that has one demonstration by the simulated teacher; the bowl may be turned."""
    changes = ["regions.grid={x: 1}", "objects.0.symmetry=null", "objects.0.yaw=[-0.5, 0.5]"]
    scenario = load_scenario("pouring", changes)
    run = new_run(scenario, tmp_path_factory.mktemp("runs") / "run")
    at = np.array([PLACE])
    lesson = run.setup.teacher.demonstrate(
        Suggestion(0, at), number=0, used=(), rng=np.random.default_rng(1)
    )
    assert lesson.recording is not None
    run.directory.add_demonstration(
        0, replace(lesson.recording, name="shown"), "", scenario.robot.parked
    )
    return run.directory.path


@pytest.fixture(scope="module")
def setup(run: Path) -> Setup:
    return open_run(run).setup


@pytest.fixture(scope="module")
def timed(run: Path) -> TimedPlan:
    opened = open_run(run)
    return opened.setup.plan(opened.demonstrations, np.array([PLACE]), most=1).timed


@pytest.fixture(scope="module")
def exported(run: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Exports the plan in a format, once; returns the file or folder."""
    folder, written = tmp_path_factory.mktemp("exports"), {}

    def export(format: str) -> Path:
        pytest.importorskip(FORMATS[format])
        if format not in written:
            written[format] = folder / (format if format in FOLDERS else f"{format}.yaml")
            write_trajectory(run, PLACE, format, written[format])
        return written[format]

    return export


def same_motion(found: Recording, timed: TimedPlan, t: np.ndarray, precision: float) -> None:
    """The import leaves one sample of a still head and tail; all between are the plan's."""
    q, _ = timed.path(t)
    away = np.abs(q[:, None] - found.q[None, 1:-1]).max(axis=-1)
    rows = np.argmin(away, axis=0)
    assert away.min(axis=0).max() < precision
    np.testing.assert_array_equal(np.diff(rows), 1)
    assert len(rows) > 0.8 * len(t)
    np.testing.assert_allclose(np.diff(found.t[1:-1]), np.diff(t[rows]), atol=2e-6)
    np.testing.assert_allclose(found.q[[0, -1]], q[[0, -1]], atol=3e-3)


def even(timed: TimedPlan) -> np.ndarray:
    return PERIOD * np.arange(np.ceil(timed.duration / PERIOD) + 1)


def test_a_bag_comes_back_with_its_objects(
    exported: Callable[[str], Path], setup: Setup, timed: TimedPlan
) -> None:
    (found,) = read_recordings(exported("ros2-bag"), setup)
    assert found.recording is not None
    same_motion(found.recording, timed, timed.sampled(PERIOD)[0], 1e-9)
    want = setup.area.X_WO(np.array([[PLACE]]))[0]
    np.testing.assert_allclose(found.recording.X_WO, want, atol=1e-9)
    assert "by frame:bowl" in dict(found.facts)["object"]


def test_a_dataset_comes_back_with_its_objects(
    exported: Callable[[str], Path], setup: Setup, timed: TimedPlan
) -> None:
    """Joint angles and time are float32 there."""
    (found,) = read_recordings(exported("lerobot"), setup)
    assert found.recording is not None
    same_motion(found.recording, timed, even(timed), 2.0 * np.pi * 2.0**-23)
    want = setup.area.X_WO(np.array([[PLACE]]))[0]
    np.testing.assert_allclose(found.recording.X_WO, want, atol=1e-9)


@pytest.mark.parametrize("format", ["moveit-trajectory", "ros-trajectory"])
def test_a_trajectory_comes_back(
    format: str, run: Path, setup: Setup, timed: TimedPlan, tmp_path: Path
) -> None:
    write_trajectory(run, PLACE, format, tmp_path / "plan.yaml")
    mapping = Mapping(objects={"bowl": PLACE})
    (found,) = read_recordings(tmp_path / "plan.yaml", setup, mapping)
    assert found.recording is not None
    assert found.name == "plan"
    same_motion(found.recording, timed, timed.sampled(PERIOD)[0], 1e-8)
    with pytest.raises(RecordingError, match="where was the bowl"):
        read_recordings(tmp_path / "plan.yaml", setup)


def test_a_bag_is_one_to_rosbags(exported: Callable[[str], Path], timed: TimedPlan) -> None:
    highlevel = pytest.importorskip("rosbags.highlevel")
    t, q, v = timed.sampled(PERIOD)
    with highlevel.AnyReader([exported("ros2-bag")]) as reader:
        kinds = {c.topic: c.msgtype for c in reader.connections}
        assert kinds == {
            "bowl": "geometry_msgs/msg/PoseStamped",
            "/joint_states": "sensor_msgs/msg/JointState",
        }
        digests = {c.msgtype: c.digest for c in reader.connections}
        # As ROS 2 publishes it for this message.
        assert digests["sensor_msgs/msg/JointState"] == (
            "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"
        )
        messages = [
            (c.topic, stamp, reader.deserialize(raw, c.msgtype))
            for c, stamp, raw in reader.messages()
        ]
    states = [(stamp, message) for topic, stamp, message in messages if topic == "/joint_states"]
    assert [stamp for stamp, _ in states] == np.rint(1e9 * t).astype(int).tolist()
    for stamp, message in states:
        assert 10**9 * message.header.stamp.sec + message.header.stamp.nanosec == stamp
        assert message.name == states[0][1].name
        assert len(message.effort) == 0
    np.testing.assert_array_equal([m.position for _, m in states], q)
    np.testing.assert_array_equal([m.velocity for _, m in states], v)
    ((stamp, pose),) = [(s, message) for topic, s, message in messages if topic == "bowl"]
    assert (stamp, pose.header.frame_id) == (0, "base")
    p, r = pose.pose.position, pose.pose.orientation
    np.testing.assert_allclose([p.x, p.y], PLACE[:2])
    np.testing.assert_allclose([r.x, r.y, r.z, r.w], [0.0, 0.0, np.sin(0.2), np.cos(0.2)])


def test_the_metadata_of_a_bag_says_what_is_in_it(exported: Callable[[str], Path]) -> None:
    bag = exported("ros2-bag")
    info = yaml.safe_load((bag / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert info["storage_identifier"] == "mcap"
    assert [bag / name for name in info["relative_file_paths"]] == list(bag.glob("*.mcap"))
    topics = {each["topic_metadata"]["name"]: each for each in info["topics_with_message_count"]}
    assert topics["bowl"]["message_count"] == 1
    (kept,) = yaml.safe_load(topics["bowl"]["topic_metadata"]["offered_qos_profiles"])
    assert kept["durability"] == 1  # transient local


def test_a_trajectory_has_the_fields_of_the_message(exported: Callable[[str], Path]) -> None:
    typesys = pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    definition = (
        "trajectory_msgs/JointTrajectory joint_trajectory\n"
        "trajectory_msgs/MultiDOFJointTrajectory multi_dof_joint_trajectory\n"
    )
    kind = "moveit_msgs/msg/RobotTrajectory"
    store.register(typesys.get_types_from_msg(definition, kind))
    made = as_message(store, kind, yaml.safe_load(exported("moveit-trajectory").read_text()))
    raw = store.serialize_cdr(made, kind)
    back = store.deserialize_cdr(raw, kind)
    assert back.joint_trajectory.header.frame_id == "base"
    assert len(back.joint_trajectory.points) > 100
    assert list(back.multi_dof_joint_trajectory.points) == []


def as_message(store: Any, kind: str, data: dict[str, Any]) -> Any:
    """A message of plain data that has its fields, all of them and no others."""
    fields = store.fielddefs[kind][1]
    assert set(data) == {name for name, _ in fields}

    def value(described: Any, given: Any) -> Any:
        node, inner = described
        if node.name == "NAME":
            return as_message(store, inner, given)
        if node.name == "BASE":
            expected = {"string": str, "float64": float}.get(inner[0], int)
            assert isinstance(given, expected), (inner, given)
            return given
        (item, _) = inner
        values = [value(item, each) for each in given]
        return np.array(values, dtype=float) if item[1][0] == "float64" else values

    return store.types[kind](**{name: value(described, data[name]) for name, described in fields})


def test_accelerations_are_those_of_the_velocities(
    exported: Callable[[str], Path], timed: TimedPlan
) -> None:
    message = yaml.safe_load(exported("moveit-trajectory").read_text())
    points = message["joint_trajectory"]["points"]
    t, q, v = timed.sampled(PERIOD)
    np.testing.assert_allclose([p["positions"] for p in points], q, atol=1e-8)
    np.testing.assert_allclose([p["velocities"] for p in points], v, atol=1e-8)
    a = np.array([p["accelerations"] for p in points])
    gained = np.diff(t)[:, None] * (a[1:] + a[:-1]) / 2.0
    np.testing.assert_allclose(np.cumsum(gained, axis=0), v[1:] - v[0], atol=2e-3)
    assert 0.5 < np.abs(a).max() < 1.02 * TimeLimits().acceleration
    np.testing.assert_array_equal(a[[0, -1]], 0.0)


def test_a_dataset_is_one_to_pyarrow(exported: Callable[[str], Path], timed: TimedPlan) -> None:
    pa = pytest.importorskip("pyarrow")
    import pyarrow.parquet as pq

    folder = exported("lerobot")
    info = json.loads((folder / "meta" / "info.json").read_text())
    assert (info["codebase_version"], info["fps"], info["robot_type"]) == ("v2.1", 100, "baxter")
    file = folder / info["data_path"].format(episode_chunk=0, episode_index=0)
    frames = pq.read_table(file)
    m = info["total_frames"]
    assert len(frames) == m
    assert frames.column_names == list(info["features"])
    for name, feature in info["features"].items():
        kind = frames.schema.field(name).type
        if name in ("observation.state", "action"):
            assert kind == pa.list_(pa.float32(), 7)
            assert feature["units"] == ["rad"] * 7
            assert feature["names"][0] == "left_s0"
        else:
            assert str(kind).replace("float", "float32") == feature["dtype"]
        assert feature["shape"] == [7 if pa.types.is_fixed_size_list(kind) else 1]
    t = frames["timestamp"].to_numpy()
    np.testing.assert_allclose(np.diff(t), 1.0 / info["fps"], atol=1e-4)  # LeRobot's tolerance
    state, action = (np.array(frames[x].to_pylist()) for x in ("observation.state", "action"))
    np.testing.assert_allclose(state, timed.path(even(timed))[0], atol=1e-6)
    np.testing.assert_array_equal(action[:-1], state[1:])
    for name, want in (("frame_index", np.arange(m)), ("index", np.arange(m))):
        np.testing.assert_array_equal(frames[name].to_numpy(), want)
    for name in ("episode_index", "task_index"):
        np.testing.assert_array_equal(frames[name].to_numpy(), 0)
    (task,), (episode,), (stats,) = (
        [json.loads(line) for line in (folder / "meta" / name).read_text().splitlines()]
        for name in ("tasks.jsonl", "episodes.jsonl", "episodes_stats.jsonl")
    )
    assert task == {"task_index": 0, "task": "Baxter's left arm pours into a bowl"}
    assert episode == {"episode_index": 0, "tasks": [task["task"]], "length": m}
    assert set(stats["stats"]) == set(info["features"])
    np.testing.assert_allclose(stats["stats"]["action"]["max"], action.max(axis=0))
    assert stats["stats"]["timestamp"]["count"] == [m]


@pytest.mark.parametrize("format", FOLDERS)
def test_an_earlier_export_is_replaced_and_nothing_else_is(
    format: str, run: Path, tmp_path: Path
) -> None:
    pytest.importorskip(FORMATS[format])
    output = tmp_path / "out"
    for _ in range(2):
        write_trajectory(run, PLACE, format, output)
        assert list(tmp_path.iterdir()) == [output]
    (output / "notes.txt").write_text("mine")
    with pytest.raises(RunDirectoryError, match=r"holds other files, notes\.txt for one"):
        write_trajectory(run, PLACE, format, output)
    assert (output / "notes.txt").read_text() == "mine"
    (tmp_path / "file").write_text("mine")
    for taken in (tmp_path / "file", tmp_path / "missing" / "out"):
        with pytest.raises(RunDirectoryError, match="cannot be written"):
            write_trajectory(run, PLACE, format, taken)
    assert (tmp_path / "file").read_text() == "mine"
    assert sorted(item.name for item in tmp_path.iterdir()) == ["file", "out"]


@pytest.mark.parametrize(("format", "extra"), [("ros2-bag", "ros"), ("lerobot", "lerobot")])
def test_without_its_library_the_extra_is_named(
    format: str, extra: str, run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("rosbags.rosbag2", "pyarrow"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(PluginError, match=f"{format} needs") as caught:
        write_trajectory(run, PLACE, format, tmp_path / "out")
    assert f"drake-screw[{extra}]" in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_an_exporter_of_ones_own_may_write_a_folder_and_ask_for_the_objects(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "my_exporter.py").write_text(
        "def places(plan, arm, setting):\n"
        "    text = [f'{name} {X[0, 3]:.2f} {setting.base}' for name, X in setting.X_WO.items()]\n"
        "    return {'deep/places.txt': text[0].encode()}\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    write_trajectory(run, PLACE, "my_exporter:places", tmp_path / "out")
    assert (tmp_path / "out" / "deep" / "places.txt").read_text() == "bowl 0.85 base"
