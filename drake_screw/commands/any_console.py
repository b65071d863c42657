"""Words on any console: what it has no character for is written with those it has."""

from __future__ import annotations

import codecs
import io
import sys
import unicodedata

_HANDLER = "drake_screw.nearest"

_NEAREST = {
    "█": "#",
    "▏": "|",
    "…": "...",
    "–": "-",
    "—": "-",
    "−": "-",
    "·": "-",
    "•": "*",
    "→": "->",
    "≤": "<=",
    "≥": ">=",
    "≈": "~",
    "π": "pi",
    "τ": "tau",
    "δ": "delta",
    "ε": "epsilon",
    "β": "beta",
    "“": '"',
    "”": '"',
    "‘": "'",
    "’": "'",
    "━": "-",
    "─": "-",
    "│": "|",
    "╭": "+",
    "╮": "+",
    "╰": "+",
    "╯": "+",
}


def any_console() -> None:
    """Make standard output and error fit for every text, whatever their encoding.

    A stream that is not UTF-8 gets the nearest characters that it has in place of those it lacks.
    """
    codecs.register_error(_HANDLER, _nearest)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and not stream.encoding.lower().startswith("utf"):
            stream.reconfigure(errors=_HANDLER)


def _nearest(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    found = ""
    for letter in error.object[error.start : error.end]:
        plain = unicodedata.normalize("NFKD", letter).encode("ascii", "ignore").decode()
        found += _NEAREST.get(letter) or plain or "?"
    return found, error.end
