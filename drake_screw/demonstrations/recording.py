"""Recordings of an arm that was led by hand, and the checks they go through on the way in."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from drake_screw.demonstrations.outliers import plausible
from drake_screw.demonstrations.turns import turns_in_words, whole_turns
from drake_screw.errors import RecordingError, counted
from drake_screw.screws.endless import TURN, is_endless, unwrapped
from drake_screw.tables.clock import in_seconds, spread, unit_of
from drake_screw.typing import Array, PathLike

if TYPE_CHECKING:
    from drake_screw.robot.arm import Arm

CLAMPED_WITHIN = 1e-3  # rad; encoders read this far beyond a limit when the arm rests against it
GAP = 0.5  # s
JUMP = 0.05  # rad in one gap
STILL = 2e-3  # rad
MOST = 0.9  # of the samples within the limits; with fewer it is not single samples that are wrong


class ArmAtRest(RecordingError):
    """A recording in which the arm does not move."""


@dataclass(frozen=True)
class Recording:
    """Joint angles over time, with the object poses at that time.

    Attributes:
        name: of its folder, say "demo_07".
        joint_names: n names.
        t: (m,) s, increasing from 0.
        q: (m, n) rad or m.
        X_WO: (k, 4, 4) poses of the k objects.
        region_of_interest: factor on the smallest distance of E to an object, if the recording
            has its own.
        notes: what the importer changed, human-readable.
        source: folder it was read from.
        task_objects: names of the objects that the end effector works on, if the recording says so.
        robot: model of the robot it was made on; None for the arm that is planned for.
        X_WE: (m, 4, 4) the end effector's path where that was recorded and joints were not; then
            there are no joint names, and q is (m, 0).
        cut: whether it is only a part of what was read.
    """

    name: str
    joint_names: tuple[str, ...]
    t: Array
    q: Array
    X_WO: Array
    region_of_interest: float | None = None
    notes: tuple[str, ...] = ()
    source: Path | None = None
    task_objects: tuple[str, ...] = ()
    robot: str | None = None
    X_WE: Array | None = None
    cut: bool = False

    def path(self, arm: Arm) -> Array:
        """X_WE (m, 4, 4), the end effector's path: as recorded, or by the joints."""
        return arm.pose(self.q) if self.X_WE is None else self.X_WE

    @property
    def duration(self) -> float:
        """Length in s."""
        return float(self.t[-1] - self.t[0])


