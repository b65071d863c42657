"""Files that outcomes are written to, a block at a time: CSV and Parquet, by their endings."""

from __future__ import annotations

import csv
import gzip
import io
from collections.abc import Collection, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from drake_screw.files import appearing
from drake_screw.runs.instance_files import GZIP, ROWS, is_parquet, parquet_modules

LEVEL = 6  # of gzip


@dataclass(frozen=True, eq=False)
class Column:
    """A column of a block.

    Attributes:
        name: its header.
        values: (m,) of float or words.
        format: of numbers in text: ".4f", say.
        dispensable: whether it is left out where it is empty in all blocks.
    """

    name: str
    values: NDArray[Any]
    format: str = ""
    dispensable: bool = False


class OutcomeFile:
    """A table that is written.

    Args:
        file: where it is to be, with everything.
        kind: writes and reads it.
    """

    def __init__(self, file: Path, kind: _Kind) -> None:
        self._file, self._kind = file, kind
        self._empty: dict[int, str] = {}
        self._begun = False

    def add(self, columns: Sequence[Column]) -> None:
        """Takes the next block, with the columns that all of them have."""
        if not self._begun:
            self._begun = True
            self._empty = {i: c.name for i, c in enumerate(columns) if c.dispensable}
        for place in list(self._empty):
            if (columns[place].values != "").any():
                del self._empty[place]
        self._kind.add(columns)

    def end(self) -> Collection[int]:
        """No more blocks come; the places of columns to be left out."""
        self._kind.close()
        return tuple(self._empty)


@contextmanager
def outcome_file(file: Path) -> Iterator[OutcomeFile]:
    """A context in which a table is written, and after which it is there whole.

    The same blocks make the same file, to the byte, whenever and wherever they are written.

    Raises:
        OSError: it cannot be written.
        ScenarioError: it is to be Parquet, and pyarrow is not installed.
    """
    make = _Parquet if is_parquet(file) else _Csv
    with appearing(file) as part, ExitStack() as stack:
        kind = make(file, part)
        stack.callback(kind.close)
        table = OutcomeFile(part, kind)
        yield table
        left_out = table.end()
        if left_out:
            _leave_out(make, file, part, left_out)


def _leave_out(
    make: type[_Csv] | type[_Parquet], file: Path, part: Path, left_out: Collection[int]
) -> None:
    """Write a table again without some of its columns."""
    fewer = part.with_name(f"{part.name}.fewer")
    try:
        make.copy(file, part, fewer, left_out)
        fewer.replace(part)
    finally:
        with suppress(OSError):
            fewer.unlink(missing_ok=True)


class _Kind(Protocol):
    def add(self, columns: Sequence[Column]) -> None: ...
    def close(self) -> None: ...


class _Csv:
    """Text; it is gzipped where the ending says so."""

    def __init__(self, file: Path, part: Path) -> None:
        self._text = _text(part, "wb", zipped=file.suffix.lower() == GZIP)
        self._rows = csv.writer(self._text, lineterminator="\n")
        self._begun = False

    def add(self, columns: Sequence[Column]) -> None:
        if not self._begun:
            self._rows.writerow([column.name for column in columns])
            self._begun = True
        self._rows.writerows(zip(*map(_cells, columns), strict=True))

    def close(self) -> None:
        self._text.close()

    @staticmethod
    def copy(file: Path, source: Path, target: Path, left_out: Collection[int]) -> None:
        zipped = file.suffix.lower() == GZIP
        with _text(source, "rb", zipped=zipped) as old, _text(target, "wb", zipped=zipped) as new:
            rows = csv.writer(new, lineterminator="\n")
            for row in csv.reader(old):
                rows.writerow([cell for i, cell in enumerate(row) if i not in left_out])


def _text(file: Path, mode: str, *, zipped: bool) -> io.TextIOWrapper:
    content: Any = _Gzip(file, mode) if zipped else file.open(mode)
    return io.TextIOWrapper(content, encoding="utf-8", newline="")


class _Gzip(gzip.GzipFile):
    """A gzipped file in which neither its name nor a time stands."""

    def __init__(self, file: Path, mode: str) -> None:
        self._raw: Any = file.open(mode)
        super().__init__("", mode, LEVEL, self._raw, mtime=0)

    def close(self) -> None:
        try:
            super().close()
        finally:
            self._raw.close()


def _cells(column: Column) -> list[str]:
    values: list[Any] = column.values.tolist()
    if not _is_number(column):
        return values
    return [format(value, column.format) for value in values]


class _Parquet:
    """Numbers as 64-bit floats, words as strings; a block is a row group."""

    def __init__(self, file: Path, part: Path) -> None:
        self._pa, self._pq = parquet_modules(file)
        self._part = part
        self._writer: Any = None

    def add(self, columns: Sequence[Column]) -> None:
        pa = self._pa
        arrays = [
            pa.array(column.values, type=pa.float64() if _is_number(column) else pa.string())
            for column in columns
        ]
        table = pa.Table.from_arrays(arrays, names=[column.name for column in columns])
        if self._writer is None:
            self._writer = self._pq.ParquetWriter(self._part, table.schema)
        self._writer.write_table(table)

    def close(self) -> None:
        if self._writer is not None:
            self._writer.close()

    @staticmethod
    def copy(file: Path, source: Path, target: Path, left_out: Collection[int]) -> None:
        pa, pq = parquet_modules(file)
        with pq.ParquetFile(source, pre_buffer=False) as old:  # not all of it at once
            kept = [i for i in range(len(old.schema_arrow)) if i not in left_out]
            schema = pa.schema([old.schema_arrow.field(i) for i in kept])
            with pq.ParquetWriter(target, schema) as new:
                for batch in old.iter_batches(ROWS, use_threads=False):
                    arrays = [batch.column(i) for i in kept]
                    new.write_table(pa.Table.from_arrays(arrays, schema=schema))


def _is_number(column: Column) -> bool:
    return bool(np.issubdtype(column.values.dtype, np.floating))
