"""The best set of a size by going through the sets, without those that cannot be the best.

Sets grow candidate by candidate, in rising order. A set is given up as soon as some region fails
too often even if each candidate still to come solved what it solves there of the rest, with no
overlap: so much at least the region will keep failing. That is exact, and quick as long as
there are not too many sets, whatever the table looks like.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.acquisition.cover_table import Chosen, CoverTable
from drake_screw.typing import Array


def searched(
    table: CoverTable, size: int, allowed: ArrayLike, beyond: Sequence[Sequence[int]] = ()
) -> Chosen | None:
    """The best set of a size, in the sense of `cover.smallest`; None if there is none.

    Args:
        table: of what candidates solve.
        size: of the set, at least 1.
        allowed: (K,) failures allowed in each region.
        beyond: sets none of which may have all of the answer among them.
    """
    search = _Search(table, np.asarray(allowed, dtype=float), [set(others) for others in beyond])
    search.visit((), np.ones(len(table.region), dtype=bool), size)
    return search.found


class _Search:
    def __init__(self, table: CoverTable, limit: Array, beyond: Sequence[set[int]]) -> None:
        self.found: Chosen | None = None
        self._key: tuple[float, float] = (np.inf, np.inf)
        self._beyond = beyond
        self._fails = np.ascontiguousarray(~table.solves.T)  # (D, P)
        self._weight = table.weight.astype(np.int32)
        present, self._starts = np.unique(table.region, return_index=True)
        self._limit = limit[present]

    def visit(self, chosen: Chosen, fails: NDArray[np.bool_], more: int) -> None:
        """Go through the sets that begin like this one.

        Args:
            chosen: so far.
            fails: (P,) kinds of instances that none of them solves.
            more: candidates still to choose, at least 1.
        """
        first = chosen[-1] + 1 if chosen else 0
        left = fails & self._fails[first:]
        failures = self._count(left)  # (candidates, regions with instances)
        if more == 1:
            self._compare(chosen, first, failures)
            return
        gains = self._count(fails) - failures
        for i in range(len(left) - more + 1):
            most = np.partition(gains[i + 1 :], -(more - 1), axis=0)[-(more - 1) :].sum(axis=0)
            if (failures[i] - most <= self._limit).all():
                self.visit((*chosen, first + i), left[i], more - 1)

    def _compare(self, chosen: Chosen, first: int, failures: NDArray[np.int32]) -> None:
        """Take the best of the sets that one more candidate makes, if it is better than before."""
        for i in np.flatnonzero((failures <= self._limit).all(axis=1)).tolist():
            found = (*chosen, first + i)
            key = int(failures[i].max()), int(failures[i].sum())
            if key < self._key and not any(others.issuperset(found) for others in self._beyond):
                self.found, self._key = found, key
                self._limit = np.minimum(self._limit, key[0])

    def _count(self, fails: NDArray[np.bool_]) -> NDArray[np.int32]:
        """(..., P) to (..., regions) instances that fail."""
        return np.add.reduceat(fails * self._weight, self._starts, axis=-1)
