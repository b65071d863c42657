"""The CSV of Baxter's own recorder: a time column, then a column a joint, matched by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from drake_screw.errors import RecordingError, nearest
from drake_screw.typing import Array

_ARM = ("s0", "s1", "e0", "e1", "w0", "w1", "w2", "gripper")
COLUMNS = tuple(f"{side}_{joint}" for side in ("left", "right") for joint in _ARM)


def read_csv(file: Path, joint_names: Sequence[str]) -> tuple[Array, Array, Array]:
    """Read the columns of some joints.

    Args:
        file: CSV with a header; other columns are passed over.
        joint_names: n of its columns.

    Returns:
        t (m,) s, q (m, n) as written, and the line (m,) of each sample in the file.

    Raises:
        RecordingError: the file is missing or empty, lacks a column, or has a row that is not
            numbers.
    """
    lines = read_lines(file, "A recording is a folder with this file in it.")
    header = [name.strip() for name in lines[0].split(",")] if lines else []
    wanted = ["time", *joint_names]
    for name in wanted:
        if name not in header:
            guess = nearest(name, header)
            raise RecordingError(
                f"no column '{name}'",
                remedy=(f"Did you mean '{guess}'? " if guess else "")
                + f"Columns found: {', '.join(header) or 'none'}",
                file=file,
                line=1,
            )
    columns = [header.index(name) for name in wanted]
    rows, where = [], []
    for number, line in enumerate(lines[1:], start=2):
        if not line.strip():
            continue
        cells = line.split(",")
        if len(cells) != len(header):
            raise RecordingError(
                f"{len(cells)} cells where the header has {len(header)}",
                remedy="The row was cut off or has a stray comma; delete or repair it.",
                file=file,
                line=number,
            )
        try:
            rows.append([float(cells[i]) for i in columns])
        except ValueError as error:
            raise RecordingError(
                f"not a number: {error.args[0].split(': ')[-1]}", file=file, line=number
            ) from error
        where.append(number)
    table = np.array(rows, dtype=float).reshape(len(rows), len(wanted))
    return table[:, 0], table[:, 1:], np.array(where, dtype=int)


def read_lines(file: Path, remedy: str) -> list[str]:
    """The lines of a text file.

    Raises:
        RecordingError: the file is missing, for which there is a remedy, or is not text.
    """
    try:
        return file.read_text(encoding="utf-8-sig").splitlines()
    except FileNotFoundError as error:
        raise RecordingError("no such file", file=file, remedy=remedy) from error
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"cannot be read: {error}", file=file) from error


def csv_text(
    t: Array, q: Array, joint_names: Sequence[str], held: Mapping[str, float] | None = None
) -> str:
    """The recorder's CSV of a joint path.

    Where the joints are Baxter's, both arms and grippers get their columns, as its playback
    program wants them; any other arm gets just its own.

    Args:
        t: (m,) s.
        q: (m, n) rad.
        joint_names: n names.
        held: constant values of other columns (rad; grippers 0 to 100); 0 if not named, 100
            for grippers.
    """
    names = list(joint_names)
    columns = COLUMNS if set(names) <= set(COLUMNS) else tuple(names)
    held = held or {}
    table = np.empty((len(t), len(columns)))
    for i, name in enumerate(columns):
        default = 100.0 if name.endswith("gripper") else 0.0
        table[:, i] = q[:, names.index(name)] if name in names else held.get(name, default)
    rows = [
        f"{time:.6f}," + ",".join(f"{value:.12g}" for value in row)
        for time, row in zip(t, table.tolist(), strict=True)
    ]
    return "\n".join([",".join(["time", *columns]), *rows]) + "\n"