def checked(
    recording: Recording,
    lower: Array,
    upper: Array,
    *,
    file: PathLike | None = None,
    lines: Array | None = None,
    units: Sequence[str] | None = None,
    velocity_limits: Array | None = None,
) -> Recording:
    """The recording made fit for use, or an error that says where it is not.

    Time is rebased to 0, and made seconds where it can only be another unit. Samples with the stamp
    of the one before are dropped or, where the stamps are coarse, spread. Angles a whole turn off
    are shifted, those of joints without limits counted on where they jump by full turns; single
    samples that cannot be true are dropped. Joints within 1 mrad (1 mm) beyond a limit are clamped,
    and of a still head and tail one sample is kept; `notes` says what was done.

    Args:
        recording: as read.
        lower, upper: (n,) joint limits, rad or m; infinite where a joint has none.
        file: named in errors.
        lines: (m,) the line of each sample in `file`.
        units: "rad" or "m" of each joint; "rad" if None.
        velocity_limits: (n,) rad/s or m/s; how fast the arm moves is not looked at if None.

    Raises:
        RecordingError: fewer than two samples, a number that is not finite, time that runs
            backwards or is in no unit, angles in degrees or beyond the limits, a joint that moves
            faster than it can, a gap in which the arm moved.
    """
    t, q, notes = recording.t, recording.q, list(recording.notes)
    where = np.arange(len(t)) if lines is None else np.asarray(lines)

    def fail(row: int, message: str, remedy: str) -> RecordingError:
        return RecordingError(message, remedy=remedy, file=file, line=int(where[row]))

    if len(t) < 2:
        raise RecordingError(
            f"{counted(len(t), 'sample')}; a recording needs at least 2",
            file=file,
            remedy="Record it again.",
        )
    bad = ~(np.isfinite(t) & np.isfinite(q).all(axis=1))
    if bad.any():
        row = int(np.argmax(bad))
        what = [n for n, v in zip(recording.joint_names, q[row], strict=True) if not np.isfinite(v)]
        raise fail(
            row,
            f"not a finite number: {', '.join(what) or 'time'}",
            "Delete the row if it is a single drop-out, or record again.",
        )
    back = np.diff(t) < 0.0
    if back.any():
        row = int(np.argmax(back)) + 1
        raise fail(
            row,
            f"time runs backwards, from {t[row - 1]:.6f} s to {t[row]:.6f} s",
            "Sort the rows by time, or split a file into which two recordings were written.",
        )
    moves = np.append(True, _any_joint(q, lambda x: np.diff(x) != 0.0))
    t, keep = distinct_stamps(t, moves, notes, lambda message, remedy: fail(0, message, remedy))
    q, where = (q, where) if keep.all() else (q[keep], where[keep])
    if len(t) < 2:
        raise fail(
            0,
            f"all {len(keep)} samples have one time stamp",
            "Stamps so coarse say nothing of the rate: bring the recording in with drake-screw "
            "import, and rate: 100 (Hz) in recording.yaml.",
        )
    of = ["rad"] * q.shape[1] if units is None else list(units)
    q = _counted_on(recording, q, lower, upper, notes)
    turns = whole_turns(q, lower, upper, of, CLAMPED_WITHIN)
    if turns.any():
        notes.append(turns_in_words(turns, recording.joint_names, where))
        q = q - turns * TURN
    outside = _any_joint(q, _beyond, lower - CLAMPED_WITHIN, upper + CLAMPED_WITHIN)
    if velocity_limits is not None and 1.0 - outside.mean() > MOST:
        keep, note = plausible(t, q, velocity_limits, recording.joint_names, of, fail, where)
        if note:
            notes.append(note)
            t, q, where = t[keep], q[keep], where[keep]
    q = _within_limits(recording, q, lower, upper, of, notes, fail)
    gaps = np.flatnonzero(np.diff(t) > GAP)
    gaps = gaps[np.abs(q[gaps + 1] - q[gaps]).max(axis=1) > JUMP]
    if gaps.size:
        row = int(gaps[0])
        raise fail(
            row + 1,
            f"{t[row + 1] - t[row]:.2f} s are missing, in which the arm moved",
            "Record again: what the arm did in the gap cannot be known. If several demonstrations "
            "are in the file, drake-screw import cuts it, with episodes: pauses in recording.yaml.",
        )
    left = _any_joint(q, _beyond, q[0] - STILL, q[0] + STILL)
    stays = ~_any_joint(q, _beyond, q[-1] - STILL, q[-1] + STILL)
    first = int(np.argmax(left)) - 1
    last = len(t) - int(np.argmin(stays[::-1]))
    if not left.any() or stays.all() or first >= last:
        raise ArmAtRest(
            f"the arm does not move: no joint by much more than {STILL * 1e3:.0f} mrad (mm)",
            remedy="Record again while leading the arm.",
            file=file,
        )
    ends = q[0].copy(), q[-1].copy()
    notes.extend(cut_off(t, first, last))
    t, q = t[first : last + 1], q[first : last + 1].copy()
    q[0], q[-1] = ends
    return replace(recording, t=t - t[0], q=q, notes=tuple(notes))


def _any_joint(q: Array, of: Callable[..., NDArray[np.bool_]], *limits: Array) -> NDArray[np.bool_]:
    """Whether something is so of any joint of q (m, n), looked at one after the other.

    That takes a small part of the room that all at once would take, which tells in long recordings.
    """
    columns = (of(q[:, j], *(limit[j] for limit in limits)) for j in range(q.shape[1]))
    found = next(columns, np.zeros(len(q), dtype=bool))
    for column in columns:
        found |= column
    return found


def _beyond(x: Array, lower: float, upper: float) -> NDArray[np.bool_]:
    return (x < lower) | (x > upper)


