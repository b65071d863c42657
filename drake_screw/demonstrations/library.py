"""Recordings on disk: a folder is a recording, a folder of such folders is a library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from drake_screw.demonstrations.baxter_csv import csv_text, read_csv, read_rows
from drake_screw.demonstrations.hand_poses import checked_hand, hand_csv, read_hand_csv
from drake_screw.demonstrations.recording import Recording, checked
from drake_screw.errors import RecordingError, counted
from drake_screw.files import printable
from drake_screw.screws import normalized
from drake_screw.typing import Array, PathLike

JOINTS, OBJECTS, REGION = "joint_angles.csv", "object_poses.csv", "region_of_interest.txt"
HAND = "hand_poses.csv"
"""In the place of JOINTS, where the hand was recorded and the joints were not."""
TASK = "task_objects.txt"


def read_recording(
    folder: PathLike,
    joint_names: Sequence[str],
    lower: Array,
    upper: Array,
    *,
    objects: int | None = None,
    velocity_limits: Array | None = None,
) -> Recording:
    """Read and check one recording.

    Args:
        folder: holds joint_angles.csv, object_poses.csv (a 4x4 matrix X_WO per object, stacked)
            and perhaps region_of_interest.txt (a factor) and task_objects.txt (a line for the name
            of each object that the end effector works on).
        joint_names: the arm's n joints.
        lower, upper: (n,) limits, rad or m.
        objects: how many object poses there must be; any number if None.
        velocity_limits: (n,) rad/s or m/s; how fast the arm moves is not looked at if None.

    Raises:
        RecordingError: with file and line, whatever is wrong.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise RecordingError(
            "no such folder", file=folder, remedy=f"A recording is a folder with {JOINTS}."
        )
    if (folder / HAND).is_file():
        return _of_hand(folder, objects)
    t, q, lines = read_csv(folder / JOINTS, joint_names)
    X_WO = _poses_of(folder, objects)
    recording = Recording(
        printable(folder.name),
        tuple(joint_names),
        t,
        q,
        X_WO,
        _factor(folder / REGION),
        source=folder.resolve(),
        task_objects=_task_objects(folder / TASK),
    )
    return checked(
        recording,
        lower,
        upper,
        file=folder / JOINTS,
        lines=lines,
        velocity_limits=velocity_limits,
    )


def read_library(
    folder: PathLike,
    joint_names: Sequence[str],
    lower: Array,
    upper: Array,
    *,
    objects: int | None = None,
    velocity_limits: Array | None = None,
) -> tuple[Recording, ...]:
    """All recordings in a folder, sorted by name.

    Args:
        folder: of folders, each a recording.
        joint_names: the arm's n joints.
        lower, upper: (n,) limits, rad or m.
        objects: how many object poses each must have; any number if None.
        velocity_limits: (n,) rad/s or m/s; how fast the arm moves is not looked at if None.

    Raises:
        RecordingError: there is no recording in it, or one of them cannot be used.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise RecordingError(
            "no such file or folder" if not folder.exists() else "no folder of recordings",
            file=folder,
            remedy="Give a folder of recordings, or a file that `drake-screw import` reads.",
        )
    if is_recording(folder):
        raise RecordingError(
            "this is one recording, not a folder of recordings",
            file=folder,
            remedy=f"Give the folder it stands in: {folder.resolve().parent}",
        )
    found = sorted(item for item in folder.iterdir() if is_recording(item))
    if not found:
        raise RecordingError(
            f"no recordings here: no subfolder has a {JOINTS}",
            file=folder,
            remedy="Each recording is a subfolder, such as demo_01; tables, logs and bags are "
            "brought in with drake-screw import.",
        )
    return tuple(
        read_recording(
            f, joint_names, lower, upper, objects=objects, velocity_limits=velocity_limits
        )
        for f in found
    )


def write_recording(
    recording: Recording, folder: PathLike, held: Mapping[str, float] | None = None
) -> None:
    """Write a recording as the robot's recorder does; `read_recording` reads it back.

    Args:
        recording: to write.
        folder: made if missing.
        held: constant values for the columns of the idle arm and the grippers.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    if recording.X_WE is None:
        text = csv_text(recording.t, recording.q, recording.joint_names, held)
        (folder / JOINTS).write_text(text, encoding="utf-8")
    else:
        (folder / HAND).write_text(hand_csv(recording.t, recording.X_WE), encoding="utf-8")
    np.savetxt(folder / OBJECTS, recording.X_WO.reshape(-1, 4), fmt="%.17g", delimiter=",")
    if recording.region_of_interest is not None:
        (folder / REGION).write_text(f"{recording.region_of_interest:g}\n")
    if recording.task_objects:
        (folder / TASK).write_text(
            "".join(f"{name}\n" for name in recording.task_objects),
            encoding="utf-8",
        )


