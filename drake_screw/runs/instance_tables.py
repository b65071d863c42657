"""Tables of task instances: what their columns mean, and the instances, however many."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drake_screw.errors import DrakeScrewError, ScenarioError, suggestion
from drake_screw.runs.instance_files import Block, InstanceFile, open_instances
from drake_screw.steps import Step, Tell, to_nobody
from drake_screw.tables.rows import Rows
from drake_screw.tasks import FARTHEST, PLANAR, WorkArea, column_name, other_names
from drake_screw.typing import Array

MEMORY = 1 << 22
"""bytes of instances, with more of which they are kept in a temporary file."""

SAME = 1e-9  # m or rad, within which a number is what the work area fixes


class Instances:
    """Task instances that were read, and looked at, a block at a time.

    Args:
        area: they are in, or ought to be.

    Raises:
        OSError: there is no room for temporary files.
    """

    def __init__(self, area: WorkArea) -> None:
        self._area, shape = area, area.lower.shape
        self._rows = Rows(area.lower.size, MEMORY)
        self._first: Array | None = None
        self._vary = np.zeros(shape, dtype=bool)
        self._unlike = np.zeros(shape, dtype=np.int64)
        self._moved = np.zeros(shape, dtype=bool)

    def __len__(self) -> int:
        return len(self._rows)

    def add(self, coordinates: Array) -> None:
        """Takes more of them (m, k, c), one at least."""
        if self._first is None:
            self._first = coordinates[0].copy()
        self._vary |= (coordinates != self._first).any(axis=0)
        self._unlike += (np.abs(coordinates - self._area.lower) > SAME).sum(axis=0)
        self._moved |= (coordinates != self._area.lower).any(axis=0)
        self._rows.add(coordinates.reshape(len(coordinates), -1))

    def blocks(self) -> Iterator[Array]:
        """Their coordinates (m, k, c), m and rad, as they were added."""
        for rows in self._rows.blocks():
            yield rows.reshape(-1, *self._area.lower.shape)

    @property
    def columns(self) -> tuple[tuple[int, int], ...]:
        """Object and axis, by number, of what a table says of them.

        That is x and y; a yaw where it differs among them; z, roll and pitch where they may vary,
        or are not what the work area fixes.
        """
        shown = np.ones(self._vary.shape, dtype=bool)
        for j, axis in enumerate(self._area.axes):
            if axis == "yaw":
                shown[:, j] = self._vary[:, j]
            elif j >= PLANAR:
                shown[:, j] = self._area.free[:, j] | self._moved[:, j]
        return tuple((int(i), int(j)) for i, j in np.argwhere(shown))

    @property
    def unlike_fixed(self) -> dict[str, int]:
        """How many have another number where the work area fixes one, by the column's name.

        Only where there are any: they lie outside the work area.
        """
        return {
            column_name(self._area, i, self._area.axes[j]): int(self._unlike[i, j])
            for i, j in np.argwhere(~self._area.free & (self._unlike > 0))
        }


def read_instances(file: Path, area: WorkArea, tell: Tell = to_nobody) -> Instances:
    """Read task instances from a CSV with a header, gzipped or not, or from Parquet, by its ending.

    Columns are x, y, z (m) and yaw, roll, pitch (rad) of the only object, or bowl.x and so on of
    any. What the work area fixes may go without a column, and is then as it says; what varies may
    not. Other columns are passed over. Every row is looked at, and memory does not grow with them.

    Args:
        file: of any length.
        area: says which columns there may be.
        tell: told how much has been read.

    Raises:
        ScenarioError: with file and line, whatever is wrong.
        DrakeScrewError: there is no room for temporary files.
    """
    words = f"reading {file.name}"
    tell(Step(words))
    with open_instances(file) as opened:
        places = _places(file, opened, area)
        found = _empty(area)
        for block in opened.blocks([column for column, _ in places]):
            _check(file, opened, block, [opened.names[column] for column, _ in places])
            coordinates = np.tile(area.lower, (len(block.numbers), 1, 1))
            for values, (_, (i, j)) in zip(block.numbers.T, places, strict=True):
                coordinates[:, i, j] = values
            _keep(found, coordinates)
            if block.read is not None:
                tell(Step(words, block.read, 1.0))
    if len(found) == 0:
        raise ScenarioError("no instances in this file", file=file)
    return found


def _empty(area: WorkArea) -> Instances:
    try:
        return Instances(area)
    except OSError as error:
        raise _no_room(error) from error


def _keep(found: Instances, coordinates: Array) -> None:
    try:
        found.add(coordinates)
    except OSError as error:
        raise _no_room(error) from error


def _no_room(error: OSError) -> DrakeScrewError:
    return DrakeScrewError(
        f"instances cannot be kept in the temporary folder: {error.strerror or error}",
        remedy="Set TMPDIR to a folder with room for 8 bytes for each coordinate of an instance.",
        file=tempfile.gettempdir(),
    )


def _places(file: Path, opened: InstanceFile, area: WorkArea) -> list[tuple[int, tuple[int, int]]]:
    """The places of columns in the file, with the object and axis that each is of."""
    names, places = opened.names, []
    for i in range(len(area.objects)):
        for j, axis in enumerate(area.axes):
            wanted = column_name(area, i, axis)
            there = [
                place
                for place, name in enumerate(names)
                if name in (wanted, *other_names(area, i, axis))
            ]
            if len(there) > 1:
                twice = " and ".join(f"'{names[place]}'" for place in there)
                raise ScenarioError(
                    f"the columns {twice} mean the same",
                    remedy="Delete one, or rename it if it is something else.",
                    file=file,
                    line=opened.header,
                )
            if there:
                places.append((there[0], (i, j)))
            elif area.free[i, j]:
                raise ScenarioError(
                    f"no column '{wanted}', and it varies",
                    remedy=suggestion(wanted, names, "Columns found"),
                    file=file,
                    line=opened.header,
                )
    return places


def _check(file: Path, opened: InstanceFile, block: Block, names: Sequence[str]) -> None:
    """Refuse a cell that is no number or is too large."""
    wrong: NDArray[np.bool_] = ~(np.abs(block.numbers) <= FARTHEST)
    if not wrong.any():
        return
    row, column = (int(k) for k in np.argwhere(wrong)[0])
    line = block.lines[row]
    where = "" if opened.header is not None else f"row {line:,}: "
    raise ScenarioError(
        f"{where}{names[column]} is {block.cell(row, column)}, expected a number from "
        f"-{FARTHEST:g} to {FARTHEST:g}",
        file=file,
        line=None if opened.header is None else line,
    )
