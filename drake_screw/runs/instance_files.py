"""Files that task instances are read from, a block at a time: CSV and Parquet, by their endings."""

from __future__ import annotations

import csv
import gzip
import io
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from drake_screw.errors import ScenarioError, extra
from drake_screw.typing import Array

ROWS = 1 << 15
"""Of a block."""

BUFFER = 1 << 20  # bytes of a column of a Parquet file that are read at a time

PARQUET, GZIP = ".parquet", ".gz"


@dataclass(frozen=True, eq=False)
class Block:
    """Some rows of a table.

    Attributes:
        numbers: (m, c) of the columns asked for; NaN where a cell holds no number.
        cell: what stands in a row and column of `numbers`, in words.
        lines: (m,) of the rows in the file; where it has no lines, their numbers from 1.
        read: the part of the file that has been read, 0 to 1; None where that is not known.
    """

    numbers: Array
    cell: Callable[[int, int], str]
    lines: Sequence[int]
    read: float | None


class InstanceFile(Protocol):
    """A table that is open.

    Attributes:
        names: of its columns.
        header: the line that they stand in; None where the file has no lines.
    """

    names: tuple[str, ...]
    header: int | None

    def blocks(self, columns: Sequence[int]) -> Iterator[Block]:
        """The rows, with these columns, by their places."""
        ...


def is_parquet(file: Path) -> bool:
    """Whether a file's name says that it is Parquet; else it is CSV.

    Raises:
        ScenarioError: it says that it is Parquet within gzip.
    """
    if file.suffix.lower() == GZIP and Path(file.stem).suffix.lower() == PARQUET:
        raise ScenarioError(
            "Parquet is compressed already, and is not read or written within gzip",
            remedy=f"Name it {file.stem}, or .csv.gz.",
            file=file,
        )
    return file.suffix.lower() == PARQUET


def parquet_modules(file: Path) -> tuple[Any, Any]:
    """pyarrow and pyarrow.parquet.

    Raises:
        ScenarioError: they are not installed.
    """
    with extra("parquet", "Parquet files need pyarrow", ScenarioError, file):
        import pyarrow
        import pyarrow.parquet
    return pyarrow, pyarrow.parquet


def open_instances(file: Path) -> AbstractContextManager[InstanceFile]:
    """A context in which a table is open.

    Raises:
        ScenarioError: there is none, it is not what its ending says, or is damaged.
    """
    return _parquet(file) if is_parquet(file) else _csv(file)


@contextmanager
def _csv(file: Path) -> Iterator[InstanceFile]:
    with ExitStack() as stack:
        try:
            raw = stack.enter_context(file.open("rb"))
            size = file.stat().st_size
            zipped = file.suffix.lower() == GZIP
            content = stack.enter_context(gzip.open(raw)) if zipped else raw
            text = io.TextIOWrapper(content, encoding="utf-8-sig", newline="")
            yield _Csv(csv.reader(text), lambda: raw.tell() / size if size else None)
        except (OSError, UnicodeDecodeError, EOFError, zlib.error, csv.Error) as error:
            raise ScenarioError(
                f"cannot be read: {getattr(error, 'strerror', None) or error}",
                remedy="Give a CSV file, UTF-8, with the columns x and y.",
                file=file,
            ) from error


class _Csv:
    """A CSV with a header; lines without a cell are passed over."""

    def __init__(self, rows: Any, part: Callable[[], float | None]) -> None:
        self._rows, self._part = rows, part
        self.names = tuple(name.strip() for name in next(rows, []))
        self.header: int | None = 1

    def blocks(self, columns: Sequence[int]) -> Iterator[Block]:
        while True:
            kept: list[list[str]] = []
            lines: list[int] = []
            for row in self._rows:
                if row:
                    kept.append(row)
                    lines.append(self._rows.line_num)
                    if len(kept) == ROWS:
                        break
            if not kept:
                return
            numbers = np.stack([_floats(kept, column) for column in columns], axis=-1)

            def cell(row: int, column: int, kept: list[list[str]] = kept) -> str:
                cells, place = kept[row], columns[column]
                return repr(cells[place]) if place < len(cells) else "nothing"

            yield Block(numbers, cell, lines, self._part())


def _floats(rows: Sequence[Sequence[str]], column: int) -> Array:
    try:
        return np.array([float(row[column]) for row in rows])
    except (ValueError, IndexError):
        return np.array([_number(row, column) for row in rows])


def _number(row: Sequence[str], column: int) -> float:
    try:
        return float(row[column])
    except (ValueError, IndexError):
        return float("nan")


@contextmanager
def _parquet(file: Path) -> Iterator[InstanceFile]:
    pa, pq = parquet_modules(file)
    try:
        with pq.ParquetFile(file, buffer_size=BUFFER, pre_buffer=False) as opened:
            yield _Parquet(pa, opened)
    except (OSError, pa.ArrowException) as error:
        raise ScenarioError(
            f"cannot be read: {getattr(error, 'strerror', None) or error}",
            remedy="Give a Parquet file with the columns x and y.",
            file=file,
        ) from error


class _Parquet:
    """A Parquet file; its rows are counted from 1."""

    def __init__(self, pa: Any, opened: Any) -> None:
        self.header: int | None = None
        self._pa, self._opened = pa, opened
        self.names = tuple(opened.schema_arrow.names)

    def blocks(self, columns: Sequence[int]) -> Iterator[Block]:
        first, N = 1, self._opened.metadata.num_rows
        names = [self.names[column] for column in columns]
        for batch in self._opened.iter_batches(ROWS, columns=names, use_threads=False):
            found = [batch.column(name) for name in names]
            numbers = np.stack([self._floats(column) for column in found], axis=-1)

            def cell(row: int, column: int, found: list[Any] = found) -> str:
                value = found[column][row].as_py()
                return "nothing" if value is None else repr(value)

            lines = range(first, first := first + len(batch))
            yield Block(numbers, cell, lines, (first - 1) / N)

    def _floats(self, column: Any) -> Array:
        """NaN where there is nothing, and throughout if the column's type is not of numbers."""
        types, kind = self._pa.types, column.type
        if not (types.is_integer(kind) or types.is_floating(kind) or types.is_decimal(kind)):
            return np.full(len(column), np.nan)
        numbers = column.cast(self._pa.float64(), safe=False).to_numpy(zero_copy_only=False)
        return np.asarray(numbers, dtype=float)
