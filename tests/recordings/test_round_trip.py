"""A demonstration written as people's files are, and imported again, is the same demonstration."""

from __future__ import annotations

import json
from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from drake_screw import RecordingError, Setup
from drake_screw.assembly.importing import read_recordings, write_library
from drake_screw.demonstrations import Recording
from drake_screw.demonstrations.look_summary import summarized
from drake_screw.recordings import Mapping
from drake_screw.screws import quaternion_from_rotation

LEFT = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
PANDA = tuple(f"panda_joint{i}" for i in range(1, 8))


def table(names: list[str], columns: list[list[str]], separator: str = ",", quote: str = "") -> str:
    header = separator.join(f"{quote}{name}{quote}" for name in names)
    rows = (separator.join(cells) for cells in zip(*columns, strict=True))
    return "\n".join([header, *rows]) + "\n"


def numbers(values: np.ndarray, form: str = "{:.12f}", decimal: str = ".") -> list[str]:
    return [form.format(v).replace(".", decimal) for v in values.tolist()]


def plain(t: np.ndarray, q: np.ndarray, names: tuple[str, ...] = LEFT, **how: str) -> str:
    decimal = how.pop("decimal", ".")
    columns = [numbers(t, "{:.6f}", decimal), *(numbers(x, decimal=decimal) for x in q.T)]
    return table(["time", *names], columns, **how)


def iso(t: np.ndarray, q: np.ndarray) -> str:
    began = datetime(2026, 3, 1, 10, 15)
    stamps = [(began + timedelta(seconds=s)).isoformat() + "Z" for s in np.round(t, 6).tolist()]
    return table(["stamp", *LEFT], [stamps, *(numbers(x) for x in q.T)])


def in_ns(t: np.ndarray, q: np.ndarray) -> str:
    stamps = [str(1_700_000_000_000_000_000 + int(s)) for s in np.round(t * 1e9)]
    return table(["stamp", *LEFT], [stamps, *(numbers(x) for x in q.T)])


def rostopic(t: np.ndarray, q: np.ndarray) -> str:
    m, n = q.shape
    stamps = [str(1_700_000_000_000_000_000 + int(s)) for s in np.round(t * 1e9)]
    order = [3, 0, 5, 1, 6, 2, 4]
    names = ["%time", "field.header.seq", "field.header.frame_id"]
    names += [f"field.name{i}" for i in range(n)] + [f"field.position{i}" for i in range(n)]
    names += [f"field.velocity{i}" for i in range(n)]
    columns = [stamps, [str(i) for i in range(m)], [""] * m]
    columns += [[LEFT[j]] * m for j in order] + [numbers(q[:, j]) for j in order]
    columns += [["0.0"] * m for _ in order]
    return table(names, columns)


def with_others(t: np.ndarray, q: np.ndarray) -> str:
    names = ["qd_0", "actual_q_3", "actual_q_0", "actual_q_1", "actual_q_2", "timestamp"]
    names += ["actual_q_6", "actual_q_5", "actual_q_4", *(f"actual_qd_{i}" for i in range(7))]
    columns = []
    for name in names:
        if name == "timestamp":
            columns.append(numbers(t, "{:.6f}"))
        elif name.startswith("actual_q_"):
            columns.append(numbers(q[:, int(name[-1])]))
        else:
            columns.append(["0.5"] * len(t))
    return table(names, columns)


WAYS: dict[str, Callable[[np.ndarray, np.ndarray], str]] = {
    "as Baxter's": plain,
    "tabs": lambda t, q: plain(t, q, separator="\t"),
    "semicolons and decimal commas": lambda t, q: plain(t, q, separator=";", decimal=","),
    "spaces": lambda t, q: plain(t, q, separator="  "),
    "quoted names": lambda t, q: plain(t, q, quote='"'),
    "names in a comment": lambda t, q: "# " + plain(t, q, separator=" "),
    "byte-order mark and CRLF": lambda t, q: "\ufeff" + plain(t, q).replace("\n", "\r\n"),
    "names with a prefix": lambda t, q: plain(t, q, tuple(f"robot/{name}" for name in LEFT)),
    "short names": lambda t, q: plain(t, q, tuple(name[5:] for name in LEFT)),
    "numbered names": lambda t, q: plain(t, q, tuple(f"q{i}" for i in range(7))),
    "numbered from 1": lambda t, q: plain(t, q, PANDA),
    "in order": lambda t, q: plain(t, q, ("base", "lift", "a", "b", "c", "d", "tip")),
    "without names": lambda t, q: plain(t, q).split("\n", 1)[1],
    "shuffled, with others": with_others,
    "degrees": lambda t, q: plain(t, np.rad2deg(q)),
    "a whole turn off": lambda t, q: plain(t, q + 2 * np.pi * np.eye(7)[6]),
    "a whole turn off from a row on": lambda t, q: plain(
        t, q + 2 * np.pi * np.outer(t > 5.0, np.eye(7)[6])
    ),
    "ISO stamps": iso,
    "ns since 1970": in_ns,
    "milliseconds": lambda t, q: plain(t * 1e3, q).replace("time", "time_ms", 1),
    "rostopic": rostopic,
}


