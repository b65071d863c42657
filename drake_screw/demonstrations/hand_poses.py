"""Recordings of the hand alone: its poses over time, and no joints.

Guiding poses need nothing else. How the arm gets there is for planning to find.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drake_screw.demonstrations.recording import GAP, Recording, cut_off, distinct_stamps
from drake_screw.errors import RecordingError, counted
from drake_screw.files import csv_text
from drake_screw.screws import (
    pose,
    quaternion_from_rotation,
    rotation_angle,
    rotation_from_quaternion,
)
from drake_screw.tables import read_table
from drake_screw.typing import Array, PathLike

COLUMNS = ("time", "x", "y", "z", "qw", "qx", "qy", "qz")
"""Of hand_poses.csv."""
STILL = (2e-3, 5e-3)
"""m, rad, within which the hand stands still."""
JUMP = 0.05
"""m in one gap."""
FASTEST = 3.0
"""m/s, of a hand that is led."""


def hand_csv(t: Array, X_WE: Array) -> str:
    """The text of hand_poses.csv.

    Args:
        t: (m,) s.
        X_WE: (m, 4, 4).
    """
    q = quaternion_from_rotation(X_WE[:, :3, :3])
    rows = np.column_stack([X_WE[:, :3, 3], q]).tolist()
    cells = ((f"{s:.6f}", *(f"{v:.12g}" for v in row)) for s, row in zip(t, rows, strict=True))
    return csv_text([COLUMNS, *cells])


def read_hand_csv(file: PathLike) -> tuple[Array, Array, Array]:
    """t (m,) s, X_WE (m, 4, 4) and the line (m,) of each row.

    Raises:
        RecordingError: the file is missing, lacks a column, or has a row that is no pose.
    """
    table = read_table(file)
    table.require(COLUMNS)
    values = np.stack([table.numbers(name) for name in COLUMNS], axis=1)
    return values[:, 0], poses(values[:, 1:4], values[:, 4:], file, table.lines), table.lines


def poses(p: Array, q: Array, file: PathLike | None, lines: Sequence[int] | Array) -> Array:
    """Poses (m, 4, 4) of positions (m, 3) in m and quaternions (m, 4), w first.

    Raises:
        RecordingError: a number is not finite, or a quaternion's length is not 1.
    """
    bad = ~np.isfinite(np.column_stack([p, q])).all(axis=1)
    length = np.linalg.norm(q, axis=1)
    wrong = bad | (np.abs(length - 1.0) > 0.01)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise RecordingError(
            "not a finite number" if bad[row] else f"a quaternion of length {length[row]:.3g}",
            remedy="Delete the row if it is a single drop-out; otherwise check which columns are "
            "the quaternion.",
            file=file,
            line=int(lines[row]),
        )
    return pose(rotation_from_quaternion(q), p)


def checked_hand(
    recording: Recording, *, file: PathLike | None = None, lines: Sequence[int] | Array
) -> Recording:
    """A recording of hand poses made fit for use, as `recording.checked` does those of joints.

    Args:
        recording: as read; with X_WE.
        file: named in errors.
        lines: (m,) the line of each sample in `file`.

    Raises:
        RecordingError: fewer than two samples, time that runs backwards, a hand that jumps or does
            not move, a gap in which it moved.
    """
    X, t, where = recording.X_WE, recording.t, np.asarray(lines)
    assert X is not None
    notes = list(recording.notes)

    def fail(row: int, message: str, remedy: str) -> RecordingError:
        return RecordingError(message, remedy=remedy, file=file, line=int(where[row]))

    if len(t) < 2:
        raise RecordingError(
            f"{counted(len(t), 'sample')}; a recording needs at least 2", file=file
        )
    if (np.diff(t) < 0.0).any():
        row = int(np.argmax(np.diff(t) < 0.0)) + 1
        raise fail(row, "time runs backwards", "Sort the rows by time, or split the file.")
    moves = np.append(True, (X[1:] != X[:-1]).any(axis=(1, 2)))
    t, keep = distinct_stamps(t, moves, notes, lambda message, remedy: fail(0, message, remedy))
    X, where = X[keep], where[keep]
    steps = np.linalg.norm(np.diff(X[:, :3, 3], axis=0), axis=1)
    usual = float(np.median(np.diff(t))) if len(t) > 1 else 0.0
    fast = steps > FASTEST * np.maximum(np.diff(t), usual) + JUMP
    if fast.any():
        row = int(np.argmax(fast)) + 1
        raise fail(
            row,
            f"the hand moves by {steps[row - 1]:.2f} m in {t[row] - t[row - 1]:.4f} s",
            "Positions are in m and time is in s; delete rows that cannot be true.",
        )
    gaps = np.flatnonzero((np.diff(t) > GAP) & (steps > JUMP))
    if gaps.size:
        row = int(gaps[0])
        raise fail(
            row + 1,
            f"{t[row + 1] - t[row]:.2f} s are missing, in which the hand moved",
            "Record again: what it did in the gap cannot be known.",
        )
    moved = _away(X, X[0]), _away(X, X[-1])
    if not moved[0].any():
        raise RecordingError(
            "the hand does not move: by no more than 2 mm and 5 mrad",
            remedy="Record again while leading the arm.",
            file=file,
        )
    first = max(int(np.argmax(moved[0])) - 1, 0)
    last = len(t) - int(np.argmax(moved[1][::-1]))
    last = min(max(last, first + 1), len(t) - 1)
    notes.extend(cut_off(t, first, last))
    t, X = t[first : last + 1], X[first : last + 1]
    q = np.zeros((len(t), 0))
    return replace(recording, t=t - t[0], X_WE=X, q=q, notes=tuple(notes))


def _away(X: Array, X_0: Array) -> Array:
    """(m,) bool, whether the hand is elsewhere or turned."""
    place = np.linalg.norm(X[:, :3, 3] - X_0[:3, 3], axis=1) > STILL[0]
    return np.asarray(place | (rotation_angle(X, X_0[None]) > STILL[1]))
