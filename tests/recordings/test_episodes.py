"""Files that hold several demonstrations, cut at pauses, by a column or by a bag's topic."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drake_screw import RecordingError, Setup
from drake_screw.assembly.importing import read_recordings
from drake_screw.recordings import Mapping, Understood
from drake_screw.recordings.episodes import Episode, between_pauses, by_labels
from drake_screw.recordings.raw import Labels
from drake_screw.typing import Array
from tests.recordings.bags import LEFT, START, bag

REST = np.array([0.5, -0.2, -0.7, 1.5, 1.8, -0.9, -0.5])
BOWL = {"bowl": (0.8, 0.5)}


def three() -> tuple[Array, Array]:
    """Three motions of one joint at 50 Hz: from 1 to 4 s, from 7 to 10 s and from 13 to 15 s.

    The stop before the first is too short for a pause.
    """
    t = 0.02 * np.arange(901)
    s = np.interp(t, [0.0, 1.0, 4.0, 7.0, 10.0, 13.0, 15.0, 18.0], [0, 0, 0.6, 0.6, 0, 0, 0.5, 0.5])
    return t, REST + s[:, None] * np.eye(7)[0]


def table(file: Path, t: Array, q: Array, **columns: list[Any]) -> Path:
    rows = zip(t.tolist(), *q.T.tolist(), *columns.values(), strict=True)
    lines = [",".join(["time", *LEFT, *columns]), *(",".join(map(str, row)) for row in rows)]
    file.write_text("\n".join(lines))
    return file


def spans(found: tuple[Understood, ...]) -> list[str]:
    """What is noted of when each was."""
    return [
        next(note for note in each.recording.notes if "in the file, from" in note)
        for each in found
        if each.recording is not None
    ]


def test_motions_between_pauses() -> None:
    t, q = three()
    found, small = between_pauses(t, q)
    at = [(t[each.first], t[each.end - 1]) for each in found]
    np.testing.assert_allclose(at, [(0.0, 4.0), (7.0, 10.0), (13.0, 15.0)], atol=0.021)
    assert small == 0
    assert len(between_pauses(t, q, pause=2.9)[0]) == 3
    assert between_pauses(t, q, pause=3.1)[0] == [Episode(0, len(t))]


@pytest.mark.parametrize("seed", range(5))
def test_noise_outliers_and_uneven_times_do_not_change_the_cuts(seed: int) -> None:
    rng = np.random.default_rng(seed)
    t, q = three()
    t = np.sort(t + rng.uniform(0.0, 0.02, len(t)))
    noisy = q + rng.uniform(-0.001, 0.001, q.shape)
    noisy[rng.choice(len(t), 3, replace=False)] = 0.0
    found, small = between_pauses(t, noisy)
    at = [(t[each.first], t[each.end - 1]) for each in found]
    np.testing.assert_allclose(at, [(0.0, 4.0), (7.0, 10.0), (13.0, 15.0)], atol=0.06)
    assert small == 0


def test_slow_motion_is_no_pause_and_slow_drift_is_one() -> None:
    t = 0.02 * np.arange(1001)
    slow = np.interp(t, [0, 5, 15, 20], [0.0, 0.5, 0.6, 1.1])[:, None]
    assert len(between_pauses(t, slow)[0]) == 1
    drift = np.interp(t, [0, 5, 15, 20], [0.0, 0.5, 0.52, 1.0])[:, None]
    found, _ = between_pauses(t, drift)
    at = [(t[each.first], t[each.end - 1]) for each in found]
    np.testing.assert_allclose(at, [(0.0, 5.0), (15.0, 20.0)], atol=1.0)


def test_a_time_without_samples_is_a_pause_even_if_the_arm_was_moved() -> None:
    t, q = three()
    kept = (t <= 4.0) | ((t >= 8.0) & (t <= 10.0))
    t, q = t[kept], q[kept]
    found, _ = between_pauses(t, q)
    assert [(t[each.first], t[each.end - 1]) for each in found] == [
        (0.0, pytest.approx(4.0)),
        (pytest.approx(8.0), pytest.approx(10.0)),
    ]


def test_small_motions_between_pauses_are_left_out() -> None:
    t, q = three()
    q[:, 0] = np.interp(t, [0.0, 1.0, 4.0, 7.0, 10.0, 13.0, 15.0], [0, 0, 0.6, 0.6, 0.51, 0.51, 0])
    found, small = between_pauses(t, q)
    at = [(t[each.first], t[each.end - 1]) for each in found]
    np.testing.assert_allclose(at, [(0.0, 4.0), (13.0, 15.0)], atol=0.041)
    assert small == 1


@pytest.mark.parametrize(
    ("values", "rows"),
    [
        ([False, True, True, False, True], [(2, 6), (8, 10)]),
        (["", "one", "one", "", "two"], [(2, 6), (8, 10)]),
        (["True", "false", "true", "FALSE", "true"], [(0, 2), (4, 6), (8, 10)]),
        (["a", "b", "b", "c", "a"], [(0, 2), (2, 6), (6, 8), (8, 10)]),
        ([0, 1, 1, 2, 3], [(0, 2), (2, 6), (6, 8), (8, 10)]),
        ([0, 1, 1, 0, 1], [(2, 6), (8, 10)]),
        ([-1, 0, 0, -1, 1.0], [(2, 6), (8, 10)]),
        ([float("nan"), 0, 0, float("nan"), 1], [(2, 6), (8, 10)]),
    ],
)
def test_what_labels_stand_for(values: list[Any], rows: list[tuple[int, int]]) -> None:
    labels = Labels(np.arange(0.0, 10.0, 2.0), tuple(values))
    assert [(each.first, each.end) for each in by_labels(np.arange(10.0), labels)] == rows


def test_a_table_cut_at_pauses(setup: Setup, tmp_path: Path) -> None:
    t, q = three()
    file = table(tmp_path / "log.csv", 100.0 + t, q)
    found = read_recordings(file, setup, Mapping(objects=BOWL, episodes="pauses"))
    assert [each.name for each in found] == ["log_01", "log_02", "log_03"]
    assert spans(found) == [
        "is 1 of 3 in the file, from 0.00 to 4.00 s, between pauses of at least 2 s",
        "is 2 of 3 in the file, from 7.00 to 10.00 s, between pauses of at least 2 s",
        "is 3 of 3 in the file, from 13.00 to 15.00 s, between pauses of at least 2 s",
    ]
    second = found[1].recording
    assert second is not None
    np.testing.assert_allclose(second.q[[0, -1]], q[[350, 500]], atol=1e-9)
    np.testing.assert_allclose(second.t[[0, -1]], [0.0, 3.0], atol=1e-9)
    assert "episodes: pauses" in found[0].mapping.text()
    longer = Mapping(objects=BOWL, episodes="pauses", pause=3.1)
    assert [each.name for each in read_recordings(file, setup, longer)] == ["log_01"]


def test_without_the_key_it_is_one_and_says_how_it_would_be_cut(
    setup: Setup, tmp_path: Path
) -> None:
    t, q = three()
    (found,) = read_recordings(table(tmp_path / "log.csv", t, q), setup, Mapping(objects=BOWL))
    assert found.name == "log"
    assert found.recording is not None
    assert found.recording.notes[-1] == (
        "there seem to be 3 demonstrations, with pauses of at least 2 s from 4.00, 10.00 s on; "
        "episodes: pauses in recording.yaml cuts them"
    )


def test_a_file_written_in_parts_is_refused_with_the_remedy(setup: Setup, tmp_path: Path) -> None:
    t, q = three()
    kept = (t <= 4.0) | ((t >= 8.0) & (t <= 10.0))
    file = table(tmp_path / "log.csv", t[kept], q[kept])
    with pytest.raises(RecordingError, match="s are missing, in which the arm moved") as caught:
        read_recordings(file, setup, Mapping(objects=BOWL))
    assert "episodes: pauses in recording.yaml" in str(caught.value)
    cut = read_recordings(file, setup, Mapping(objects=BOWL, episodes="pauses"))
    assert [each.name for each in cut] == ["log_01", "log_02"]


def test_a_table_cut_by_a_column(setup: Setup, tmp_path: Path) -> None:
    t, q = three()
    number = np.select([t < 5.0, t < 11.0], [0, 1], 2).tolist()
    file = table(tmp_path / "log.csv", t, q, episode=number)
    found = read_recordings(file, setup, Mapping(objects=BOWL, episodes="episode"))
    assert spans(found) == [
        "is 1 of 3 in the file, from 0.00 to 4.98 s, by episode",
        "is 2 of 3 in the file, from 5.00 to 10.98 s, by episode",
        "is 3 of 3 in the file, from 11.00 to 18.00 s, by episode",
    ]
    with pytest.raises(RecordingError, match="episodes: no column 'episod'") as caught:
        read_recordings(file, setup, Mapping(objects=BOWL, episodes="episod"))
    assert "Did you mean 'episode'?" in str(caught.value)
    still = Mapping(objects=BOWL, episodes="pauses", still=0.2)
    with pytest.raises(RecordingError, match="no motion by more than 2 rad or m"):
        read_recordings(file, setup, still)


@pytest.mark.parametrize("kind", ["bag", "mcap"])
@pytest.mark.parametrize(("what", "ahead"), [("Bool", 0), ("String", -1_000_000), ("Int32", 7)])
def test_a_bag_cut_by_a_topic(
    kind: str, what: str, ahead: int, setup: Setup, tmp_path: Path
) -> None:
    pytest.importorskip("rosbags")
    t, q = three()
    said: dict[str, list[Any]] = {
        "Bool": [True, False, True, False, True, False],
        "String": ["pour", "", "pour again", "", "once more", ""],
        "Int32": [1, 0, 2, 0, 3, 0],
    }
    at = dict(zip((0.5, 4.5, 6.5, 6.6, 12.5, 15.5), said[what], strict=True))
    path = tmp_path / ("demo.bag" if kind == "bag" else "demo")
    with bag(path, kind, ahead) as write:
        for s, row in zip(t.tolist(), q, strict=True):
            write("/joint_states", START + s, "joints", LEFT, row)
            for when in [when for when in at if when - 0.02 < s - 0.01 < when]:
                write("/teach", START + when, what, at[when])
    source = path if kind == "bag" else next(path.glob("*.mcap"))
    found = read_recordings(source, setup, Mapping(objects=BOWL, episodes="/teach"))
    assert [each.name.rsplit("_", 1)[1] for each in found] == ["01", "02"]
    assert spans(found) == [
        "is 1 of 2 in the file, from 0.50 to 4.48 s, by /teach",
        "is 2 of 2 in the file, from 12.50 to 15.48 s, by /teach",
    ]
    first, second = (each.recording for each in found)
    assert first is not None
    assert second is not None
    assert "left out 1 episode in which the arm moves by less than 0.1 rad or m" in first.notes
    np.testing.assert_allclose(second.q[[0, -1]], q[[650, 750]], atol=1e-3)
    with pytest.raises(RecordingError, match="episodes: no topic '/tech'") as caught:
        read_recordings(source, setup, Mapping(objects=BOWL, episodes="/tech"))
    assert "Did you mean '/teach'? Such topics: /teach" in str(caught.value)
    with pytest.raises(RecordingError, match="topic '/joint_states' has sensor_msgs/msg/JointS"):
        read_recordings(source, setup, Mapping(objects=BOWL, episodes="/joint_states"))


def test_hand_poses_are_cut_at_pauses_too(setup: Setup, tmp_path: Path) -> None:
    from drake_screw.screws import quaternion_from_rotation

    t, q = three()
    X = setup.workcell.arm.pose(q)
    w, x, y, z = quaternion_from_rotation(X[:, :3, :3]).T
    columns = dict(zip(("x", "y", "z"), X[:, :3, 3].T, strict=True))
    columns |= {"qx": x, "qy": y, "qz": z, "qw": w}
    text = [",".join(["time", *columns])]
    text += [",".join(map(str, row)) for row in np.column_stack([t, *columns.values()]).tolist()]
    (tmp_path / "hand.csv").write_text("\n".join(text))
    found = read_recordings(
        tmp_path / "hand.csv", setup, Mapping(objects=BOWL, episodes="pauses", rate=None)
    )
    assert [span.split(", ")[1] for span in spans(found)] == [
        "from 0.00 to 4.00 s",
        "from 7.00 to 10.00 s",
        "from 13.00 to 15.00 s",
    ]
