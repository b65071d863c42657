"""Rows of numbers as they are read: in memory or, of long tables, in a file that goes with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from io import SEEK_END
from itertools import pairwise
from tempfile import SpooledTemporaryFile

import numpy as np

from drake_screw.typing import Array


class Rows:
    """Rows, a block at a time; a block's columns lie one after the other.

    Args:
        width: numbers in a row.
        most: bytes that are kept in memory; with more, all are in a temporary file.

    Raises:
        OSError: there is no room on the disk for temporary files.
    """

    def __init__(self, width: int, most: int) -> None:
        self._width, self._ends = width, [0]
        self._file = SpooledTemporaryFile(most)  # noqa: SIM115 - open as long as the rows are

    def __len__(self) -> int:
        return self._ends[-1]

    def add(self, values: Array) -> None:
        """Takes more rows (m, width)."""
        self._file.seek(0, SEEK_END)
        self._file.write(np.ascontiguousarray(values.T).tobytes())
        self._ends.append(len(self) + len(values))

    def column(self, j: int) -> Array:
        """Column j (m,) of all rows."""
        found = np.empty(len(self))
        for begin, end in pairwise(self._ends):
            self._file.seek(8 * (self._width * begin + j * (end - begin)))
            self._file.readinto(found[begin:end].data)
        return found

    def blocks(self) -> Iterator[Array]:
        """The rows again (m, width), as they were added."""
        for begin, end in pairwise(self._ends):
            block = np.empty((self._width, end - begin))
            self._file.seek(8 * self._width * begin)
            self._file.readinto(block.data)
            yield block.T


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
