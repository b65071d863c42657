"""The fewest constant screws that hold a path of poses within tolerances, in the order shown."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drake_screw.demonstrations.screw_fit import search
from drake_screw.screws import quaternion_from_rotation
from drake_screw.typing import Array

_REFINEMENTS = 5  # halvings of the share of the tolerances at which as many screws still do


def fewest_screws(
    X_WE: Array,
    candidates: Array,
    position_tolerance: float,
    rotation_tolerance: float,
) -> Array:
    """Where to cut a path so that the fewest constant screws hold all of its poses.

    A breadth-first search over the candidates: those reached from the first by one screw, by two,
    and so on. Of the ways with the fewest screws it takes one whose worst deviation, in proportion
    to the tolerances, is least to within 1/32 of them. What it takes to hold a pose is said in
    `screw_fit`. No screw turns by more than `LARGEST_TURN`, unless it leads from a candidate to the
    very next.

    Args:
        X_WE: (m, 4, 4) a path.
        candidates: (c,) increasing indices at which it may be cut, the first 0, the last m - 1.
            There is always an answer if all poses from one to the next are within the tolerances of
            that one.
        position_tolerance: m.
        rotation_tolerance: rad, at most 1.

    Returns:
        (g,) indices, the first and the last pose among them; none if even the screws from each
        candidate to the next do not hold the poses.
    """
    path = _Path.of(
        X_WE, np.asarray(candidates, dtype=np.int64), (position_tolerance, rotation_tolerance)
    )
    count = len(path.candidates)
    failed, anywhere = np.zeros((count, count)), np.full(count, -1)
    screws, before = path.search(anywhere, failed, 1.0)
    if screws[-1] < 0:
        return path.candidates[:0]
    # A candidate on a way with the fewest screws is reached by the fewest from both ends, whatever
    # the tolerances: so there is one number of screws at which it is of use.
    rank = np.where(screws >= 0, screws, count)
    from_end = np.where(screws >= 0, screws[-1] - screws, count)[::-1]
    to_end, _ = path.backwards().search(from_end, failed[::-1, ::-1].T.copy(), 1.0)
    rank = np.where(to_end[::-1] >= 0, rank, count)
    nearer = path.nearest(int(screws[-1]), rank, failed)
    return path.cuts(before) if nearer is None else nearer


@dataclass(frozen=True)
class _Path:
    """What a search is about.

    Attributes:
        p, q: (m, 3) m and (m, 4), positions and quaternions.
        candidates: (c,) where to cut.
        tolerances: m and rad.
    """

    p: Array
    q: Array
    candidates: Array
    tolerances: tuple[float, float]

    @classmethod
    def of(cls, X_WE: Array, candidates: Array, tolerances: tuple[float, float]) -> _Path:
        p, q = np.ascontiguousarray(X_WE[:, :3, 3]), quaternion_from_rotation(X_WE[:, :3, :3])
        return cls(p, q, candidates, tolerances)

    def backwards(self) -> _Path:
        p, q = (np.ascontiguousarray(a[::-1]) for a in (self.p, self.q))
        return _Path(p, q, len(p) - 1 - self.candidates[::-1], self.tolerances)

    def cuts(self, before: Array) -> Array:
        """The candidates on the way to the last one, each with the one before it."""
        way = [len(self.candidates) - 1]
        while way[-1] > 0:
            way.append(int(before[way[-1]]))
        return self.candidates[way[::-1]]

    def nearest(self, most: int, rank: Array, failed: Array) -> Array | None:
        """Cuts for the least share of the tolerances, below 1, where so many screws do."""
        nearest, low, high = None, 0.0, 1.0
        for _ in range(_REFINEMENTS):
            middle = 0.5 * (low + high)
            screws, before = self.search(rank, failed, middle)
            if 0 <= screws[-1] <= most:
                nearest, high = self.cuts(before), middle
            else:
                low = middle
        return nearest

    def search(self, rank: Array, failed: Array, share: float) -> tuple[Array, Array]:
        """As `screw_fit.search`."""
        return search(self.p, self.q, self.candidates, rank, failed, share, *self.tolerances)
