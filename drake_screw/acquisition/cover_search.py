"""The best set of a size by going through the sets, without those that cannot be the best.

Sets grow candidate by candidate. What the candidates still to come solve of a region is at most
what the strongest of them solve of it now, with no overlap. Where that is too little in some
region, a set is given up. The next candidate is sought for the region that is nearest to that, the
strongest there first; what was tried is out for those after it, and soon they are too weak. Nothing
is lost by it, and all counts are whole numbers.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.acquisition.cover_table import Chosen, CoverTable, GaveUp
from drake_screw.typing import Array

VISIT = 60_000
"""Work that every set begun is worth; beside that, each candidate looked at is worth 1 for every
kind of instance. Some 6e8 are done in a second."""


def searched(
    table: CoverTable,
    size: int,
    allowed: ArrayLike,
    beyond: Sequence[Sequence[int]] = (),
    *,
    most_work: float = np.inf,
) -> Chosen | None:
    """The best set of a size, in the sense of `cover.smallest_cover`; None if there is none.

    Args:
        table: of what candidates solve.
        size: of the set, at least 1.
        allowed: (K,) failures allowed in each region.
        beyond: sets none of which may have all of the answer among them.
        most_work: that may be done, as `VISIT` counts it.

    Raises:
        GaveUp: it is more work than that.
    """
    if size > table.D:
        return None
    others = [set(each) for each in beyond]
    search = _Search(table, np.asarray(allowed, dtype=float), others, most_work)
    search.visit((), np.ones(len(table.region), dtype=bool), np.arange(table.D), size)
    return search.found


class _Search:
    def __init__(
        self, table: CoverTable, limit: Array, beyond: Sequence[set[int]], work: float
    ) -> None:
        self.found: Chosen | None = None
        self._work = work
        self._key: tuple[float, float, Chosen] = (np.inf, np.inf, ())
        self._beyond = beyond
        self._fails = np.ascontiguousarray(~table.solves.T)  # (D, P)
        self._weight = table.weight.astype(np.int32)
        present, self._starts = np.unique(table.region, return_index=True)
        self._limit = limit[present]

    def visit(
        self, chosen: Chosen, fails: NDArray[np.bool_], among: NDArray[np.int64], more: int
    ) -> None:
        """Go through the sets that have these candidates, and more.

        Args:
            chosen: in the order in which they were.
            fails: (P,) kinds of instances that none of them solves.
            among: candidates to choose from, at least `more`.
            more: how many to choose, at least 1.
        """
        self._work -= VISIT + len(among) * len(fails)
        if self._work < 0.0:
            raise GaveUp
        left = fails & self._fails[among]
        failures = self._count(left)  # (candidates, regions with instances)
        if more == 1:
            self._compare(chosen, among, failures)
            return
        now = self._count(fails)
        gains = now - failures
        least = now - np.partition(gains, -more, axis=0)[-more:].sum(axis=0)
        if self._hopeless(least):
            return
        region = int(np.argmax(least - self._limit))
        order = np.argsort(-gains[:, region], kind="stable")
        for i, first in enumerate(order[: len(order) - more + 1]):
            strongest = gains[order[i : i + more], region].sum()
            if now[region] - strongest > self._limit[region]:
                return
            self.visit((*chosen, int(among[first])), left[first], among[order[i + 1 :]], more - 1)

    def _hopeless(self, least: NDArray[np.int32]) -> bool:
        """Whether a set that fails at least so much, (regions,), is none or not the best."""
        worst, total, _ = self._key
        too_many = bool((least > self._limit).any())
        return too_many or (least.max() >= worst and np.maximum(least, 0).sum() > total)

    def _compare(
        self, chosen: Chosen, among: NDArray[np.int64], failures: NDArray[np.int32]
    ) -> None:
        """Take the best of the sets that one more candidate makes, if it is better than before."""
        for i in np.flatnonzero((failures <= self._limit).all(axis=1)).tolist():
            found = tuple(sorted((*chosen, int(among[i]))))
            key = int(failures[i].max()), int(failures[i].sum()), found
            if key < self._key and not any(others.issuperset(found) for others in self._beyond):
                self.found, self._key = found, key
                self._limit = np.minimum(self._limit, key[0])

    def _count(self, fails: NDArray[np.bool_]) -> NDArray[np.int32]:
        """(..., P) to (..., regions) instances that fail."""
        return np.add.reduceat(fails * self._weight, self._starts, axis=-1)
