"""First touches along whole joint paths, one path after the other in compiled code.

The function is compiled once on a machine and kept in numba's cache. That looks at the text of this
file only, so the text of all files that are compiled into it is made part of its key.
"""

from __future__ import annotations

import hashlib
import logging
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_screw.cache_folder import cache_folder
from drake_screw.compile_cache import cached_njit
from drake_screw.planning.compiled import functions
from drake_screw.planning.compiled import inner as inner_module
from drake_screw.planning.compiled.inner import inner
from drake_screw.planning.swept import bounds, cell, convex, motion, separation, simplex, sweep
from drake_screw.planning.swept.cell import QUESTIONS
from drake_screw.planning.swept.sweep import NONE, set_out, stand

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_LOG = logging.getLogger(__name__)

_sweep = sweep.sweep
_SOURCES = (bounds, cell, convex, functions, inner_module, motion, separation, simplex, sweep)


class Touches(NamedTuple):
    """The first touch of each of N paths of an arm of n joints.

    Attributes:
        step: (N,) the step that it is in, from 0; -1 if nothing surely touches.
        place: (N,) where in it, 0 to 1.
        pair: (N,) the pair of shapes that touches, standing ones last; -1.
        questions: (N,) that are left open; more than QUESTIONS if there was no room for all.
        asked: (N, QUESTIONS, n) rad or m, the configurations in question.
        at: (N, QUESTIONS, 2) their step and their place in it.
    """

    step: Index
    place: Array
    pair: Index
    questions: Index
    asked: Array
    at: Array

    @staticmethod
    def none(N: int, n: int) -> Touches:
        """Of paths that have not been looked at."""
        return Touches(
            np.full(N, -1, dtype=np.int64),
            np.ones(N),
            np.full(N, -1, dtype=np.int64),
            np.zeros(N, dtype=np.int64),
            np.empty((N, QUESTIONS, n)),
            np.empty((N, QUESTIONS, 2)),
        )


@inner
def _begin(cell, room, X_WO, q, i, found):  # type: ignore[no-untyped-def]
    """Sets out on path i from q (n,); whether anything touches that the arm does not move."""
    found.pair[i] = stand(cell, room, X_WO, q)
    if found.pair[i] >= 0:
        found.step[i], found.place[i] = 0, 0.0
        return True
    set_out(cell, room, q)
    return False


@inner
def _end(room, i, found):  # type: ignore[no-untyped-def]
    """Hands on what is left open of path i."""
    found.questions[i] = room.questions[0]
    for k in range(min(room.questions[0], QUESTIONS)):
        for j in range(room.asked.shape[1]):
            found.asked[i, k, j] = room.asked[k, j]
        found.at[i, k, 0], found.at[i, k, 1] = room.at[k, 0], room.at[k, 1]


def _compiled(text: str) -> Any:
    """`touches_along`, compiled from a text of that hash."""

    @cached_njit(error_model="numpy", nogil=True)
    def steps(cell, room, q, first, X_WO, found):  # type: ignore[no-untyped-def]
        if text == "":
            return
        for i in range(len(first) - 1):
            if _begin(cell, room, X_WO[i], q[first[i], 0], i, found):
                continue
            for k in range(first[i], first[i + 1]):
                place, pair = _sweep(cell, room, k - first[i], q[k])
                if place < NONE:
                    found.step[i], found.place[i], found.pair[i] = k - first[i], place, pair
                    break
            if found.step[i] < 0:
                _end(room, i, found)

    return steps


_HASH = hashlib.sha256(
    b"\0".join(Path(m.__file__ or "").read_bytes() for m in _SOURCES)
).hexdigest()

touches_along = _compiled(_HASH)
"""Fill in the first touches of N paths.

Args:
    cell: the workcell.
    room: to work in.
    q: (T, 5, n) rad or m, the steps of one path after the other, as a `Trace` has them.
    first: (N + 1,) where each path begins.
    X_WO: (N, k, 4, 4) the objects of each.
    found: to fill in, `Touches.none` to begin with.
"""


@lru_cache
def say_if_it_takes_long() -> None:
    """Says, once, that `touches_along` is about to be compiled, where it never was before."""
    mark = cache_folder() / f"swept_{_HASH[:24]}.compiled"
    if not mark.exists():
        _LOG.info("compiling the collision checker, once; this takes about half a minute")
        with suppress(OSError):
            mark.touch()