def read_object_poses(file: PathLike) -> Array:
    """Poses X_WO (k, 4, 4) from a CSV of stacked 4x4 matrices.

    Raises:
        RecordingError: the file is missing or is not a stack of poses.
    """
    remedy = "Write the pose X_WO of each object, a 4x4 matrix, comma-separated."
    rows: list[list[float]] = []
    for number, cells in read_rows(file, remedy):
        try:
            row = [float(cell) for cell in cells]
        except ValueError as error:
            raise RecordingError("not numbers", file=file, line=number) from error
        complete = len(row) == 4 and bool(np.isfinite(row).all())
        wrong_end = (
            len(rows) % 4 == 3 and complete and not np.allclose(row, [0, 0, 0, 1], atol=1e-6)
        )
        if not complete or wrong_end:
            raise RecordingError(
                "not a row of a pose"
                + ("; every fourth row must be 0,0,0,1" if wrong_end else ": expected 4 numbers"),
                remedy="Write 4x4 matrices, comma-separated, one below the other.",
                file=file,
                line=number,
            )
        rows.append(row)
    if not rows or len(rows) % 4:
        raise RecordingError(f"{len(rows)} rows; 4 for each object are needed", file=file)
    X_WO = np.array(rows).reshape(-1, 4, 4)
    R = X_WO[:, :3, :3]
    with np.errstate(over="ignore", invalid="ignore"):
        off = np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3)).max()
    if not off <= 1e-3 or (np.linalg.det(R) < 0).any():
        raise RecordingError(
            "the 3x3 part of a matrix is not a rotation",
            remedy="Its columns must be unit vectors at right angles, right-handed.",
            file=file,
        )
    return normalized(X_WO)


def is_recording(folder: Path) -> bool:
    """Whether a folder is one: it has joint angles, or hand poses."""
    return (folder / JOINTS).is_file() or (folder / HAND).is_file()


def _of_hand(folder: Path, objects: int | None) -> Recording:
    """A recording of hand poses.

    Raises:
        RecordingError: with file and line, whatever is wrong.
    """
    file = folder / HAND
    t, X_WE, lines = read_hand_csv(file)
    X_WO = _poses_of(folder, objects)
    recording = Recording(
        printable(folder.name),
        (),
        t,
        np.zeros((len(t), 0)),
        X_WO,
        _factor(folder / REGION),
        source=folder.resolve(),
        task_objects=_task_objects(folder / TASK),
        X_WE=X_WE,
    )
    return checked_hand(recording, file=file, lines=lines)


def _poses_of(folder: Path, objects: int | None) -> Array:
    X_WO = read_object_poses(folder / OBJECTS)
    if objects is not None and len(X_WO) != objects:
        raise RecordingError(
            f"{counted(len(X_WO), 'object pose')}, where the scenario has "
            f"{counted(objects, 'object')}",
            remedy="Stack one 4x4 matrix for each object, in the scenario's order.",
            file=folder / OBJECTS,
        )
    return X_WO


def _factor(file: Path) -> float | None:
    if not file.is_file():
        return None
    try:
        factor = float(file.read_text())
    except ValueError as error:
        raise RecordingError("expected one number, a factor of at least 1", file=file) from error
    if not factor >= 1.0:
        raise RecordingError(f"the factor {factor:g} is below 1", file=file)
    return factor


def _task_objects(file: Path) -> tuple[str, ...]:
    if not file.is_file():
        return ()
    try:
        names = [line.strip() for line in file.read_text(encoding="utf-8-sig").splitlines()]
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"cannot be read: {error}", file=file) from error
    return tuple(name for name in names if name)
