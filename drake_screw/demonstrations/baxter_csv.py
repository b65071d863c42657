"""The CSV of Baxter's own recorder: a time column, then a column a joint, matched by name."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence

import numpy as np

from drake_screw.errors import RecordingError
from drake_screw.tables import read_table
from drake_screw.typing import Array, PathLike

TIME = "time"
_ROWS = 10_000
_ARM = ("s0", "s1", "e0", "e1", "w0", "w1", "w2", "gripper")
COLUMNS = tuple(f"{side}_{joint}" for side in ("left", "right") for joint in _ARM)


def read_csv(file: PathLike, joint_names: Sequence[str]) -> tuple[Array, Array, Array]:
    """Read the columns of some joints.

    Args:
        file: a table with a header; other columns are passed over.
        joint_names: n of its columns.

    Returns:
        t (m,) s, q (m, n) as written, and the line (m,) of each sample in the file.

    Raises:
        RecordingError: the file is missing or empty, lacks a column, or has a row that is not
            numbers.
    """
    table = read_table(file, remedy="A recording is a folder with this file in it.")
    if TIME not in table.names:
        known = set(joint_names) <= set(table.names)
        table.require(
            [TIME],
            ". Time is in s; of samples at a fixed rate, or in another unit, bring the file in "
            "with drake-screw import."
            if known
            else "",
        )
    table.require(joint_names)
    columns = [table.numbers(name) for name in (TIME, *joint_names)]
    return columns[0], np.stack(columns[1:], axis=1), table.lines


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
    cells = ["%.6f"]
    for name in columns:
        default = 100.0 if name.endswith("gripper") else 0.0
        cells.append("%.12g" if name in names else f"{held.get(name, default):.12g}")
    line = ",".join(cells) + "\n"
    order = [names.index(name) for name in columns if name in names]
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow([TIME, *columns])
    for first in range(0, len(t), _ROWS):
        rows = np.column_stack([t[first : first + _ROWS], q[first : first + _ROWS, order]])
        text.writelines(line % tuple(row) for row in rows.tolist())
    return text.getvalue()
