"""Tables of task instances in, tables of outcomes out."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from drake_screw.errors import ScenarioError, suggestion
from drake_screw.files import csv_text
from drake_screw.planning import Outcomes
from drake_screw.tasks import FARTHEST, PLANAR, WorkArea
from drake_screw.typing import Array


def read_instances(file: Path, area: WorkArea) -> Array:
    """Read task instances from a CSV with a header.

    Columns are x, y, z (m) and yaw, roll, pitch (rad) of the only object, or bowl.x and so on where
    there are several. What the work area fixes may go without a column, and is then as it says;
    what varies may not. Other columns are passed over.

    Returns:
        coordinates: (N, k, c).

    Raises:
        ScenarioError: with file and line, whatever is wrong.
    """
    try:
        rows = list(csv.reader(io.StringIO(file.read_text(encoding="utf-8-sig"))))
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioError(
            f"cannot be read: {getattr(error, 'strerror', None) or error}",
            remedy="Give a CSV file with the columns x and y.",
            file=file,
        ) from error
    header = [name.strip() for name in rows[0]] if rows else []
    coordinates = np.tile(area.lower, (max(len(rows) - 1, 0), 1, 1))
    columns: dict[int, tuple[int, int]] = {}
    for i in range(len(area.objects)):
        for j, axis in enumerate(area.axes):
            name = column_name(area, i, axis)
            if name in header:
                columns[header.index(name)] = (i, j)
            elif area.free[i, j]:
                raise ScenarioError(
                    f"no column '{name}', and it varies",
                    remedy=suggestion(name, header, "Columns found"),
                    file=file,
                    line=1,
                )
    kept = []
    for number, row in enumerate(rows[1:], start=2):
        if not row:
            continue
        for column, (i, j) in columns.items():
            try:
                value = float(row[column])
            except (ValueError, IndexError):
                value = float("nan")
            if not abs(value) <= FARTHEST:
                found = row[column] if column < len(row) else "nothing"
                raise ScenarioError(
                    f"{header[column]} is {found!r}, expected a number from -{FARTHEST:g} to "
                    f"{FARTHEST:g}",
                    file=file,
                    line=number,
                )
            coordinates[number - 2, i, j] = value
        kept.append(number - 2)
    if not kept:
        raise ScenarioError("no instances in this file", file=file)
    return coordinates[kept]


def unlike_fixed(coordinates: Array, area: WorkArea) -> dict[str, int]:
    """How many of the instances (N, k, c) have another number where the work area fixes one.

    Returns:
        By the column's name, where there are any: they lie outside the work area.
    """
    unlike = (np.abs(coordinates - area.lower) > 1e-9).sum(axis=0)
    return {
        column_name(area, i, area.axes[j]): int(unlike[i, j])
        for i, j in np.argwhere(~area.free & (unlike > 0))
    }


def column_name(area: WorkArea, i: int, axis: str) -> str:
    """The column of an axis of object i: named after the object where there are several."""
    return axis if len(area.objects) == 1 else f"{area.objects[i].name}.{axis}"


def outcomes_csv(
    coordinates: Array,
    outcomes: Outcomes,
    names: list[str],
    area: WorkArea,
    turns: Mapping[str, Array] | None = None,
    touching: Mapping[str, Sequence[str]] | None = None,
) -> str:
    """A row for each instance: where it is, then the outcome code of each demonstration.

    Codes are ``Outcomes.codes``; a yaw has a column where it varies, and so have z, roll and
    pitch, which may vary.

    Args:
        coordinates: (N, k, c) m and rad.
        outcomes: (N, D).
        names: of the D demonstrations.
        area: names the k objects.
        turns: further columns (N,) of angles in rad, by their names: how bodies are turned.
        touching: further columns (N,) of words, by their names: what touches.
    """
    header, cells = [], []
    for i in range(len(area.objects)):
        for j, axis in enumerate(area.axes):
            values = coordinates[:, i, j]
            if axis == "yaw" and np.all(values == values[0]):
                continue
            if j >= PLANAR and not area.free[i, j] and np.all(values == area.lower[i, j]):
                continue
            header.append(column_name(area, i, axis))
            cells.append([f"{v:.9g}" for v in values.tolist()])
    cells += outcomes.codes().T.tolist()
    turns = turns or {}
    cells += [[f"{v:.4f}" for v in column.tolist()] for column in turns.values()]
    touching = touching or {}
    cells += [list(column) for column in touching.values()]
    return csv_text([[*header, *names, *turns, *touching], *zip(*cells, strict=True)])
