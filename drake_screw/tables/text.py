"""Reading text tables: quickly where all is numbers, otherwise cell by cell.

Numbers are read a block of bytes at a time. A block that is not numbers and nothing else, with as
many in every line, is left to the csv module, which knows what to say of it.
"""

from __future__ import annotations

import codecs
import csv
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from drake_screw.errors import RecordingError
from drake_screw.tables.dialect import SPACE, Dialect, cells_of, check_width, dialect_of
from drake_screw.tables.rows import Columns, Rows
from drake_screw.tables.table import Table
from drake_screw.typing import Array, PathLike

Progress = Callable[[float], None]
"""Called with the part of a file, 0 to 1, that has been read."""

BLOCK = 1 << 22
"""bytes."""
ROWS = 20_000
"""Of a block that is read cell by cell."""
HEAD = 1 << 16
"""bytes, from which the dialect is told."""
LARGE = 1 << 25
"""bytes of numbers, with more of which they are kept on disk until they are asked for."""


def read_table(
    file: PathLike,
    *,
    separator: str | None = None,
    decimal: str | None = None,
    remedy: str | None = None,
    progress: Progress | None = None,
) -> Table:
    """A table from a text file: CSV, TSV, with semicolons or spaces, with or without names.

    Lines at the beginning that start with # are passed over, but names may stand in the last.

    Args:
        file: UTF-8 text.
        separator, decimal: where they are known; told from the first lines otherwise.
        remedy: said if there is no such file.
        progress: told how much has been read.

    Returns:
        The table; columns without names are "column 1" and so on.

    Raises:
        RecordingError: the file is missing or not text, or a row has not as many cells as the
            header.
    """
    file = Path(file)
    say = progress or (lambda part: None)
    try:
        with file.open("rb") as stream:
            head = _head(stream)
            dialect = dialect_of(head, separator, decimal)
            values = _numbers(stream, dialect, file.stat().st_size, say)
        names = dialect.names or tuple(f"column {i + 1}" for i in range(dialect.width))
        header = None if dialect.names is None else dialect.header
        if values is not None:
            lines = dialect.skip + 1 + np.arange(len(values))
            return Table(Columns(names, values), lines, file, header, str(dialect))
        columns, lines = _cells(file, dialect, names, say)
    except FileNotFoundError as error:
        raise RecordingError("no such file", file=file, remedy=remedy) from error
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"cannot be read: {error}", file=file) from error
    return Table(columns, lines, file, header, str(dialect))


def _head(stream: BinaryIO) -> list[str]:
    """The first lines, whole ones only."""
    raw = stream.read(HEAD)
    whole = raw if len(raw) < HEAD else raw[: raw.rfind(b"\n") + 1] or raw
    return whole.decode("utf-8-sig").replace("\r\n", "\n").splitlines(keepends=True)


def _numbers(stream: BinaryIO, dialect: Dialect, size: int, say: Progress) -> Rows | None:
    """All numbers, in rows; None where there is something else, too, or lines are blank."""
    if not dialect.width:
        return None
    found = Rows(dialect.width, LARGE)
    stream.seek(0)
    for _ in range(dialect.skip):
        stream.readline()
    spaces = _to_spaces(dialect)
    rest = b""
    while True:
        read = stream.read(BLOCK)
        block = rest + read
        if read:
            cut = block.rfind(b"\n") + 1
            block, rest = block[:cut], block[cut:]
            if not block:
                continue
        else:
            block = block.rstrip() + b"\n"
        if block.strip():
            values = _block(block, dialect, spaces)
            if values is None:
                return None
            found.add(values)
        elif read:
            return None
        say(min(stream.tell() / max(size, 1), 1.0))
        if not read:
            return found


def _to_spaces(dialect: Dialect) -> bytes:
    """A translation after which cells are separated by spaces, with decimal points."""
    table = bytearray(range(256))
    for separator in (dialect.separator, "\t", '"', "\r"):
        table[ord(separator)] = ord(" ")
    if dialect.decimal == "," and dialect.separator != ",":
        table[ord(",")] = ord(".")
    return bytes(table)


