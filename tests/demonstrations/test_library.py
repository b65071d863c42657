"""Recordings on disk: what is written is read back, and what is wrong is named with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from drake_screw.demonstrations import Recording, read_library, read_recording, write_recording
from drake_screw.demonstrations.library import read_object_poses
from drake_screw.errors import RecordingError
from drake_screw.screws import exp

NAMES = ("shoulder", "elbow")
LOWER, UPPER = np.array([-1.0, -2.0]), np.array([1.0, 2.0])
LEFT = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
RIGHT = tuple(f"right_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
BAXTER_HEADER = (
    "time,left_s0,left_s1,left_e0,left_e1,left_w0,left_w1,left_w2,left_gripper,"
    "right_s0,right_s1,right_e0,right_e1,right_w0,right_w1,right_w2,right_gripper"
)
JOINTS = "time,shoulder,elbow\n0.10,0.0,0.0\n0.11,0.1,0.2\n0.12,0.2,0.4\n"
POSES = "1,0,0,0.8\n0,1,0,-0.1\n0,0,1,0.05\n0,0,0,1\n"


def write(folder: Path, joints: str = JOINTS, poses: str = POSES) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "joint_angles.csv").write_bytes(joints.encode())
    (folder / "object_poses.csv").write_bytes(poses.encode())
    return folder


def read(folder: Path, objects: int | None = None) -> Recording:
    return read_recording(folder, NAMES, LOWER, UPPER, objects=objects)


def refused(folder: Path, objects: int | None = None) -> RecordingError:
    with pytest.raises(RecordingError) as caught:
        read(folder, objects)
    return caught.value


def test_reads_what_is_there(tmp_path: Path) -> None:
    recording = read(write(tmp_path / "demo_01"), objects=1)
    assert recording.name == "demo_01"
    assert recording.source == (tmp_path / "demo_01").resolve()
    assert recording.joint_names == NAMES
    np.testing.assert_allclose(recording.t, [0.0, 0.01, 0.02], atol=1e-12)
    np.testing.assert_array_equal(recording.q, [[0.0, 0.0], [0.1, 0.2], [0.2, 0.4]])
    np.testing.assert_array_equal(recording.X_WO[0, :3, 3], [0.8, -0.1, 0.05])
    assert recording.region_of_interest is None


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "\ufeff" + text,
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", "\n\n") + "\n  \n",
        lambda text: text.rstrip("\n"),
        lambda text: text.replace(",", " , "),
        lambda text: "\ufeff" + text.replace("\n", "\r\n") + "\r\n",
        lambda text: "\n".join(
            ", ".join(f'"{cell}"' for cell in line.split(",")) for line in text.split()
        ),
    ],
    ids=["BOM", "CRLF", "blank lines", "no last newline", "spaces", "BOM and CRLF", "quotes"],
)
def test_ways_of_writing_a_csv(tmp_path: Path, change: object) -> None:
    plain = read(write(tmp_path / "a"))
    other = read(write(tmp_path / "b", change(JOINTS), change(POSES)))  # type: ignore[operator]
    np.testing.assert_array_equal(plain.q, other.q)
    np.testing.assert_array_equal(plain.t, other.t)
    np.testing.assert_array_equal(plain.X_WO, other.X_WO)


def test_columns_are_found_by_name_whatever_their_order(tmp_path: Path) -> None:
    text = "grip,elbow,time,other,shoulder\n9,0.5,1.0,x,0.1\n9,0.6,1.1,y,0.2\n"
    recording = read(write(tmp_path / "demo", text))
    np.testing.assert_array_equal(recording.q, [[0.1, 0.5], [0.2, 0.6]])


def test_names_with_commas_and_quotes_are_written_and_read_back(tmp_path: Path) -> None:
    names = ("shoulder, left", 'the "elbow"')
    t, q = np.array([0.0, 0.1]), np.array([[0.0, 0.0], [0.1, 0.2]])
    write_recording(Recording("demo", names, t, q, np.eye(4)[None]), tmp_path)
    recording = read_recording(tmp_path, names, LOWER, UPPER)
    np.testing.assert_array_equal(recording.q, q)


def test_folders_may_be_given_as_text(tmp_path: Path) -> None:
    recording = read(write(tmp_path / "library" / "demo_01"))
    write_recording(recording, str(tmp_path / "library" / "demo_02"))
    library = str(tmp_path / "library")
    assert [r.name for r in read_library(library, NAMES, LOWER, UPPER)] == ["demo_01", "demo_02"]


def test_missing_column_names_the_nearest(tmp_path: Path) -> None:
    error = refused(write(tmp_path / "demo", JOINTS.replace("shoulder", "sholder")))
    assert error.file == tmp_path / "demo" / "joint_angles.csv"
    assert error.line == 1
    assert error.message == "no column 'shoulder'"
    assert "Did you mean 'sholder'?" in str(error)
    assert "Columns found: time, sholder, elbow" in str(error)


def test_columns_of_another_robot(tmp_path: Path) -> None:
    write(tmp_path / "demo")
    with pytest.raises(RecordingError, match="no column 'left_s0'") as caught:
        read_recording(tmp_path / "demo", LEFT, -3 * np.ones(7), 3 * np.ones(7))
    assert "Columns found: time, shoulder, elbow" in str(caught.value)


def test_no_time_column(tmp_path: Path) -> None:
    assert "no column 'time'" in str(refused(write(tmp_path / "demo", "shoulder,elbow\n0,0\n")))


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ("", "no column 'time'", 1),
        ("time,shoulder,elbow\n", "0 samples", None),
        ("time,shoulder,elbow\n0.1,0.0,0.0\n", "1 sample;", None),
        (JOINTS + "0.13,0.3\n", "2 cells where the header has 3", 5),
        (JOINTS + "0.13,0.3,0.6,\n", "4 cells where the header has 3", 5),
        (JOINTS + "0.13,0.3,\n", "not a number: ''", 5),
        (JOINTS + ",,\n", "not a number: ''", 5),
        (JOINTS + '0.13,"0.3,0.6\n', "not CSV: unexpected end of data", 5),
        (JOINTS + "\n\n0.13,abc,0.6\n", "not a number: 'abc'", 7),
        (JOINTS + "\n0.13,nan,0.6\n", "not a finite number: shoulder", 6),
        (JOINTS + "0.115,0.3,0.6\n", "time runs backwards", 5),
        (JOINTS + "\n0.13,0.3,2.1\n", "elbow is at 2.1000, outside its limits", 6),
        (JOINTS + "0.13,0.3,35\n", "degrees", 5),
        (JOINTS + "0.9,0.5,0.6\n", "0.78 s are missing", 5),
    ],
)
def test_faults_in_the_joint_angles_are_named_with_file_and_line(
    tmp_path: Path, text: str, message: str, line: int | None
) -> None:
    error = refused(write(tmp_path / "demo", text))
    assert message in error.message
    assert error.file == tmp_path / "demo" / "joint_angles.csv"
    assert error.line == line


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ("", "0 rows", None),
        (POSES + "1,0,0,0\n", "5 rows", None),
        (POSES.replace("0,0,0,1", "0,0,0,2"), "every fourth row must be 0,0,0,1", 4),
        (POSES.replace("0,0,0,1", "0,0,1"), "not a row of a pose", 4),
        (POSES.replace("0,0,0,1", "1"), "not a row of a pose", 4),
        (POSES.replace("0,1,0,-0.1", "0,1,0"), "not a row of a pose: expected 4 numbers", 2),
        (POSES.replace("0,1,0,-0.1", "0,1,0,nan"), "not a row of a pose", 2),
        ("\n" + POSES.replace("0,1,0,-0.1", "0,one,0,0"), "not numbers", 3),
        (POSES.replace("1,0,0,0.8", "1.01,0,0,0.8"), "not a rotation", None),
        (POSES.replace("1,0,0,0.8", "-1,0,0,0.8"), "not a rotation", None),
        (POSES.replace("1,0,0,0.8", "1,1e308,0,0.8"), "not a rotation", None),
    ],
)
def test_faults_in_the_object_poses_are_named_with_file_and_line(
    tmp_path: Path, text: str, message: str, line: int | None
) -> None:
    error = refused(write(tmp_path / "demo", poses=text))
    assert message in error.message
    assert error.file == tmp_path / "demo" / "object_poses.csv"
    assert error.line == line


@pytest.mark.parametrize("name", ["joint_angles.csv", "object_poses.csv"])
def test_binary_files_are_refused(tmp_path: Path, name: str) -> None:
    folder = write(tmp_path / "demo")
    (folder / name).write_bytes(b"\xff\xfe\x00\x01\x80")
    error = refused(folder)
    assert error.file == folder / name
    assert "cannot be read" in error.message


@pytest.mark.parametrize("name", ["joint_angles.csv", "object_poses.csv"])
def test_missing_files_are_named(tmp_path: Path, name: str) -> None:
    folder = write(tmp_path / "demo")
    (folder / name).unlink()
    error = refused(folder)
    assert error.file == folder / name
    assert error.message == "no such file"
    assert error.remedy


def test_missing_folder(tmp_path: Path) -> None:
    error = refused(tmp_path / "demo_99")
    assert error.file == tmp_path / "demo_99"
    assert "no such folder" in error.message


def test_wrong_number_of_objects(tmp_path: Path) -> None:
    folder = write(tmp_path / "demo", poses=POSES + POSES)
    assert len(read(folder, objects=2).X_WO) == 2
    error = refused(folder, objects=1)
    assert "2 object poses, where the scenario has 1 object" in error.message
    assert error.file == folder / "object_poses.csv"


def test_slightly_rounded_poses_are_made_orthonormal(tmp_path: Path) -> None:
    X = exp([0.3, -0.2, 0.9, 0.4, 0.5, 0.6])
    text = "".join(",".join(f"{v:.4f}" for v in row) + "\n" for row in X.tolist())
    (X_WO,) = read(write(tmp_path / "demo", poses=text)).X_WO
    np.testing.assert_allclose(X_WO[:3, :3].T @ X_WO[:3, :3], np.eye(3), atol=1e-14)
    np.testing.assert_allclose(X_WO, X, atol=2e-4)


@pytest.mark.parametrize(("text", "factor"), [("1.5", 1.5), ("1.5\n", 1.5), (" 2 \n\n", 2.0)])
def test_region_of_interest_of_its_own(tmp_path: Path, text: str, factor: float) -> None:
    folder = write(tmp_path / "demo")
    (folder / "region_of_interest.txt").write_text(text)
    assert read(folder).region_of_interest == factor


@pytest.mark.parametrize("text", ["", "wide", "0.9", "nan", "-2", "1.5 1.5"])
def test_useless_regions_of_interest_are_refused(tmp_path: Path, text: str) -> None:
    folder = write(tmp_path / "demo")
    (folder / "region_of_interest.txt").write_text(text)
    assert refused(folder).file == folder / "region_of_interest.txt"


def test_library_is_read_in_order_of_names(tmp_path: Path) -> None:
    for name in ("demo_10", "demo_02", "another"):
        write(tmp_path / name)
    (tmp_path / "config.json").write_text("{}")
    (tmp_path / "pictures").mkdir()
    library = read_library(tmp_path, NAMES, LOWER, UPPER, objects=1)
    assert [recording.name for recording in library] == ["another", "demo_02", "demo_10"]


def test_library_faults(tmp_path: Path) -> None:
    def fault(folder: Path) -> str:
        with pytest.raises(RecordingError) as caught:
            read_library(folder, NAMES, LOWER, UPPER)
        assert caught.value.file == folder
        return str(caught.value)

    (tmp_path / "empty").mkdir()
    assert "no recordings here" in fault(tmp_path / "empty")
    assert "no such file or folder" in fault(tmp_path / "missing")
    one = write(tmp_path / "library" / "demo_01")
    message = fault(one)
    assert "one recording, not a folder of recordings" in message
    assert str(tmp_path / "library") in message
    write(tmp_path / "library" / "demo_02", JOINTS + "0.13,x,0\n")
    with pytest.raises(RecordingError, match=r"demo_02/joint_angles\.csv:5"):
        read_library(tmp_path / "library", NAMES, LOWER, UPPER)


def moving_path(seed: int, m: int, n: int, limit: float) -> np.ndarray:
    """(m, n) in which no two samples in a row stand still."""
    steps = np.random.default_rng(seed).uniform(0.003, 0.02, (m, n))
    return np.clip(np.cumsum(steps, axis=0) - limit + 0.01, -limit, limit)


@settings(
    deadline=None, max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    seed=st.integers(0, 2**32 - 1),
    m=st.integers(3, 40),
    k=st.integers(1, 3),
    names=st.sampled_from([NAMES, LEFT, RIGHT, (*LEFT, *RIGHT)]),
    start=st.floats(0.0, 1e3),
    factor=st.one_of(st.none(), st.sampled_from([1.0, 1.5, 2.25])),
)
def test_what_is_written_is_read_back(
    tmp_path: Path,
    seed: int,
    m: int,
    k: int,
    names: tuple[str, ...],
    start: float,
    factor: float | None,
) -> None:
    rng = np.random.default_rng(seed)
    limits = 1.5 * np.ones(len(names))
    t = start + np.cumsum(rng.uniform(0.005, 0.02, m))
    q, X_WO = moving_path(seed, m, len(names), 1.5), exp(rng.uniform(-1.5, 1.5, (k, 6)))
    folder = tmp_path / "written"
    (folder / "region_of_interest.txt").unlink(missing_ok=True)
    write_recording(Recording("demo", names, t, q, X_WO, factor), folder)
    back = read_recording(folder, names, -limits, limits, objects=k)
    np.testing.assert_allclose(back.q, q, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(back.t, t - t[0], atol=2e-6)
    np.testing.assert_allclose(back.X_WO, X_WO, atol=1e-14)
    assert back.region_of_interest == factor
    assert back.joint_names == names
    assert back.notes == ()
    header = (folder / "joint_angles.csv").read_text().splitlines()[0]
    assert header == ("time,shoulder,elbow" if names == NAMES else BAXTER_HEADER)


@pytest.mark.parametrize(("arm", "other"), [(LEFT, RIGHT), (RIGHT, LEFT)])
def test_baxters_idle_arm_and_grippers_are_held(
    tmp_path: Path, arm: tuple[str, ...], other: tuple[str, ...]
) -> None:
    q = moving_path(1, 5, 7, 1.0)
    held = {other[0]: 0.25, other[6]: -0.5, "left_gripper": 45.0}
    recording = Recording("demo", arm, np.arange(5) / 100.0, q, np.eye(4)[None])
    write_recording(recording, tmp_path / "demo", held)
    lines = (tmp_path / "demo" / "joint_angles.csv").read_text().splitlines()
    assert lines[0] == BAXTER_HEADER
    cells = dict(zip(lines[0].split(","), lines[3].split(","), strict=True))
    assert cells["left_gripper"] == "45"
    assert cells["right_gripper"] == "100"
    for name in other:
        assert float(cells[name]) == held.get(name, 0.0)
    for name, value in zip(arm, q[2], strict=True):
        assert float(cells[name]) == pytest.approx(value, abs=1e-12)


def test_the_right_arm_of_a_baxter_recording_is_read_from_its_columns(tmp_path: Path) -> None:
    both = moving_path(2, 6, 14, 1.0)
    recording = Recording("demo", (*LEFT, *RIGHT), np.arange(6) / 100.0, both, np.eye(4)[None])
    write_recording(recording, tmp_path / "demo")
    for names, q in ((LEFT, both[:, :7]), (RIGHT, both[:, 7:])):
        read_back = read_recording(tmp_path / "demo", names, -np.ones(7), np.ones(7))
        np.testing.assert_allclose(read_back.q, q, atol=1e-11)


def test_object_poses_of_several_objects_are_stacked(tmp_path: Path) -> None:
    X_WO = exp(np.random.default_rng(3).uniform(-1.0, 1.0, (3, 6)))
    file = tmp_path / "object_poses.csv"
    rows = X_WO.reshape(-1, 4).tolist()
    file.write_text("".join(",".join(map(repr, row)) + "\n" for row in rows))
    np.testing.assert_allclose(read_object_poses(file), X_WO, atol=1e-14)


def test_recorded_demonstrations_are_read_without_changes_to_what_matters(shared: Path) -> None:
    for task in ("pouring", "scooping"):
        lower, upper = -3.1 * np.ones(7), 3.1 * np.ones(7)
        library = read_library(shared / "demos" / task, LEFT, lower, upper, objects=1)
        assert len(library) == 16
        for recording in library:
            assert recording.t[0] == 0.0
            assert (np.diff(recording.t) > 0.0).all()
            assert 5.0 < recording.duration < 40.0
            np.testing.assert_array_equal(recording.X_WO[0, :3, :3], np.eye(3))
            file = recording.source / "joint_angles.csv"  # type: ignore[operator]
            raw = np.loadtxt(file, delimiter=",", skiprows=1)[:, 1:8]
            np.testing.assert_array_equal(recording.q[[0, -1]], raw[[0, -1]])
            np.testing.assert_allclose(recording.q.min(axis=0), raw.min(axis=0), atol=2.1e-3)
            np.testing.assert_allclose(recording.q.max(axis=0), raw.max(axis=0), atol=2.1e-3)
