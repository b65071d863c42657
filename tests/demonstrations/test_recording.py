"""What a recording goes through on its way in."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drake_screw.demonstrations import Recording
from drake_screw.demonstrations.part import part_of
from drake_screw.demonstrations.recording import checked
from drake_screw.errors import RecordingError

LOWER, UPPER = np.array([-1.0, -2.0]), np.array([1.0, 2.0])
FILE = Path("demo_01/joint_angles.csv")


def recording(t: Any, q: Any) -> Recording:
    return Recording("demo_01", ("shoulder", "elbow"), np.array(t), np.array(q), np.eye(4)[None])


def ramp(m: int = 11, rate: float = 100.0) -> tuple[np.ndarray, np.ndarray]:
    """From (0, 0) to (0.5, -1), at 100 Hz."""
    s = np.linspace(0.0, 1.0, m)
    return np.arange(m) / rate, np.stack([0.5 * s, -s], axis=1)


def refused(t: Any, q: Any, lines: np.ndarray | None = None) -> RecordingError:
    with pytest.raises(RecordingError) as caught:
        checked(recording(t, q), LOWER, UPPER, file=FILE, lines=lines)
    assert caught.value.file == FILE
    assert caught.value.remedy
    return caught.value


def test_a_good_recording_passes_untouched_but_for_its_time() -> None:
    t, q = ramp()
    result = checked(recording(t + 7.5, q), LOWER, UPPER)
    np.testing.assert_allclose(result.t, t, atol=1e-12)
    np.testing.assert_array_equal(result.q, q)
    assert result.notes == ()
    assert result.duration == pytest.approx(0.1)
    assert result.name == "demo_01"
    np.testing.assert_array_equal(result.X_WO, np.eye(4)[None])


@pytest.mark.parametrize("m", [0, 1])
def test_too_few_samples(m: int) -> None:
    t, q = ramp()
    assert f"{m} sample" in refused(t[:m], q[:m]).message


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_number_that_is_not_finite_is_named_with_its_line(value: float) -> None:
    t, q = ramp()
    q[3, 1] = value
    error = refused(t, q, np.arange(2, 13))
    assert error.line == 5
    assert error.message == "not a finite number: elbow"
    q[3, 0] = value
    assert refused(t, q).message == "not a finite number: shoulder, elbow"
    t, q = ramp()
    t[4] = value
    assert "time" in refused(t, q).message


def test_time_that_runs_backwards() -> None:
    t, q = ramp()
    t[6] = t[4]
    error = refused(t, q, np.arange(2, 13))
    assert error.line == 8
    assert "time runs backwards, from 0.050000 s to 0.040000 s" in error.message


def test_repeated_stamps_are_dropped_and_noted() -> None:
    t, q = ramp()
    doubled_t, doubled_q = np.repeat(t, 2), np.repeat(q, 2, axis=0)
    doubled_q[1::2] += 1e-3
    result = checked(recording(doubled_t, doubled_q), LOWER, UPPER)
    np.testing.assert_array_equal(result.q, q)
    np.testing.assert_array_equal(result.t, t)
    assert result.notes == ("dropped 11 samples with a repeated time stamp",)


def test_lines_are_right_after_dropped_samples() -> None:
    t, q = ramp()
    doubled_t, doubled_q = np.repeat(t, 2), np.repeat(q, 2, axis=0)
    doubled_q[20] = [1.5, 0.0]
    error = refused(doubled_t, doubled_q, np.arange(2, 24))
    assert error.line == 22


def test_angles_in_degrees_are_recognised() -> None:
    t, q = ramp()
    error = refused(t, np.rad2deg(q), np.arange(2, 13))
    assert "degrees" in error.message
    assert "radians" in (error.remedy or "")
    assert "shoulder is at 2.865" in error.message
    assert error.line == 3


def test_angles_beyond_a_limit_are_refused_with_joint_value_and_limits() -> None:
    t, q = ramp()
    q[:, 0] += 0.6
    error = refused(t, q, np.arange(2, 13))
    assert error.line == 11
    assert "shoulder is at 1.0500, outside its limits -1.0000 .. 1.0000" in error.message


@pytest.mark.parametrize(("beyond", "fits"), [(0.9e-3, True), (1.1e-3, False)])
def test_angles_just_beyond_a_limit_are_clamped_and_noted(beyond: float, fits: bool) -> None:
    t, q = ramp()
    q[:, 1] -= 1.0 + beyond
    if not fits:
        assert "elbow" in refused(t, q).message
        return
    result = checked(recording(t, q), LOWER, UPPER)
    assert result.q[-1, 1] == -2.0
    np.testing.assert_array_equal(result.q[:-1], q[:-1])
    assert result.notes == ("clamped elbow to the limit (beyond it by 0.90 mrad)",)


def test_a_gap_is_refused_only_if_the_arm_moved_in_it() -> None:
    t, q = ramp(31)
    t[20:] += 0.6
    still = np.concatenate([q[:20], np.tile(q[19], (11, 1))])
    still[-1] = q[-1]
    moved = q.copy()
    moved[20:] += [0.1, 0.0]
    error = refused(t, moved, np.arange(2, 33))
    assert error.line == 22
    assert "0.61 s are missing" in error.message
    checked(recording(t, still), LOWER, UPPER)
    t[20:] -= 0.2
    checked(recording(t, moved), LOWER, UPPER)


def test_still_head_and_tail_are_cut_to_one_sample_each() -> None:
    t, q = ramp()
    tremble = 1e-3 * np.sin(np.arange(300))[:, None] * [1.0, -1.0]
    head, tail = q[0] + tremble[:200], q[-1] + tremble
    times = np.arange(511) / 100.0
    result = checked(recording(times, np.concatenate([head, q, tail])), LOWER, UPPER)
    assert len(result.t) == len(q)
    np.testing.assert_array_equal(result.q[0], head[0])
    np.testing.assert_array_equal(result.q[-1], tail[-1])
    np.testing.assert_array_equal(result.q[1:-1], q[1:-1])
    assert result.t[0] == 0.0
    np.testing.assert_allclose(result.t, t, atol=1e-12)
    (note,) = result.notes
    assert note == "cut off 2.00 s of standing still at the start, 3.00 s at the end"


def test_a_pause_in_the_middle_is_kept() -> None:
    _, q = ramp()
    paused = np.concatenate([q[:6], np.tile(q[5], (200, 1)), q[6:]])
    result = checked(recording(np.arange(211) / 100.0, paused), LOWER, UPPER)
    np.testing.assert_array_equal(result.q, paused)


@pytest.mark.parametrize(
    "mrad",
    [
        [0.0, 0.0, 0.0],
        [0.0, 1.9, -1.9],
        [0.0, 2.5, 1.5],
        [0.0, 1.5, 3.0],
        [0.0, 1.0, 1.9, 2.5],
        [3.0, 1.5, 0.0, 1.5],
    ],
    ids=str,
)
def test_an_arm_that_hardly_moves_is_refused(mrad: list[float]) -> None:
    q = np.outer(mrad, [1e-3, 0.0])
    assert "move" in refused(np.arange(len(mrad)) / 100.0, q).message


def test_a_recording_that_ends_where_it_began_is_kept_whole() -> None:
    _, q = ramp()
    there_and_back = np.concatenate([q, q[::-1]])
    result = checked(recording(np.arange(22) / 100.0, there_and_back), LOWER, UPPER)
    np.testing.assert_array_equal(result.q, there_and_back)


def test_checking_twice_changes_nothing_more() -> None:
    _, q = ramp()
    q[:, 1] -= 1.0005
    q = np.concatenate([np.tile(q[0], (50, 1)), q])
    once = checked(recording(np.arange(61) / 100.0, q), LOWER, UPPER)
    twice = checked(once, LOWER, UPPER)
    np.testing.assert_array_equal(once.q, twice.q)
    np.testing.assert_array_equal(once.t, twice.t)
    assert once.notes == twice.notes
    assert len(once.notes) == 2


def test_the_callers_arrays_are_not_changed() -> None:
    t, q = ramp()
    q[:, 1] -= 1.0005
    before = q.copy()
    checked(recording(t, q), LOWER, UPPER)
    np.testing.assert_array_equal(q, before)


def test_a_joint_without_limits_is_counted_on_where_it_jumps_by_a_turn() -> None:
    t = np.arange(300) / 100.0
    q = np.column_stack([2.5 + t, 0.5 * t])
    jumping = q.copy()
    jumping[:, 0] = (q[:, 0] + np.pi) % (2.0 * np.pi) - np.pi
    lower, upper = np.array([-np.inf, -3.0]), np.array([np.inf, 3.0])
    result = checked(recording(t, jumping), lower, upper)
    np.testing.assert_allclose(result.q, q, atol=1e-12)
    assert any("on through full turns" in note for note in result.notes)
    again = checked(recording(t, q + np.array([20.0 * np.pi, 0.0])), lower, upper)
    np.testing.assert_allclose(again.q, q, atol=1e-9)
    assert checked(recording(t, q), lower, upper).notes == ()


def test_a_part_begins_at_zero_and_says_what_it_is_of() -> None:
    t, q = ramp()
    X_WE = np.tile(np.eye(4), (11, 1, 1))
    X_WE[:, 0, 3] = t
    by_hand = Recording("hand", (), t, np.zeros((11, 0)), np.eye(4)[None], X_WE=X_WE)
    for whole in (recording(t, q), by_hand):
        part = part_of(whole, 0.03, 0.06)
        np.testing.assert_allclose(part.t, [0.0, 0.01, 0.02, 0.03], atol=1e-12)
        np.testing.assert_array_equal(part.q, whole.q[3:7])
        assert part.cut
        assert part.notes == ("kept 0.03 s to 0.06 s of 0.10 s",)
        assert part_of(whole, 0.0, 0.1) is whole
        with pytest.raises(RecordingError, match=r"1 sample from 0\.03 s to 0\.03 s"):
            part_of(whole, 0.03, 0.03)
    np.testing.assert_array_equal(part_of(by_hand, 0.03, 0.06).X_WE, X_WE[3:7])
