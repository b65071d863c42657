"""Time stamps as seconds: their unit told from their numbers, and coarse ones spread."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from drake_screw.typing import Array

Unit = Literal["s", "ms", "us", "ns", "frames", "iso"]

SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
"""In one of each unit."""

SLOWEST, FASTEST = 2.0, 4000.0
"""Hz, of recordings of an arm."""
COARSE = 0.6
"""Part of the samples with other numbers than the one before that have its stamp, from which on
stamps are coarse; with fewer they are repeated."""

_EPOCHS = (("ns", 1e17, 1e19), ("us", 1e14, 1e17), ("ms", 1e11, 1e14), ("s", 1e8, 1e11))
"""Stamps since 1970 by their size; from 1973 on."""

_NAMED = (
    ("ns", r"(^|[^a-z])(ns|nsecs?|nanosecs?|nanoseconds?|time_ns)([^a-z]|$)"),
    ("us", r"(^|[^a-z])(us|usecs?|microsecs?|microseconds?)([^a-z]|$)"),
    ("ms", r"(^|[^a-z])(ms|msecs?|millis|millisecs?|milliseconds?)([^a-z]|$)"),
    ("frames", r"(^|[^a-z])(frames?|index|idx|step|seq|sample|frame_?(index|number|id))([^a-z]|$)"),
    ("s", r"(^|[^a-z])(s|secs?|seconds?)([^a-z]|$)"),
)


def unit_in_name(name: str) -> Unit | None:
    """The unit that a column's name states, such as "t_ms" or "frame_index"."""
    for unit, pattern in _NAMED:
        if re.search(pattern, name.lower()):
            return unit  # type: ignore[return-value]
    return None


def unit_of(stamps: NDArray[Any], name: str = "") -> Unit | None:
    """The unit of stamps (m,), where there is but one that they can have; else None.

    Text is ISO 8601. Numbers as large as those of clocks since 1970 have the unit that makes a date
    of them. Otherwise the column's name may state it, or it is that in which the rate is one of
    recordings, `SLOWEST` to `FASTEST`. Numbers counted up by one are frames or anything.
    """
    if stamps.dtype.kind != "f":
        return "iso"
    finite = stamps[np.isfinite(stamps)]
    if len(finite) < 2:
        return unit_in_name(name) or "s"
    size = float(np.abs(finite).max())
    for unit, least, most in _EPOCHS:
        if least <= size < most and finite.min() > 0.5 * size:
            return unit  # type: ignore[return-value]
    named = unit_in_name(name)
    if named is not None:
        return named
    steps = np.diff(finite)
    if (steps == 1.0).all() and len(steps) > 2:
        return None
    possible: list[Unit] = [unit for unit in ("s", "ms", "us", "ns") if _plausible(steps, unit)]
    return possible[0] if len(possible) == 1 else None


def _plausible(steps: Array, unit: str) -> bool:
    """Whether samples a number of units apart are as far apart as those of recordings."""
    moving = steps[steps > 0.0]
    if not len(moving):
        return unit == "s"
    each = (float(steps.mean()), float(np.median(moving)))
    scale = SECONDS[unit]
    return min(each) * scale <= 1.0 / SLOWEST and max(each) * scale >= 1.0 / FASTEST


def in_seconds(stamps: NDArray[Any], unit: Unit, rate: float | None = None) -> Array:
    """Seconds (m,) since the first stamp.

    Args:
        stamps: (m,) numbers, or text for "iso".
        unit: theirs.
        rate: Hz, of "frames".

    Raises:
        ValueError: text that is not ISO 8601; the message is the text.
    """
    if unit == "iso":
        since = np.array([_iso(str(text)) for text in stamps], dtype="datetime64[ns]")
        return (since - since[0]).astype(np.int64) * 1e-9 if len(since) else np.zeros(0)
    values = stamps.astype(float)
    values = values - values[0] if len(values) else values
    if unit == "frames":
        if rate is None:
            raise ValueError("frames need a rate")
        return np.asarray(values / rate)
    return np.asarray(values * SECONDS[unit])


def _iso(text: str) -> np.datetime64:
    plain = re.sub(r"(Z|[+-]\d\d:?\d\d)$", "", text.strip()).replace("/", "-").replace(",", ".")
    try:
        return np.datetime64(plain.replace(" ", "T"), "ns")
    except ValueError as error:
        raise ValueError(text) from error


def spread(t: Array, changes: NDArray[np.bool_]) -> tuple[Array, str | None]:
    """Coarse stamps spread evenly, in the samples' order; stamps that are not coarse as they are.

    The samples of one stamp are spread from it to the next; the last ones, and the first if they
    are fewer than their interval would have, go on at the rate of the others.

    Args:
        t: (m,) s, not decreasing.
        changes: (m,) whether a sample has other numbers than the one before.

    Returns:
        (m,) s, and what was done, in words; None if nothing.
    """
    same = np.append(False, np.diff(t) == 0.0)
    if np.count_nonzero(same & changes) < max(COARSE * np.count_nonzero(changes), 2):
        return t, None
    starts = np.flatnonzero(~same)
    if len(starts) < 2:
        return t, None
    counts = np.diff(np.append(starts, len(t)))
    stamps = t[starts]
    gaps = np.diff(stamps)
    step = float(np.median(gaps / counts[:-1]))
    spread_t = np.empty_like(t)
    for i, (start, count) in enumerate(zip(starts.tolist(), counts.tolist(), strict=True)):
        k = np.arange(count)
        if i == len(starts) - 1:
            spread_t[start:] = stamps[i] + k * step
        elif i == 0 and count * step < gaps[0]:
            spread_t[:count] = stamps[1] - (count - k) * step
        else:
            spread_t[start : start + count] = stamps[i] + k * gaps[i] / count
    most = int(counts.max())
    return spread_t, (
        f"the stamps are coarse, up to {most} samples have one: spread evenly in their order, "
        f"about {1.0 / step:.3g} a second"
    )


def listed(units: Sequence[str]) -> str:
    """Units as a choice: "s, ms or us"."""
    return ", ".join(units[:-1]) + f" or {units[-1]}"
