"""A file that holds several demonstrations, cut at pauses or by what was said beside the motion."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from drake_screw.errors import RecordingError, counted, suggestion
from drake_screw.recordings.mapping import FILE, Mapping
from drake_screw.recordings.raw import Labels, Raw
from drake_screw.typing import Array

PAUSES = "pauses"
PAUSE = 2.0
"""s, the usual least length of a pause."""
STANDING = 0.01
"""rad or m, by which the arm usually may move in a pause."""
LEAST = 10.0
"""times that, by which the arm moves in a demonstration."""
_LOOKED_AT = 50_000
_BINS = 20
"""of time, in a pause of the least length."""


@dataclass(frozen=True)
class Episode:
    """Rows from `first` to before `end`."""

    first: int
    end: int


def coordinates(q: Array, X_WE: Array | None) -> Array:
    """What moves, (m, k): joints q (m, n), or position and rotation matrix of X_WE (m, 4, 4)."""
    return q if X_WE is None else X_WE[:, :3].reshape(len(X_WE), 12)


def between_pauses(
    t: Array, x: Array, pause: float = PAUSE, still: float = STANDING
) -> tuple[list[Episode], int]:
    """Motions between pauses, and how many were left out since they are small.

    A pause is at least `pause` s within which no coordinate moves by more than `still`, single
    samples aside; or as long a time without samples. Motions in which none moves by more than
    `LEAST` times that are left out. An episode begins and ends with the sample at rest.

    Args:
        t: (m,) s; in disorder there are no pauses.
        x: (m, k) coordinates, rad or m.
    """
    if len(t) < 2 or not (np.diff(t) >= 0.0).all() or not np.isfinite(x).all():
        return [Episode(0, len(t))], 0
    smooth = _without_outliers(x)
    found = []
    gaps = np.flatnonzero(np.diff(t) >= pause) + 1
    for begin, end in pairwise([0, *gaps.tolist(), len(t)]):
        first = begin
        resting = _pauses(t[begin:end], smooth[begin:end], pause, still)
        for start, last in [*((begin + i, begin + j) for i, j in resting), (end - 1, end - 1)]:
            if start > first:
                found.append(Episode(first, start + 1))
            first = last
    moving = [each for each in found if _moves(x, each, still)]
    return moving, len(found) - len(moving)


def by_labels(t: Array, labels: Labels) -> list[Episode]:
    """Rows t (m,) from each label that stands for a demonstration to the next other label.

    Of truth values, true stands for one. Of texts and numbers every one does until another comes,
    except the empty text, numbers below 0, and 0 where it comes back after other numbers. What is
    before the first label belongs to none.
    """
    values = _demonstrations(labels.values)
    found = []
    begin, now = 0.0, None
    for at, value in [*zip(labels.t.tolist(), values, strict=True), (np.inf, None)]:
        if value == now:
            continue
        if now is not None:
            first, end = np.searchsorted(t, [begin, at], side="left").tolist()
            found.append(Episode(first, end))
        begin, now = at, value
    return found


def episodes(raw: Raw, mapping: Mapping, t: Array, x: Array) -> tuple[Raw, ...]:
    """The recordings that a file holds, as its mapping says.

    Each is called like the file with a number behind it, and has a note of when it was.

    Args:
        raw: as read.
        mapping: its `episodes`, `pause` and `still` say how.
        t: (m,) s since the first of its rows.
        x: (m, k) coordinates of the arm.

    Raises:
        RecordingError: there is nothing of that name to cut by, or no motion.
    """
    assert mapping.episodes is not None
    still = mapping.still or STANDING
    if mapping.episodes == PAUSES:
        pause = mapping.pause or PAUSE
        found, small = between_pauses(t, x, pause, still)
        how = f"between pauses of at least {pause:g} s"
    else:
        told = by_labels(t, _labels(raw, mapping.episodes, t))
        found = [each for each in told if _moves(x, each, still)]
        small, how = len(told) - len(found), f"by {mapping.episodes}"
    if not found:
        raise RecordingError(
            f"episodes: {mapping.episodes}: no motion by more than {LEAST * still:g} rad or m in "
            f"any of {counted(small, 'episode')}",
            remedy=f"Leave episodes out in {FILE}, for one recording; or say a smaller still.",
            file=raw.table.file,
        )
    return tuple(
        _part(raw, each, i, len(found), t, how, small if i == 0 else 0, still)
        for i, each in enumerate(found)
    )


def hint(t: Array, x: Array) -> tuple[str, ...]:
    """A note where there seem to be several demonstrations in what is taken for one.

    Of many samples, some `_LOOKED_AT` are looked at.
    """
    every = max(len(t) // _LOOKED_AT, 1)
    t, x = t[::every], x[::every]
    found, _ = between_pauses(t, x)
    if len(found) < 2:
        return ()
    at = ", ".join(f"{t[each.end - 1]:.2f}" for each in found[:-1][:5])
    more = ", ..." if len(found) > 6 else ""
    return (
        f"there seem to be {len(found)} demonstrations, with pauses of at least {PAUSE:g} s "
        f"from {at}{more} s on; episodes: {PAUSES} in {FILE} cuts them",
    )


def _part(
    raw: Raw, each: Episode, i: int, count: int, t: Array, how: str, small: int, still: float
) -> Raw:
    begin, end = float(t[each.first]), float(t[each.end - 1])
    notes = [f"is {i + 1} of {count} in the file, from {begin:.2f} to {end:.2f} s, {how}"]
    if small:
        notes.append(
            f"left out {counted(small, 'episode')} in which the arm moves by less than "
            f"{LEAST * still:g} rad or m"
        )
    return replace(
        raw,
        name=f"{raw.name}_{i + 1:0{max(2, len(str(count)))}d}",
        table=raw.table.rows(np.arange(each.first, each.end)),
        notes=(*raw.notes, *notes),
        begin=raw.begin + begin,
    )


def _labels(raw: Raw, name: str, t: Array) -> Labels:
    if name in raw.labels:
        found = raw.labels[name]
        return replace(found, t=found.t - raw.begin)
    if name in raw.table.columns:
        return Labels(t, tuple(raw.table.columns[name].tolist()))
    raise RecordingError(
        f"episodes: no column '{name}'",
        remedy=f"Say {PAUSES}, a column, or of a bag a topic. "
        + suggestion(name, [PAUSES, *raw.table.names[:40]], "Columns found"),
        file=raw.table.file,
        line=raw.table.header,
    )


def _demonstrations(values: tuple[Any, ...]) -> list[Any]:
    """What labels stand for, a value each; None for no demonstration."""
    numbers = [v for v in values if isinstance(v, int | float) and not isinstance(v, bool)]
    changes = [a for a, b in pairwise([None, *numbers]) if a != b] + numbers[-1:]
    zero_comes_back = changes.count(0) > 1
    truth = {"true": True, "false": None, "": None}
    found: list[Any] = []
    for value in values:
        if isinstance(value, str):
            text = value.strip()
            found.append(truth.get(text.lower(), text))
        elif isinstance(value, bool):
            found.append(value or None)
        else:
            found.append(value if value > 0 or (value == 0 and not zero_comes_back) else None)
    return found


def _without_outliers(x: Array) -> Array:
    """The median of each sample and those beside it."""
    if len(x) < 3:
        return x
    a, b, c = x[:-2], x[1:-1], x[2:]
    middle = np.maximum(np.minimum(a, b), np.minimum(np.maximum(a, b), c))
    return np.concatenate([x[:1], middle, x[-1:]])


def _moves(x: Array, each: Episode, still: float) -> bool:
    """Whether the arm moves in it; a number that is not finite is left to the checks to come."""
    rows = _without_outliers(x[each.first : each.end])
    return len(rows) > 1 and not np.ptp(rows, axis=0).max(initial=0.0) <= LEAST * still


def _pauses(t: Array, x: Array, pause: float, still: float) -> list[tuple[int, int]]:
    """First and last rows of pauses; the longest that is still is found in bins of time first."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d  # take long to import

    number = ((t - t[0]) / (pause / _BINS)).astype(np.int64)
    starts = np.flatnonzero(np.append(True, np.diff(number) > 0))
    filled, window = int(number[-1]) + 1, _BINS - 1  # whole bins in the shortest pause
    if filled < window:
        return []
    lows, highs = np.full((filled, x.shape[1]), np.inf), np.full((filled, x.shape[1]), -np.inf)
    lows[number[starts]] = np.minimum.reduceat(x, starts, axis=0)
    highs[number[starts]] = np.maximum.reduceat(x, starts, axis=0)
    spread = maximum_filter1d(highs, window, axis=0) - minimum_filter1d(lows, window, axis=0)
    calm = (spread <= still).all(axis=1).astype(np.int8)
    calm[: window // 2] = calm[filled - window // 2 :] = 0
    inside = maximum_filter1d(calm, window, mode="constant")[number]
    edges = np.flatnonzero(np.diff(np.concatenate([[0], inside, [0]])))
    pauses = [
        _ends(t, x, first, end, pause, still)
        for first, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
    ]
    return [(i, j) for i, j in pauses if t[j] - t[i] >= pause * (1.0 - 1e-9)]


def _ends(t: Array, x: Array, first: int, end: int, pause: float, still: float) -> tuple[int, int]:
    """The rows at which a pause begins and ends, given rows that are so to a few bins."""
    half, margin = pause / 2.0, pause / 4.0
    after = max(int(np.searchsorted(t, t[first] + half)), first + 1)
    before = min(int(np.searchsorted(t, t[end - 1] - half)), end - 1)
    earliest = int(np.searchsorted(t, t[first] - margin))
    latest = int(np.searchsorted(t, t[end - 1] + margin, side="right"))
    begin = _reach(x[earliest:after][::-1], np.median(x[first:after], axis=0), still)
    last = _reach(x[before:latest], np.median(x[before:end], axis=0), still)
    return after - 1 - begin, before + last


def _reach(x: Array, at: Array, still: float) -> int:
    """The farthest row at rest, before any is away from there by more than `still`."""
    away = np.abs(x - at).max(axis=1, initial=0.0)
    near = away <= still
    count = len(x) if near.all() else int(np.argmin(near))
    rest = np.flatnonzero(away[:count] <= still / 5.0)
    return int(rest[-1]) if len(rest) else 0