@pytest.mark.parametrize("way", WAYS)
def test_the_same_guiding_poses_whatever_the_table(
    way: str, setup: Setup, demo: Recording, tmp_path: Path
) -> None:
    file = tmp_path / "demo_01.csv"
    file.write_text(WAYS[way](demo.t, demo.q), encoding="utf-8")
    mapping = Mapping(objects={"bowl": tuple(demo.X_WO[0].ravel().tolist())})
    if way == "without names":
        mapping = mapping.with_(time="column 1", time_unit="s")
    (found,) = read_recordings(file, setup, mapping)
    assert found.recording is not None
    same_demonstration(setup, found.recording, demo)


def same_demonstration(setup: Setup, found: Recording, demo: Recording) -> None:
    want, have = setup.learn(demo), setup.learn(found)
    np.testing.assert_allclose(have.X_OE, want.X_OE, atol=1e-6)
    np.testing.assert_array_equal(have.objects, want.objects)


def test_what_was_guessed_reads_the_file_again(
    setup: Setup, demo: Recording, tmp_path: Path
) -> None:
    file = tmp_path / "demo_01.csv"
    file.write_text(with_others(demo.t, demo.q))
    (first,) = read_recordings(file, setup, objects_needed=False)
    assert first.recording is None
    place = json.dumps(demo.X_WO[0].tolist())
    said = first.mapping.text() + f"objects:\n  bowl: {place}\n"
    (tmp_path / "recording.yaml").write_text(said)
    (again,) = read_recordings(file, setup)
    assert again.recording is not None
    same_demonstration(setup, again.recording, demo)
    assert ("joints", f"as said: {', '.join(f'actual_q_{i}' for i in range(7))}") in again.facts


def test_half_the_rate_and_a_rate_without_time(
    setup: Setup, demo: Recording, tmp_path: Path
) -> None:
    half = demo.t[::2], demo.q[::2]
    mapping = Mapping(objects={"bowl": tuple(demo.X_WO[0].ravel().tolist())})
    (tmp_path / "a.csv").write_text(plain(*half))
    (tmp_path / "b.csv").write_text(table(list(LEFT), [numbers(x) for x in half[1].T]))
    (a,) = read_recordings(tmp_path / "a.csv", setup, mapping)
    (b,) = read_recordings(tmp_path / "b.csv", setup, mapping.with_(rate=50.0))
    assert a.recording is not None
    assert b.recording is not None
    assert a.recording.duration == pytest.approx(demo.duration, abs=0.5)
    want = setup.learn(Recording("half", LEFT, *half, demo.X_WO))
    np.testing.assert_allclose(setup.learn(a.recording).X_OE, want.X_OE, atol=1e-6)
    np.testing.assert_allclose(setup.learn(b.recording).X_OE, want.X_OE, atol=1e-6)


HANDS = {
    "xyzw": ["x", "y", "z", "qx", "qy", "qz", "qw"],
    "ROS": [f"field.pose.position.{a}" for a in "xyz"]
    + [f"field.pose.orientation.{a}" for a in "xyzw"],
    "wxyz": ["a", "b", "c", "d", "e", "f", "g"],
    "matrix": [f"O_T_EE_{i}" for i in range(16)],
}


@pytest.mark.parametrize("way", HANDS)
def test_hand_poses_need_no_joints(way: str, setup: Setup, demo: Recording, tmp_path: Path) -> None:
    X = setup.workcell.arm.pose(demo.q)
    q = quaternion_from_rotation(X[:, :3, :3])
    values = np.column_stack([X[:, :3, 3], q if way == "wxyz" else np.roll(q, -1, axis=1)])
    if way == "matrix":
        values = np.swapaxes(X, 1, 2).reshape(-1, 16)
    names = ["time", *HANDS[way]]
    text = table(names, [numbers(demo.t, "{:.6f}"), *(numbers(v) for v in values.T)])
    (tmp_path / "demo_01.csv").write_text(text)
    mapping = Mapping(objects={"bowl": tuple(demo.X_WO[0].ravel().tolist())})
    if way == "wxyz":
        mapping = mapping.with_(hand=tuple(HANDS[way]))
        with pytest.raises(RecordingError, match="order of the quaternion's columns is not said"):
            read_recordings(tmp_path, setup, mapping)
        mapping = mapping.with_(quaternion="wxyz")
    (found,) = read_recordings(tmp_path, setup, mapping)
    assert found.recording is not None
    assert ("arm", "the arm reaches all 12 of the hand poses looked at") in found.facts
    (folder,) = write_library([found], tmp_path / "library")
    back = setup.recorder.read(folder)
    assert back.joint_names == ()
    (kept,) = setup.look(back).demonstration.fidelity  # type: ignore[union-attr]
    (want,) = setup.learn(demo).fidelity
    assert kept.guiding_poses == want.guiding_poses
    np.testing.assert_allclose(setup.learn(back).X_OE, setup.learn(found.recording).X_OE, atol=1e-6)
    assert "not recorded; the hand was" in dict(summarized(setup.look(back)).facts())["joints"]
