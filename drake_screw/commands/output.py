"""Where a verb's words go, and its result as JSON."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.segment import Segments

from drake_screw.errors import DrakeScrewError
from drake_screw.files import write_text, writing
from drake_screw.outputs import check_writable, writable

if TYPE_CHECKING:
    from rich.table import Table

STANDARD_OUTPUT = "-"
JSON, HTML = "--json", "--html"
WIDE = 200
"""Characters of a line that a table may fill."""


class Output:
    """What a verb says and writes.

    Args:
        json: a file to write its result to, or "-" for standard output, which then has nothing
            else; None for neither.

    Attributes:
        console: for the words; standard error where the result takes standard output.

    Raises:
        DrakeScrewError: there cannot be such a file.
    """

    def __init__(self, json: str | None = None) -> None:
        self.console = Console(stderr=json == STANDARD_OUTPUT)
        self._json = json
        if json is not None and json != STANDARD_OUTPUT:
            check_writable(Path(json), _remedy(JSON))

    def say(self, text: object) -> None:
        """Print words as they are, however long."""
        self.console.print(str(text), soft_wrap=True, markup=False, highlight=False)

    def print_table(self, table: Table) -> None:
        """As `print_table`, where this says what it says."""
        print_table(self.console, table)

    def present(self, result: object) -> None:
        """Print a result's words, and write it as JSON, if that is wanted.

        Args:
            result: a dataclass with a text of its own; its fields are the keys.
        """
        wrapped = self.console.is_terminal
        self.console.print(str(result), soft_wrap=not wrapped, markup=False, highlight=False)
        self.write(result)

    def write(self, result: object) -> None:
        """Write a verb's result as JSON, if that is wanted.

        Args:
            result: a dataclass; its fields are the keys.

        Raises:
            DrakeScrewError: the file cannot be written.
        """
        if self._json is None:
            return
        from pydantic_core import to_json

        text = to_json(result, indent=2, inf_nan_mode="null").decode() + "\n"
        if self._json == STANDARD_OUTPUT:
            sys.stdout.write(text)
            return

        with writing(Path(self._json), _remedy(JSON)):
            write_text(Path(self._json), text)


def print_table(console: Console, table: Table) -> None:
    """Print a table at its full width, wherever it goes: no name in it is cut short."""
    wide = console.render(table, console.options.update(width=WIDE))
    console.print(Segments(wide), soft_wrap=True, end="")


def check_page(html: Path | None, json: str | None) -> None:
    """Refuse a page that cannot be written, before the work is done.

    Args:
        html: a file, if a page is wanted.
        json: where the result is written as JSON, if it is.

    Raises:
        DrakeScrewError: there cannot be such a file, or the two are one.
    """
    if html is not None:
        check_writable(html, _remedy(HTML))
        check_distinct({HTML: html, JSON: json})


def check_distinct(files: Mapping[str, str | Path | None]) -> None:
    """Refuse one file for two purposes.

    Args:
        files: by the options that name them; None where one is not given.

    Raises:
        DrakeScrewError: two are the same.
    """
    named: dict[str, str] = {}
    for option, file in files.items():
        if file is None or file == STANDARD_OUTPUT:
            continue
        other = named.setdefault(os.path.realpath(file), option)
        if other != option:
            raise DrakeScrewError(
                f"{other} and {option} name one file", remedy="Give two.", file=file
            )


def _remedy(option: str) -> str:
    remedy = writable(option)
    return f"{remedy.removesuffix('.')}, or -." if option == JSON else remedy
