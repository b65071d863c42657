"""The one family of errors that drake_screw raises for input it cannot use.

Each says what is wrong and where, and carries the remedy in its message, so that a program can
print ``str(error)`` alone. Failing to find a plan is a value (`planning.Outcomes`), never an error.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from math import floor
from pathlib import Path

from drake_screw.typing import PathLike


class DrakeScrewError(Exception):
    """Base of the family.

    Args:
        message: what is wrong, in one sentence.
        remedy: what the user can do about it.
        file: the input file it was found in.
        line: its line there, counted from 1.
    """

    def __init__(
        self,
        message: str,
        *,
        remedy: str | None = None,
        file: PathLike | None = None,
        line: int | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.remedy = remedy
        self.file = None if file is None else Path(file)
        self.line = line

    def __str__(self) -> str:
        place = "" if self.file is None else f"{self.file}: "
        if self.file is not None and self.line is not None:
            place = f"{self.file}:{self.line}: "
        remedy = f"\n  {self.remedy}" if self.remedy else ""
        return shortened(f"{place}{self.message}{remedy}")


@contextmanager
def about(file: PathLike | None) -> Iterator[None]:
    """Within, errors that name no file are about this one."""
    try:
        yield
    except DrakeScrewError as error:
        if error.file is None and file is not None:
            error.file = Path(file)
        raise


LONGEST = 240
"""Characters of a word, or of what is quoted, that a message repeats; of more, both ends."""


def shortened(text: str) -> str:
    """A message with what is too long in it cut short."""

    def cut(found: re.Match[str]) -> str:
        return f"{found[0][: LONGEST // 2]} ... {found[0][-LONGEST // 2 :]}"

    return re.sub(rf"'[^'\n]{{{LONGEST},}}'|\S{{{LONGEST},}}", cut, text)


class ModelError(DrakeScrewError):
    """A robot model that cannot be loaded, or that lacks a name asked of it."""


class RecordingError(DrakeScrewError):
    """A recording of a demonstration, or a file or folder of one, that cannot be used."""


class ScenarioError(DrakeScrewError):
    """A scenario, an override of one, or a table of task instances that cannot be used."""


class RunDirectoryError(DrakeScrewError):
    """A run directory that cannot be written, read or continued."""


class PluginError(DrakeScrewError):
    """A strategy, motion, teacher or format that is named in text and cannot be found."""


@contextmanager
def extra(
    name: str, message: str, raises: type[DrakeScrewError], file: PathLike | None = None
) -> Iterator[None]:
    """Where something cannot be imported within, an error that says which extra to install.

    Args:
        name: of the extra.
        message: what is needed, and what for.
        raises: the error's class.
        file: that it is needed for.
    """
    try:
        yield
    except ImportError as error:
        raise raises(message, remedy=f"pip install 'drake-screw[{name}]'", file=file) from error


def confidence(level: float) -> str:
    """A confidence or a coverage in digits, so many that it is not rounded up.

    >>> confidence(0.95), confidence(0.9996), confidence(1.0 - 1e-9)
    ('0.95', '0.9996', '0.999999999')
    """
    for digits in range(6, 17):
        text = f"{level:.{digits}g}"
        if 1.0 - float(text) >= 0.999 * (1.0 - level):
            break
    return text


def rounded_down(p: float) -> str:
    """A lower bound on a probability with four digits.

    >>> rounded_down(0.99999), rounded_down(0.95)
    ('0.9999', '0.9500')
    """
    return f"{floor(p * 1e4 + 1e-9) / 1e4:.4f}"


def counted(count: int, noun: str) -> str:
    """A number of things in words.

    >>> counted(1, "sample"), counted(2000, "sample")
    ('1 sample', '2,000 samples')
    """
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def listed(names: Sequence[str]) -> str:
    """Names as a list in a sentence.

    >>> listed(["x"]), listed(["x", "y", "z"])
    ('x', 'x, y and z')
    """
    return " and ".join([", ".join(names[:-1]), names[-1]]) if len(names) > 1 else "".join(names)


def nearest(name: str, valid: Iterable[str]) -> str | None:
    """The valid name most like `name`, or None where none is alike."""
    matches = difflib.get_close_matches(name, list(valid), n=1, cutoff=0.6)
    return matches[0] if matches else None


def suggestion(name: str, valid: Iterable[str], plural: str) -> str:
    """For example ``Did you mean 'beta'? Keys: beta, epsilon``; ``Keys: none`` without any."""
    valid = list(valid)
    guess = nearest(name, valid)
    return (
        f"Did you mean '{guess}'? " if guess else ""
    ) + f"{plural}: {', '.join(valid) or 'none'}"


def unknown(kind: str, name: str, where: str, valid: Iterable[str]) -> tuple[str, str]:
    """Message and remedy for a name that does not exist.

    Returns:
        For example ``("no frame 'left_hnd' in model 'baxter'",
        "Did you mean 'left_hand'? Frames: left_hand, left_gripper")``.
    """
    valid = list(valid)
    guess = nearest(name, valid)
    hint = f"Did you mean '{guess}'? " if guess else ""
    listed = ", ".join(valid[:40]) + (", ..." if len(valid) > 40 else "")
    return f"no {kind} '{name}' in {where}", f"{hint}{kind.capitalize()}s: {listed}"
