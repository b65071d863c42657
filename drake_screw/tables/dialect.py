"""How a text table is written: what separates cells, decimal commas, and names or none."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

LOOKED_AT = 50
"""Lines from which a table's dialect is told."""

SPACE = " "
_SEPARATORS = ("\t", ";", ",", SPACE)
_WORDS = {"\t": "tabs", ";": "semicolons", ",": "commas", SPACE: "spaces"}
_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+([eE][-+]?\d+)?$")


@dataclass(frozen=True)
class Dialect:
    """How a text table is written.

    Attributes:
        separator: of cells; a space stands for any number of spaces and tabs.
        decimal: "." or ",".
        names: of the columns; None where the first row is numbers already.
        skip: lines before the first row of numbers.
        width: cells of a row.
        header: the line of the names, counted from 1.
    """

    separator: str
    decimal: str
    names: tuple[str, ...] | None
    skip: int
    width: int
    header: int = 1

    def __str__(self) -> str:
        said = f"separated by {_WORDS.get(self.separator, repr(self.separator))}"
        return said + (", decimal commas" if self.decimal == "," else "")


def cells_of(lines: Iterator[str], separator: str) -> Iterator[tuple[int, list[str]]]:
    """Rows that are not blank, each with the number of the line that it ends in, from 1.

    Raises:
        csv.Error: quotation marks do not match.
    """
    if separator == SPACE:
        for number, line in enumerate(lines, start=1):
            cells = line.split()
            if cells:
                yield number, [cell.strip('"') for cell in cells]
        return
    rows = csv.reader(lines, delimiter=separator, skipinitialspace=True, strict=True)
    for row in rows:
        if row[1:] or any(map(str.strip, row)):
            yield rows.line_num, [cell.strip() for cell in row]


def dialect_of(
    lines: Sequence[str], separator: str | None = None, decimal: str | None = None
) -> Dialect:
    """The dialect of a table, told from its first lines.

    Args:
        lines: from the file's beginning.
        separator, decimal: where they are known.
    """
    comments = next((i for i, line in enumerate(lines) if not _is_comment(line)), len(lines))
    body = lines[comments : comments + LOOKED_AT]
    found: list[tuple[float, int, str, list[tuple[int, list[str]]]]] = []
    for candidate in (separator,) if separator else _SEPARATORS:
        rows = _rows(body, candidate)
        if rows and (len(rows[0][1]) > 1 or separator):
            same = sum(len(cells) == len(rows[0][1]) for _, cells in rows) / len(rows)
            found.append((same, -len(found), candidate, rows))
    if not found:
        found = [(1.0, 0, ",", _rows(body, ","))]
    _, _, chosen, rows = max(found, key=lambda item: item[:2])
    if not rows:
        return Dialect(chosen, decimal or ".", (), comments, 0)
    decimal = decimal or _decimal(rows, chosen)
    first, cells = rows[0]
    if not all(_is_number(cell, decimal) for cell in cells):
        return Dialect(
            chosen,
            decimal,
            tuple(cells),
            comments + first,
            len(cells),
            comments + first,
        )
    plain = Dialect(chosen, decimal, None, comments, len(cells))
    if comments:  # the names may stand in a comment
        text = lines[comments - 1].lstrip("#% ")
        named = next((row for _, row in cells_of(iter([text]), chosen)), [])
        if len(named) == len(cells):
            return replace(plain, names=tuple(named), header=comments)
    return plain


def _is_comment(line: str) -> bool:
    """Whether a line is one; `rostopic echo -p` begins its header with %time."""
    return line.startswith("#") or (line.startswith("%") and not re.match(r"%\w", line))


def _rows(lines: Sequence[str], separator: str) -> list[tuple[int, list[str]]]:
    """Up to where quotation marks do not match; the reader says so."""
    rows: list[tuple[int, list[str]]] = []
    try:
        rows.extend(islice(cells_of(iter(lines), separator), LOOKED_AT))
    except csv.Error:
        found = cells_of(iter(lines), separator)
        while True:
            try:
                rows.append(next(found))
            except (csv.Error, StopIteration):
                break
    return rows


def _decimal(rows: Sequence[tuple[int, list[str]]], separator: str) -> str:
    """A comma if some cells need it to be numbers; quoted ones where commas separate, too."""
    commas = any(_DECIMAL_COMMA.match(cell) for _, cells in rows[1:] for cell in cells)
    return "," if commas else "."


def _is_number(cell: str, decimal: str) -> bool:
    try:
        float(cell.replace(",", ".") if decimal == "," else cell)
    except ValueError:
        return False
    return True


def check_width(cells: Sequence[str], dialect: Dialect) -> tuple[str, str] | None:
    """What is to be said of a row that has not as many cells as the header; None if it has."""
    if len(cells) == dialect.width:
        return None
    of = "header" if dialect.names is not None else "first row"
    said = f"{len(cells)} cells where the {of} has {dialect.width}"
    if dialect.separator == "," and dialect.width > 1 and len(cells) == 2 * dialect.width:
        return (
            f"{said}: these look like decimal commas, in a table separated by commas",
            "Write the table with semicolons between the cells, or with decimal points.",
        )
    return said, "The row is cut off or has a stray comma; delete or repair it."
