"""The CSV of Baxter's own recorder: a time column, then a column a joint, matched by name."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence

import numpy as np

from drake_screw.errors import RecordingError, suggestion
from drake_screw.typing import Array, PathLike

_ARM = ("s0", "s1", "e0", "e1", "w0", "w1", "w2", "gripper")
COLUMNS = tuple(f"{side}_{joint}" for side in ("left", "right") for joint in _ARM)


def read_csv(file: PathLike, joint_names: Sequence[str]) -> tuple[Array, Array, Array]:
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
    table = read_rows(file, "A recording is a folder with this file in it.")
    header = [name.strip() for name in table[0][1]] if table else []
    wanted = ["time", *joint_names]
    for name in wanted:
        if name not in header:
            raise RecordingError(
                f"no column '{name}'",
                remedy=suggestion(name, header, "Columns found"),
                file=file,
                line=table[0][0] if table else 1,
            )
    columns = [header.index(name) for name in wanted]
    rows, where = [], []
    for number, cells in table[1:]:
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
    values = np.array(rows, dtype=float).reshape(len(rows), len(wanted))
    return values[:, 0], values[:, 1:], np.array(where, dtype=int)


def read_rows(file: PathLike, remedy: str) -> list[tuple[int, list[str]]]:
    """The rows of a CSV file that are not blank, each with the number of its line.

    Raises:
        RecordingError: the file is missing, for which there is a remedy, or is not CSV.
    """
    try:
        with open(file, encoding="utf-8-sig", newline="") as stream:
            rows = csv.reader(stream, skipinitialspace=True, strict=True)
            return [(rows.line_num, row) for row in rows if row[1:] or any(map(str.strip, row))]
    except FileNotFoundError as error:
        raise RecordingError("no such file", file=file, remedy=remedy) from error
    except csv.Error as error:
        raise RecordingError(
            f"not CSV: {error}",
            remedy="Check the quotation marks on this line.",
            file=file,
            line=rows.line_num,
        ) from error
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
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time", *columns])
    for time, row in zip(t, table.tolist(), strict=True):
        writer.writerow([f"{time:.6f}", *(f"{value:.12g}" for value in row)])
    return text.getvalue()
