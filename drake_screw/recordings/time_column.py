"""Time of a table: its column and unit, or a rate."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from drake_screw.demonstrations.recording import GAP
from drake_screw.errors import RecordingError
from drake_screw.recordings.mapping import Mapping
from drake_screw.tables import Table
from drake_screw.tables.clock import FASTEST, SLOWEST, in_seconds, unit_in_name, unit_of
from drake_screw.typing import Array

_PAIRS = (r"(.*)secs?$", ("nsecs", "nsec", "nanosec", "nanosecs"))
_NAMES = (
    r"%?time$",
    r"t$",
    r"(time_?stamp|stamp)$",
    r"%?(time|time_?stamp|stamp|clock|t)[ _.,\[(/-]*"
    r"(in )?(s|secs?|seconds?|ms|us|ns|\w{2,5}secs?)?[\])]?$",
    r"(secs?|seconds|m(illi)?secs?|millis|milliseconds)$",
    r".*time_?stamp.*|.*[._/]time$|.*elapsed.*|.*header\.stamp$",
    r"(frame|step|sample)(_?(index|number|id|nr))?$",
)


@dataclass(frozen=True, eq=False)
class Time:
    """Seconds (m,) since the first sample, the keys of a mapping that say so, and the words."""

    t: Array
    keys: dict[str, object]
    said: str
    columns: tuple[str, ...] = ()


def time_of(table: Table, mapping: Mapping) -> Time:
    """The time of a table's rows.

    Raises:
        RecordingError: there is no column of it, or its unit cannot be told.
    """
    where, m = mapping.time, len(table)
    if where is None and mapping.rate is not None and mapping.time_unit != "frames":
        t = np.arange(m) / mapping.rate
        return Time(t, {"rate": mapping.rate}, f"by the rate, {mapping.rate:g} Hz")
    if where is None:
        where = _column(table)
    if where is None:
        raise RecordingError(
            "no column of time",
            remedy=f"{_how_to_say_it(table)} Columns found: {', '.join(table.names[:40])}",
            file=table.file,
            line=table.header,
        )
    if isinstance(where, tuple):
        s, ns = (table.numbers(name) for name in where)
        t = (s - s[0]) + (ns - ns[0]) * 1e-9 if m else s
        return Time(t, {"time": list(where)}, f"{where[0]} and {where[1]}, s and ns", where)
    table.require([where])
    stamps = table.columns[where]
    if stamps.dtype.kind != "f" and mapping.time_unit not in (None, "iso"):
        stamps = table.numbers(where)
    unit = mapping.time_unit or unit_of(stamps, where)
    if unit is None:
        step = float(np.median(np.diff(stamps)))
        raise RecordingError(
            f"the unit of time cannot be told: column '{where}' goes by steps of {step:g}",
            remedy="Say time_unit: s, ms, us or ns in recording.yaml; or, of frames, time_unit: "
            f"frames and their rate: 100 (Hz). Taken for granted is a rate of {SLOWEST:g} to "
            f"{FASTEST:g} Hz.",
            file=table.file,
            line=table.header,
        )
    if unit == "frames" and mapping.rate is None:
        raise RecordingError(
            f"column '{where}' counts frames, and how many there are in a second is not said",
            remedy="Say rate: 100 (Hz) in recording.yaml, or --rate 100.",
            file=table.file,
            line=table.header,
        )
    try:
        t = in_seconds(stamps, unit, mapping.rate)
    except ValueError as error:
        row = next((i for i, text in enumerate(stamps) if str(text) == str(error)), 0)
        raise RecordingError(
            f"not a time: '{error}' in column '{where}'",
            remedy="Expected seconds, or ISO 8601 such as 2026-03-01T10:15:00.250. Say time: NAME "
            "if it is another column.",
            file=table.file,
            line=int(table.lines[row]),
        ) from error
    why = "as said" if mapping.time_unit else "by its name" if unit_in_name(where) else "by size"
    keys: dict[str, object] = {"time": where, "time_unit": unit}
    if unit == "frames":
        keys["rate"] = mapping.rate
    return Time(t, keys, f"column '{where}' in {unit} ({why})", (where,))


def _column(table: Table) -> str | tuple[str, str] | None:
    """The most likely one, by its name."""
    for name in table.names:
        found = re.match(_PAIRS[0], name, re.IGNORECASE)
        for other in _PAIRS[1]:
            pair = f"{found.group(1)}{other}" if found else ""
            if pair in table.names and pair != name:
                return name, pair
    for pattern in _NAMES:
        for name in table.names:
            if re.match(pattern, name, re.IGNORECASE):
                return name
    return None


def _how_to_say_it(table: Table) -> str:
    """What to write, and where, if there is no column of time; with the one that could be it."""
    rate = "samples at a constant rate need --rate HZ instead."
    rising = [name for name in table.numeric if _rises(table.columns[name])]
    if len(rising) == 1:
        return (
            f"Column '{rising[0]}' goes up from row to row: if it is the time, write the line "
            f"'time: {rising[0]}' into a file recording.yaml beside the data; {rate}"
        )
    return f"Write the line 'time: NAME' into a file recording.yaml beside the data; {rate}"


def _rises(column: Array) -> bool:
    """Whether a column (m,) never falls, and is another in most rows than in the row before."""
    steps = np.diff(column)
    return bool(len(steps) and (steps >= 0.0).all() and (steps > 0.0).mean() > 0.5)


def rate_in_words(t: Array) -> str:
    """Of samples at t (m,) s."""
    moving = np.diff(t)[np.diff(t) > 0.0]
    return f"about {1.0 / np.median(moving):.4g} Hz" if len(moving) else "of unknown rate"


def gaps_in_words(t: Array) -> str:
    """Steps between samples at t (m,) s that are longer than GAP."""
    steps = np.diff(t)
    long = np.flatnonzero(steps > GAP)
    if not len(long):
        return f"none; the longest step is {steps.max(initial=0.0):.3f} s"
    return f"{len(long)} of more than {GAP:g} s, the first at {t[long[0]]:.2f} s"