def distinct_stamps(
    t: Array, moves: NDArray[np.bool_], notes: list[str], fail: Callable[[str, str], RecordingError]
) -> tuple[Array, NDArray[np.bool_]]:
    """Stamps in s, no two alike, and which (m,) of the samples they are of.

    Args:
        t: (m,) as recorded, none before the one in front of it.
        moves: (m,) whether a sample differs from the one in front of it.
        notes: gets what was done.
        fail: makes the error of a message and a remedy.
    """
    t, note = spread(in_plain_seconds(t, notes, fail), moves)
    notes.extend([note] if note else [])
    keep = np.append(True, np.diff(t) > 0.0)
    if not keep.all():
        dropped = counted(int(np.count_nonzero(~keep)), "sample")
        notes.append(f"dropped {dropped} with a repeated time stamp")
    return t[keep], keep


def cut_off(t: Array, first: int, last: int) -> Iterator[str]:
    """A note on what is cut off before and after some samples of stamps (m,), if it is much."""
    before, after = t[first] - t[0], t[-1] - t[last]
    if before > 0.05 or after > 0.05:
        yield f"cut off {before:.2f} s of standing still at the start, {after:.2f} s at the end"


def in_plain_seconds(
    t: Array, notes: list[str], fail: Callable[[str, str], RecordingError]
) -> Array:
    """Stamps that are meant to be seconds, in seconds if they can only be another unit."""
    moving = np.diff(t)[np.diff(t) > 0.0]
    if len(moving) < 3 or np.median(moving) <= GAP or (t[-1] - t[0]) / len(t) <= GAP:
        return t
    unit = unit_of(t - t[0])
    if unit is None or unit in ("s", "iso", "frames"):
        raise fail(
            f"the samples are {np.median(moving):g} s apart, if time is in seconds",
            "Frame numbers, or another unit? Write time in s; or bring the file in with "
            "drake-screw import, and time_unit: ms (say) or rate: 100 (Hz) in recording.yaml.",
        )
    notes.append(f"time is in {unit}, not in s: taken as that, {in_seconds(t, unit)[-1]:.2f} s")
    return in_seconds(t, unit)


def _counted_on(
    recording: Recording, q: Array, lower: Array, upper: Array, notes: list[str]
) -> Array:
    if not is_endless(lower, upper).any():
        return q
    smooth = unwrapped(q, is_endless(lower, upper))
    changed = (np.abs(smooth - q) > np.pi).any(axis=0)
    if changed.any():
        names = np.array(recording.joint_names)[changed]
        notes.append(f"counted {', '.join(names)} on through full turns, from near 0")
    return np.where(changed, smooth, q)


def _within_limits(
    recording: Recording,
    q: Array,
    lower: Array,
    upper: Array,
    units: Sequence[str],
    notes: list[str],
    fail: Callable[[int, str, str], RecordingError],
) -> Array:
    if not _any_joint(q, _beyond, lower, upper).any():
        return q
    beyond = np.maximum(lower - q, q - upper)
    outside = beyond > CLAMPED_WITHIN
    if outside.any():
        row, column = (int(i) for i in np.unravel_index(int(np.argmax(outside)), q.shape))
        name, value = recording.joint_names[column], q[row, column]
        if np.abs(q[:, [unit == "rad" for unit in units]]).max(initial=0.0) > 2.0 * np.pi:
            raise fail(
                row,
                f"{name} is at {value:.4g}; angles beyond 2 pi look like degrees",
                "Convert the angles to radians.",
            )
        raise fail(
            row,
            f"{name} is at {value:.4f}, outside its limits {lower[column]:.4f} .. "
            f"{upper[column]:.4f} {units[column]}",
            "Check that the recording and the model are of the same robot, or record again.",
        )
    if (beyond > 0.0).any():
        for unit, small in (("rad", "mrad"), ("m", "mm")):
            most = beyond.max(axis=0) * [one == unit for one in units]
            names = [n for n, by in zip(recording.joint_names, most, strict=True) if by > 0.0]
            if names:
                by = f"{most.max() * 1e3:.2f} {small}"
                notes.append(f"clamped {', '.join(names)} to the limit (beyond it by {by})")
        return np.clip(q, lower, upper)
    return q