def _block(text: bytes, dialect: Dialect, spaces: bytes) -> Array | None:
    """Numbers (m, width) of m lines; None if not every line is so many numbers."""
    width, single = dialect.width, dialect.separator != SPACE
    u = np.frombuffer(text, dtype=np.uint8)
    ends = np.flatnonzero(u == 10)
    if single:
        marks = np.flatnonzero(u == ord(dialect.separator))
        if (np.diff(np.searchsorted(marks, ends), prepend=0) != width - 1).any():
            return None
        del marks
    if b'"' in text and text.count(b'"') % 2:
        return None
    spaced = not single or b" " in text or b"\t" in text
    text = text.translate(spaces)
    if spaced:
        u = np.frombuffer(text, dtype=np.uint8)
        blank = (u == 32) | (u == 10)
        begins = np.flatnonzero(~blank & np.concatenate([[True], blank[:-1]]))
        if (np.diff(np.searchsorted(begins, ends), prepend=0) != width).any():
            return None
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            values = np.fromstring(text, sep=" ")
        except (DeprecationWarning, ValueError):
            return None
    return values.reshape(len(ends), width) if values.size == len(ends) * width else None


def _cells(
    file: Path, dialect: Dialect, names: tuple[str, ...], say: Progress
) -> tuple[dict[str, NDArray[Any]], NDArray[np.int64]]:
    """Columns and lines of a table that is read cell by cell."""
    blocks: list[list[NDArray[Any]]] = []
    lines: list[NDArray[np.int64]] = []
    rows: list[list[str]] = []
    where: list[int] = []

    def put() -> None:
        if rows:
            blocks.append([_column(cells, dialect.decimal) for cells in zip(*rows, strict=True)])
            lines.append(np.array(where))
            rows.clear()
            where.clear()

    for number, cells in _body(file, dialect, say):
        wrong = check_width(cells, dialect)
        if wrong:
            raise RecordingError(wrong[0], remedy=wrong[1], file=file, line=number)
        rows.append(cells)
        where.append(number)
        if len(rows) == ROWS:
            put()
    put()
    columns: dict[str, NDArray[Any]] = {}
    for i, name in enumerate(names):
        parts = [block[i] for block in blocks]
        columns.setdefault(name, _joined(parts) if parts else np.zeros(0))
    return columns, np.concatenate(lines) if lines else np.zeros(0, dtype=np.int64)


def _body(file: Path, dialect: Dialect, say: Progress) -> Iterator[tuple[int, list[str]]]:
    """Rows behind the header."""
    size, number, last = file.stat().st_size, 0, dialect.skip
    with file.open("rb") as stream:

        def lines() -> Iterator[str]:
            decode = codecs.getdecoder("utf-8")
            for count, raw in enumerate(stream):
                if count >= dialect.skip:
                    if count % ROWS == 0:
                        say(min(stream.tell() / max(size, 1), 1.0))
                    yield decode(raw.removeprefix(codecs.BOM_UTF8))[0]

        found = cells_of(lines(), dialect.separator)
        while True:
            try:
                number, cells = next(found)
            except StopIteration:
                return
            except csv.Error as error:
                raise RecordingError(
                    f"not CSV: {error}",
                    remedy="Check the quotation marks on this line.",
                    file=file,
                    line=last + 1,
                ) from error
            last = dialect.skip + number
            yield last, cells


def _column(cells: tuple[str, ...], decimal: str) -> NDArray[Any]:
    """Numbers if all cells are, else the cells."""
    text = np.array(cells, dtype=object)
    try:
        if decimal == ",":
            return np.array([float(cell.replace(",", ".")) for cell in cells])
        return text.astype(float)
    except ValueError:
        return text


def _joined(parts: list[NDArray[Any]]) -> NDArray[Any]:
    if all(part.dtype.kind == "f" for part in parts):
        return np.concatenate(parts)
    return np.concatenate([part.astype(str).astype(object) for part in parts])
