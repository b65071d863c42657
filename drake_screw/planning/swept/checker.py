"""Which paths touch something: bounds decide what they can, and Drake the rest."""

from __future__ import annotations

import threading
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.compiled.trace import dense_output
from drake_screw.planning.swept.along import Touches, say_if_it_takes_long, touches_along
from drake_screw.planning.swept.cell import QUESTIONS, room_for
from drake_screw.planning.swept.shapes import cell_of
from drake_screw.robot import Workcell
from drake_screw.typing import Array

CLOSE = 2e-3
"""rad (or m), summed up over the joints, between configurations that Drake is asked about where a
path leaves more open than QUESTIONS."""


FINE = 5e-4
"""m, to which the distance along a path is found."""


@dataclass(frozen=True, eq=False)
class Touched:
    """The first touch of each of N paths, as far as there is one.

    Attributes:
        touches: (N,) whether there is.
        step: (N,) the step that it is in, counted from the path's first; -1 if there is none.
        place: (N,) where in it, 0 to 1.
        pair: (N,) which of `Workcell.pairs` touches; -1 where Drake said that something does.
        q: (N, n) rad or m, the configuration; NaN if there is none.
    """

    touches: NDArray[np.bool_]
    step: NDArray[np.int64]
    place: Array
    pair: NDArray[np.int64]
    q: Array


class SweptChecker:
    """Finds what touches along paths of a workcell's arm.

    A touch is nearer than the clearance, or where that is 0 a contact. Nothing deeper than
    `sweep.FINEST` goes unnoticed between the configurations that are looked at; and where bounds
    leave open whether something touches at one of them, Drake is asked.

    Args:
        workcell: robot and surroundings.
        clearance: m, that robot and surroundings, and the robot's own parts, have to keep.

    Attributes:
        asked: configurations that Drake was asked about so far.
    """

    def __init__(self, workcell: Workcell, clearance: float = 0.0) -> None:
        self.workcell, self.clearance = workcell, clearance
        self.cell, self._pair = cell_of(workcell, clearance)
        self.asked = 0
        self._drake = workcell.checker if clearance == 0.0 else workcell.keeping(clearance)
        self._one_at_a_time = threading.Lock()

    def along(self, q: Array, first: NDArray[np.int64], X_WO: Array) -> Touched:
        """Check N paths.

        Args:
            q: (T, 5, n) rad or m, their steps, one path after the other, as a `Trace` has them.
            first: (N + 1,) where each path begins; none is without a step.
            X_WO: (N, k, 4, 4) the objects of each.
        """
        say_if_it_takes_long()
        N, n = len(first) - 1, q.shape[2]
        found = Touches.none(N, n)
        touches_along(
            self.cell,
            room_for(self.cell),
            np.ascontiguousarray(q, dtype=float),
            np.ascontiguousarray(first, dtype=np.int64),
            np.ascontiguousarray(X_WO, dtype=float),
            found,
        )
        pair, known = np.full(N, -1), found.pair >= 0
        pair[known] = self._pair[found.pair[known]]
        self._decide(found, q, first, X_WO)
        touches = found.step >= 0
        there = np.full((N, n), np.nan)
        some = np.flatnonzero(touches)
        there[some] = self._clipped(
            dense_output(q[first[some] + found.step[some]], found.place[some])
        )
        return Touched(touches, found.step, found.place, pair, there)

    def distance_along(self, q: Array, X_WO: Array, most: float) -> float:
        """How far apart everything stays along a path, up to `most` and but for FINE, in m.

        Found by halving an interval of clearances; what is left open counts as nearer. Links that
        cannot touch, whatever the joints between them do, do not count.

        Args:
            q: (T, 5, n) rad or m, the path's steps.
            X_WO: (k, 4, 4) the objects.
            most: m.
        """
        q, first = np.ascontiguousarray(q, dtype=float), np.array([0, len(q)])
        kept, lost = 0.0, most + FINE
        while lost - kept > FINE:
            middle = 0.5 * (kept + lost)
            cell, found = self.cell._replace(clearance=middle), Touches.none(1, q.shape[2])
            touches_along(cell, room_for(cell), q, first, X_WO[None], found)
            if found.step[0] >= 0 or found.questions[0] > 0:
                lost = middle
            else:
                kept = middle
        return min(kept, most)

    def _decide(self, found: Touches, q: Array, first: NDArray[np.int64], X_WO: Array) -> None:
        """Ask Drake what is left open, and put down the first touch of each path that it finds."""
        for i in np.flatnonzero(found.questions > 0).tolist():
            if found.questions[i] <= QUESTIONS:
                asked, at = (x[i, : found.questions[i]] for x in (found.asked, found.at))
            else:
                asked, at = self._all_along(q[first[i] : first[i + 1]])
            hits = np.flatnonzero(self.touches(asked, X_WO[i]))
            if len(hits):
                earliest = hits[np.lexsort((at[hits, 1], at[hits, 0]))[0]]
                found.step[i], found.place[i] = int(at[earliest, 0]), at[earliest, 1]

    def touches(self, q: Array, X_WO: Array) -> NDArray[np.bool_]:
        """Whether anything touches at configurations q (m, n), by Drake; X_WO (k, 4, 4)."""
        with self._one_at_a_time:
            self.asked += len(q)
            return self.workcell.collides(q, X_WO, checker=self._drake)

    def _all_along(self, q: Array) -> tuple[Array, Array]:
        """Configurations (m, n) CLOSE to one another along steps, and steps and places (m, 2)."""
        motion = np.abs(np.diff(q[:, :2], axis=1)).sum(axis=(1, 2)) + np.abs(q[:, 4]).sum(axis=1)
        parts = np.maximum(np.ceil(motion / CLOSE).astype(int), 1)
        step = np.repeat(np.arange(len(q)), parts)
        place = np.concatenate([(np.arange(p) + 0.5) / p for p in parts])
        return self._clipped(dense_output(q[step], place)), np.column_stack([step, place])

    def _clipped(self, q: Array) -> Array:
        return np.clip(q, *self.cell.limits)


def lines(q: Array) -> Array:
    """Steps (m - 1, 5, n) of straight lines through points q (m, n); one step for one point."""
    if len(q) == 1:
        q = np.concatenate([q, q])
    return straight_steps(q[:-1], q[1:])


def straight_steps(start: Array, end: Array) -> Array:
    """Steps (m, 5, n), as a `Trace` has them, of straight lines from (m, n) to (m, n)."""
    way = end - start
    return np.stack([start, end, way, way, np.zeros_like(way)], axis=1)
