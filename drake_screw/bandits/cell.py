"""One cell of a dyadic tree over the unit box, and the samples that lie in it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from drake_screw.typing import Array


@dataclass(frozen=True, eq=False)
class Cell:
    """A cell of the tree, with the samples of its epoch that lie in it.

    Args:
        lower: (d,) corner.
        upper: (d,) opposite corner.
        depth: number of halvings that lead to it.
        epoch: 1 + the number of demonstrations that had been added when its samples were drawn.
        points: (n, d) samples, in the order they were drawn.
        failed: (n,) bool, which of them failed.
        cleared: shown to fail seldom enough.
    """

    lower: Array
    upper: Array
    depth: int
    epoch: int
    points: Array
    failed: Array
    cleared: bool = False

    @property
    def volume(self) -> float:
        """Share of the unit box."""
        return 0.5**self.depth

    @property
    def n(self) -> int:
        """Samples in the cell."""
        return len(self.failed)

    @cached_property
    def s(self) -> int:
        """Failures among them."""
        return int(self.failed.sum())

    def renewed(self) -> Cell:
        """The same cell in the next epoch, without samples."""
        return replace(self, epoch=self.epoch + 1, points=self.points[:0], failed=self.failed[:0])

    def grown(self, points: Array, failed: Array) -> Cell:
        """With more samples."""
        return replace(
            self,
            points=np.concatenate([self.points, points]),
            failed=np.concatenate([self.failed, failed]),
        )

    def halves(self) -> tuple[Cell, Cell]:
        """Its two children, with the samples that lie in them."""
        axis = self.depth % len(self.lower)
        middle = 0.5 * (self.lower[axis] + self.upper[axis])
        upper, lower = self.upper.copy(), self.lower.copy()
        upper[axis] = lower[axis] = middle
        below = self.points[:, axis] < middle

        def child(low: Array, high: Array, inside: Array) -> Cell:
            points, failed = self.points[inside], self.failed[inside]
            return Cell(low, high, self.depth + 1, self.epoch, points, failed)

        return child(self.lower, upper, below), child(lower, self.upper, ~below)


def cell_number(lower: Array, upper: Array) -> int:
    """The number of a cell in the tree: 1 for the unit box, 2 i and 2 i + 1 for cell i's halves.

    Args:
        lower, upper: (d,) its corners.
    """
    number = 1
    depth = -int(np.log2(upper - lower).sum())
    low, high = np.zeros(len(lower)), np.ones(len(upper))
    for step in range(depth):
        axis = step % len(lower)
        middle = 0.5 * (low[axis] + high[axis])
        above = bool(lower[axis] >= middle)
        (low if above else high)[axis] = middle
        number = 2 * number + above
    return number
