"""A table in memory: columns by name, and where in its file each row stands."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_screw.errors import RecordingError, suggestion
from drake_screw.typing import Array

LISTED = 40
"""Most columns that a message names."""


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of one length.

    Attributes:
        columns: by name, in the file's order: (m,) of float where all cells are numbers, else of
            str.
        lines: (m,) the line of each row in the file, or its number where the file has no lines.
        file: that it was read from.
        header: the line of the header; None where there is none, and columns have numbers.
        about: how it is written, in words.
    """

    columns: Mapping[str, NDArray[Any]]
    lines: NDArray[np.int64]
    file: Path | None = None
    header: int | None = None
    about: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Of the columns, in the file's order."""
        return tuple(self.columns)

    @cached_property
    def numeric(self) -> tuple[str, ...]:
        """Names of the columns in which every cell is a number."""
        return tuple(name for name, column in self.columns.items() if column.dtype.kind == "f")

    def __len__(self) -> int:
        return len(self.lines)

    def without_columns(self) -> Table:
        """Where its rows are, and no more."""
        return replace(self, columns={})

    def numbers(self, name: str) -> Array:
        """A column (m,) as numbers.

        Raises:
            RecordingError: there is no such column, or a cell is not a number.
        """
        self.require([name])
        column = self.columns[name]
        if column.dtype.kind == "f":
            return column
        for row, cell in enumerate(column):
            try:
                float(cell)
            except ValueError as error:
                raise RecordingError(
                    f"not a number: '{cell}'",
                    remedy=f"It is in column '{name}'.",
                    file=self.file,
                    line=int(self.lines[row]),
                ) from error
        return column.astype(float)

    def require(self, names: Iterable[str], remedy: str = "") -> None:
        """Check that there are columns of these names.

        Args:
            names: wanted.
            remedy: said after the columns that there are.

        Raises:
            RecordingError: one is missing.
        """
        for name in names:
            if name not in self.columns:
                listed = [*self.names[:LISTED], *(["..."] if len(self.names) > LISTED else [])]
                raise RecordingError(
                    f"no column '{name}'",
                    remedy=suggestion(name, listed, "Columns found") + remedy,
                    file=self.file,
                    line=self.header or 1,
                )

    def rows(self, which: NDArray[Any]) -> Table:
        """Some of the rows, by a mask (m,) or by their numbers."""
        columns = {name: column[which] for name, column in self.columns.items()}
        return replace(self, columns=columns, lines=self.lines[which])

    def renamed(self, columns: Mapping[str, NDArray[Any]]) -> Table:
        """The same rows with other columns."""
        return replace(self, columns=columns)


def from_arrays(columns: Mapping[str, Any], file: Path, about: str = "") -> Table:
    """A table of columns that are arrays already, its rows counted from 1.

    Args:
        columns: by name, each of m numbers or words.
        file: that they come from.
        about: how it is written, in words.
    """
    arrays = {}
    for name, column in columns.items():
        array = np.asarray(column)
        arrays[name] = array.astype(float) if array.dtype.kind in "fiub" else array.astype(object)
    m = len(next(iter(arrays.values()))) if arrays else 0
    return Table(arrays, np.arange(1, m + 1), file, None, about)
