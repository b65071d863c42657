"""Rows of numbers as they are read: in memory or, of long tables, in a file that goes with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from tempfile import TemporaryFile
from typing import Protocol

import numpy as np

from drake_screw.typing import Array


class Rows(Protocol):
    """Rows of so many numbers."""

    def __len__(self) -> int: ...

    def add(self, values: Array) -> None:
        """Takes more rows (m, width)."""

    def column(self, j: int) -> Array:
        """Column j of all rows."""


class RowsInMemory:
    """Rows kept as they come."""

    def __init__(self, width: int) -> None:
        self._parts = [np.zeros((0, width))]

    def __len__(self) -> int:
        return sum(map(len, self._parts))

    def add(self, values: Array) -> None:
        """See `Rows`."""
        self._parts.append(values)

    def column(self, j: int) -> Array:
        """See `Rows`."""
        return np.concatenate([part[:, j] for part in self._parts])


class Blocks:
    """Rows in a temporary file, a block at a time; a block's columns lie one after the other.

    Raises:
        OSError: there is no room on the disk for temporary files.
    """

    def __init__(self, width: int) -> None:
        self._width, self._ends = width, [0]
        self._file = TemporaryFile(buffering=0)  # noqa: SIM115 - open as long as the rows are

    def __len__(self) -> int:
        return self._ends[-1]

    def add(self, values: Array) -> None:
        """See `Rows`."""
        if not len(values):
            return
        left = np.ascontiguousarray(values.T).data.cast("B")
        while left:
            left = left[self._file.write(left) or 0 :]
        self._ends.append(len(self) + len(values))

    def column(self, j: int) -> Array:
        """See `Rows`."""
        found = np.empty(len(self))
        for begin, end in zip(self._ends[:-1], self._ends[1:], strict=True):
            self._file.seek(8 * (self._width * begin + j * (end - begin)))
            left = found[begin:end].data.cast("B")
            while left:
                left = left[self._file.readinto(left) or 0 :]
        return found


class Columns(Mapping[str, Array]):
    """Columns of rows by their names, made when they are asked for; of a name's the first."""

    def __init__(self, names: Sequence[str], rows: Rows) -> None:
        self._rows = rows
        self._place: dict[str, int] = {}
        for j, name in enumerate(names):
            self._place.setdefault(name, j)

    def __getitem__(self, name: str) -> Array:
        return self._rows.column(self._place[name])

    def __contains__(self, name: object) -> bool:
        return name in self._place

    def __iter__(self) -> Iterator[str]:
        return iter(self._place)

    def __len__(self) -> int:
        return len(self._place)
