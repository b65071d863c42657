"""Which candidates solve which instances of every region, in as few rows as that takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.typing import Array

Chosen = tuple[int, ...]
"""A set of candidates, by number, in rising order."""


class GaveUp(Exception):
    """Finding a set takes too long."""


@dataclass(frozen=True, eq=False)
class CoverTable:
    """Which of D candidates solve which instances; instances that agree are counted together.

    Attributes:
        solves: (P, D) which candidates solve an instance of each kind.
        region: (P,) the region that its instances lie in, not falling.
        weight: (P,) how many instances there are of it.
        K: number of regions.

    >>> table = CoverTable.of([[1, 0], [1, 0], [0, 1], [0, 0]], region=[0, 0, 0, 1], K=2)
    >>> table.samples.tolist(), table.failures((0,)).tolist(), table.failures((0, 1)).tolist()
    ([3, 1], [1, 1], [0, 1])
    """

    solves: NDArray[np.bool_]
    region: NDArray[np.int64]
    weight: NDArray[np.int64]
    K: int

    @classmethod
    def of(cls, solved: ArrayLike, region: ArrayLike, K: int) -> Self:
        """The table of N instances.

        Args:
            solved: (N, D) whether each candidate solves each instance.
            region: (N,) the region that each lies in, from 0.
            K: number of regions.
        """
        table, place = np.asarray(solved, dtype=bool), np.asarray(region, dtype=np.int64)
        rows = np.column_stack([place, np.packbits(table, axis=1)])
        _, first, weight = np.unique(rows, axis=0, return_index=True, return_counts=True)
        return cls(table[first], place[first], weight.astype(np.int64), K)

    @property
    def D(self) -> int:
        """Number of candidates."""
        return self.solves.shape[1]

    @property
    def samples(self) -> NDArray[np.int64]:
        """(K,) instances in each region."""
        return self._count(np.ones_like(self.region, dtype=bool))

    def failures(self, chosen: Sequence[int]) -> NDArray[np.int64]:
        """(K,) instances of each region that none of the chosen solves."""
        solved = self.solves[:, list(chosen)]
        return self._count(np.logical_not(solved.any(axis=1)))

    def rates(self, chosen: Sequence[int]) -> Array:
        """(K,) share of each region's instances that none of the chosen solves; 0 of none."""
        return self.failures(chosen) / np.maximum(self.samples, 1)

    def _count(self, which: NDArray[np.bool_]) -> NDArray[np.int64]:
        counts = np.bincount(self.region, self.weight * which, minlength=self.K)
        return counts.astype(np.int64)
