"""What Drake's parsers warn of, gathered and told once, in one line for each kind."""

from __future__ import annotations

import logging
import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

READER = "drake_screw.robot.parts"
"""The logger that says of a model that it has been read."""

NAMED = 6
"""Names in a line at most."""

_WARNING = re.compile(r"(?P<file>.+?):(?P<line>\d+): warning: (?P<text>.*)", re.DOTALL)
_ELEMENT = re.compile(r"<(?:link|joint|body|transmission)\b[^>]*?\bname\s*=\s*[\"']([^\"']+)")

_KINDS = (
    (
        re.compile(r"inertia", re.IGNORECASE),
        "1 link has an inertia that is not physical; only simulation needs it",
        "{n} links have inertias that are not physical; only simulation needs them",
    ),
    (
        re.compile(r"Joint '(?P<name>[^']+)' specified as type floating"),
        "1 floating joint is held where it is by default",
        "{n} floating joints are held where they are by default",
    ),
    (
        re.compile(r"non-zero value for the 'friction' attribute"),
        "1 joint has friction, which is left out",
        "{n} joints have friction, which is left out",
    ),
    (
        re.compile(r"mechanicalReduction"),
        "1 gear is left out: its motor counts as driving the joint itself",
        "{n} gears are left out: their motors count as driving the joints themselves",
    ),
    (
        re.compile(r"transmission", re.IGNORECASE),
        "1 transmission is none that Drake knows; its joints are driven directly",
        "{n} transmissions are none that Drake knows; their joints are driven directly",
    ),
    (
        re.compile(r"The (?:tag|attribute) '(?P<name>[^']+)' found .* will be ignored"),
        "1 kind of tag or attribute says nothing to Drake and is left out",
        "{n} kinds of tags and attributes say nothing to Drake and are left out",
    ),
)
"""What warnings are about, by what they have in them, and the words for one and for several."""


class Warned(NamedTuple):
    """A warning: of which file, what it is about if that is known, and words for one and more."""

    file: str
    name: str | None
    one: str
    many: str


def understood(message: str) -> Warned | None:
    """A warning of a parser of Drake's; None of another message."""
    found = _WARNING.fullmatch(message)
    if found is None:
        return None
    file, text = found["file"], found["text"].strip()
    for pattern, one, many in _KINDS:
        if match := pattern.search(text):
            named = match.groupdict().get("name")
            return Warned(file, named or _owner(file, int(found["line"])), one, many)
    said = text.splitlines()[0]
    return Warned(file, None, said, said)


def lines_of(warnings: Iterable[Warned]) -> Iterator[str]:
    """One line for each kind of warning of a file."""
    kinds: dict[tuple[str, str], list[Warned]] = {}
    for warning in warnings:
        kinds.setdefault((warning.file, warning.many), []).append(warning)
    for (file, many), alike in kinds.items():
        names = list(dict.fromkeys(warning.name for warning in alike if warning.name))
        n = len(names) or len(alike)
        words = alike[0].one if n == 1 else many.replace("{n}", str(n))
        listed = ", ".join(names[:NAMED]) + (", ..." if len(names) > NAMED else "")
        yield f"{Path(file).name}: {words}{f': {listed}' if listed else ''}"


class Gathered(logging.Filter):
    """Keeps Drake's warnings of models back until one has been read, then tells them in short.

    Put on Drake's logger it drops messages below warnings, and keeps those of parsers; `tell`
    gives them to the logger, each line once in a process.

    Args:
        full: let them all through as they are instead.
    """

    def __init__(self, *, full: bool = False) -> None:
        super().__init__()
        self.full = full
        self._kept: list[Warned] = []
        self._told: set[str] = set()

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether a message of Drake's is shown at once."""
        if record.levelno < logging.WARNING:
            return False
        warned = None if self.full else understood(record.getMessage())
        if warned is not None:
            self._kept.append(warned)
        return warned is None

    def tell(self, logger: logging.Logger) -> None:
        """Say what has been kept."""
        kept, self._kept = self._kept, []
        for line in lines_of(kept):
            if line not in self._told:
                self._told.add(line)
                logger.warning("%s", line)


class WhenRead(logging.Filter):
    """On the logger READER: has what was gathered told as soon as a model has been read."""

    def __init__(self, gathered: Gathered) -> None:
        super().__init__()
        self._gathered = gathered

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether a message of the reader's is shown: all but those that say less than INFO."""
        self._gathered.tell(logging.getLogger("drake_screw"))
        return self._gathered.full or record.levelno >= logging.INFO


@lru_cache(maxsize=8)
def _text(file: str) -> tuple[str, ...]:
    try:
        return tuple(Path(file).read_text(encoding="utf-8", errors="replace").splitlines())
    except OSError:
        return ()


def _owner(file: str, line: int) -> str | None:
    """The link, joint or transmission that a line of a model's file is about, if that is known."""
    text = _text(file)
    here = _ELEMENT.findall(text[line - 1]) if 0 < line <= len(text) else []
    if len(here) > 1:
        return None
    found = _ELEMENT.findall("\n".join(text[:line]))
    return found[-1] if found else None
