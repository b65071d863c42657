"""What cannot be true of a recording is noticed, in these words."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw import RecordingError, Setup
from drake_screw.demonstrations import Recording

LEFT = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))


def base(m: int = 12) -> tuple[np.ndarray, np.ndarray]:
    """Rows 0.1 s apart, s0 = 0.5 + 0.02 i, the other joints still."""
    q = np.tile([0.5, -0.2, -0.7, 1.5, 1.8, -0.9, -0.5], (m, 1))
    q[:, 0] += 0.02 * np.arange(m)
    return 0.1 * np.arange(m), q


def read(
    setup: Setup,
    folder: Path,
    t: np.ndarray,
    q: np.ndarray,
    place: tuple[float, float, float] = (0.8, 0.5, -0.1),
    form: str = "{:.12g}",
) -> Recording:
    folder.mkdir(exist_ok=True)
    rows = [",".join([form.format(s), *map(str, row)]) for s, row in zip(t, q, strict=True)]
    (folder / "joint_angles.csv").write_text("\n".join([",".join(["time", *LEFT]), *rows]))
    X = np.eye(4)
    X[:3, 3] = place
    np.savetxt(folder / "object_poses.csv", X, delimiter=",")
    return setup.recorder.read(folder)


def test_the_base_itself_is_all_right(setup: Setup, tmp_path: Path) -> None:
    found = read(setup, tmp_path / "demo", *base())
    assert found.notes == ()
    assert len(found.t) == 12


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ((800.0, 500.0, -100.0), "millimetres"),
        ((-0.8, -0.5, -0.1), "another frame, turned by half a turn about z"),
        ((-0.8, 0.5, -0.1), "seen from 'base'"),
        ((5.0, 0.5, -0.1), "m from where the hand comes nearest to it"),
    ],
)
def test_objects_that_cannot_have_been_there(
    setup: Setup, tmp_path: Path, place: tuple[float, float, float], words: str
) -> None:
    with pytest.raises(RecordingError, match="m from where the hand comes nearest") as caught:
        read(setup, tmp_path / "demo", *base(), place=place)
    assert words in str(caught.value)
    assert caught.value.file == (tmp_path / "demo" / "object_poses.csv").resolve()


def test_a_hand_that_stays_away_from_the_objects_is_noted(setup: Setup, tmp_path: Path) -> None:
    t, q = base()
    X_WE = setup.workcell.arm.pose(q[0])
    x, y, z = (X_WE[:3, 3] + [0.0, 0.0, -0.7]).tolist()
    (note,) = read(setup, tmp_path / "demo", t, q, place=(x, y, z)).notes
    assert note.startswith("the hand never comes within 0.5 m of any object: 0.7")


def test_one_impossible_sample_is_dropped(setup: Setup, tmp_path: Path) -> None:
    t, q = base()
    q[6] = 0.0
    found = read(setup, tmp_path / "demo", t, q)
    assert len(found.t) == 11
    assert found.notes == (
        "dropped 1 sample that cannot be true, line 8: left_e1 would jump to 0 rad and back",
    )


def test_one_zero_row_of_a_demonstration_changes_nothing(
    setup: Setup, tmp_path: Path, shared: Path
) -> None:
    demo = setup.recorder.read(shared / "demos" / "pouring" / "demo_01")
    q = demo.q.copy()
    q[900] = 0.0
    place = tuple(demo.X_WO[0, :3, 3].tolist())
    found = read(setup, tmp_path / "demo", demo.t, q, place=place)
    assert "dropped 1 sample that cannot be true, line 902" in found.notes[-1]
    assert len(setup.learn(found).X_OE) == len(setup.learn(demo).X_OE)


def test_more_than_single_samples_are_refused_with_their_line(setup: Setup, tmp_path: Path) -> None:
    t, q = base()
    q[5:8] = 0.0
    with pytest.raises(RecordingError, match=r"moves by .* rad in 0\.1000 s, and its limit") as e:
        read(setup, tmp_path / "demo", t, q)
    assert e.value.line == 7


@pytest.mark.parametrize("since", [0, 5])
def test_a_whole_turn_off(setup: Setup, tmp_path: Path, since: int) -> None:
    t, q = base()
    turned = q.copy()
    turned[since:, 6] += 2.0 * np.pi
    found = read(setup, tmp_path / "demo", t, turned)
    np.testing.assert_allclose(found.q, q, atol=1e-9)
    where = f" in {12 - since} of 12 samples, from line {since + 2} on" if since else ""
    assert found.notes == (f"shifted left_w2 by 1 whole turn{where}",)


def test_degrees_are_still_called_so(setup: Setup, tmp_path: Path) -> None:
    t, q = base()
    with pytest.raises(RecordingError, match="look like degrees"):
        read(setup, tmp_path / "demo", t, np.rad2deg(q))


def long(m: int = 500, rate: float = 100.0) -> tuple[np.ndarray, np.ndarray]:
    t = np.arange(m) / rate
    q = np.tile([0.5, -0.2, -0.7, 1.5, 1.8, -0.9, -0.5], (m, 1))
    q[:, 0] -= 0.3 * t
    return t, q


@pytest.mark.parametrize(
    "stamps",
    [
        lambda t: np.floor(t),
        lambda t: np.repeat(t[::50], 50),
        lambda t: (t + 4_000_000.0).astype(np.float32).astype(float),
    ],
    ids=["whole seconds", "bursts of 50", "32-bit floats"],
)
def test_coarse_stamps_are_spread(setup: Setup, tmp_path: Path, stamps: object) -> None:
    t, q = long()
    found = read(setup, tmp_path / "demo", stamps(t), q)  # type: ignore[operator]
    assert "the stamps are coarse" in found.notes[0]
    np.testing.assert_array_equal(found.q, q)
    np.testing.assert_allclose(found.t, t, atol=0.02)


def test_one_stamp_for_all_says_nothing_of_the_rate(setup: Setup, tmp_path: Path) -> None:
    t, q = long()
    with pytest.raises(RecordingError, match="all 500 samples have one time stamp"):
        read(setup, tmp_path / "demo", np.full_like(t, 1.7e9), q)


def test_time_in_ns_is_taken_as_that(setup: Setup, tmp_path: Path) -> None:
    t, q = base()
    found = read(setup, tmp_path / "demo", np.round(t * 1e9), q, form="{:.0f}")
    np.testing.assert_allclose(found.t, t, atol=1e-9)
    assert found.notes == ("time is in ns, not in s: taken as that, 1.10 s",)


def test_frame_numbers_are_refused(setup: Setup, tmp_path: Path) -> None:
    _, q = base()
    with pytest.raises(RecordingError, match="the samples are 1 s apart") as caught:
        read(setup, tmp_path / "demo", np.arange(12.0), q)
    assert "Frame numbers" in str(caught.value)


@pytest.mark.parametrize("separator", [";", "\t"])
def test_other_separators_and_quoted_names(setup: Setup, tmp_path: Path, separator: str) -> None:
    want = read(setup, tmp_path / "demo", *base())
    file = tmp_path / "demo" / "joint_angles.csv"
    header, body = file.read_text().split("\n", 1)
    quoted = ",".join(f'"{name}"' for name in header.split(","))
    file.write_text(f"{quoted}\n{body}".replace(",", separator).replace(".", ","))
    np.testing.assert_array_equal(setup.recorder.read(tmp_path / "demo").q, want.q)


def test_decimal_commas_between_commas_are_named(setup: Setup, tmp_path: Path) -> None:
    read(setup, tmp_path / "demo", *base(), form="{:.3f}")
    file = tmp_path / "demo" / "joint_angles.csv"
    file.write_text(file.read_text().replace(".", ","))
    with pytest.raises(RecordingError, match="decimal commas"):
        setup.recorder.read(tmp_path / "demo")


def test_a_missing_time_column_is_no_other_robot(setup: Setup, tmp_path: Path) -> None:
    read(setup, tmp_path / "demo", *base())
    file = tmp_path / "demo" / "joint_angles.csv"
    rows = [line.split(",", 1)[1] for line in file.read_text().splitlines()]
    file.write_text("\n".join(rows))
    with pytest.raises(RecordingError, match="no column 'time'") as caught:
        setup.recorder.read(tmp_path / "demo")
    assert "drake-screw import" in str(caught.value)
    assert "another robot" not in str(caught.value)
