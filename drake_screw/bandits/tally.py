"""Counts of one round: all a strategy ever learns about the regions."""

from __future__ import annotations

import numpy as np

from drake_screw.bandits.verdict import BanditError, Pull
from drake_screw.typing import Array

FIRST = 16  # Samples of every region at the first look.
STEP = 64  # Samples of a region at a time, where regions are compared with one another.


class Tally:
    """Samples and failures of every region, grown by pulls.

    Args:
        pull: draws fresh samples.
        K: number of regions.

    Raises:
        BanditError: no region at all.
    """

    def __init__(self, pull: Pull, K: int) -> None:
        if K < 1:
            raise BanditError(f"{K} regions", remedy="Give at least one region.")
        self._pull = pull
        self.n = np.zeros(K, dtype=np.int64)
        self.s = np.zeros(K, dtype=np.int64)
        self.looks = 0

    @property
    def estimates(self) -> Array:
        """(K,) share of failures, 0 where nothing was drawn."""
        return self.s / np.maximum(self.n, 1)

    def draw(self, counts: Array | int) -> None:
        """Draws counts (K,) more samples, or as many in every region, and looks at the result.

        Raises:
            BanditError: the answer is not a number of failures for every region.
        """
        counts = np.broadcast_to(np.asarray(counts, dtype=np.int64), self.n.shape)
        failures = np.asarray(self._pull(counts.copy()))
        if failures.shape != counts.shape or not np.issubdtype(failures.dtype, np.integer):
            raise BanditError(
                f"a pull answered {failures.dtype} of shape {failures.shape}",
                remedy=f"It must answer integers of shape {counts.shape}, one for every region.",
            )
        if ((failures < 0) | (failures > counts)).any():
            raise BanditError(
                "a pull answered more failures than samples, or fewer than none",
                remedy="It must answer the failures among the samples asked for.",
            )
        self.n += counts
        self.s += failures
        self.looks += 1

    def draw_from(self, regions: Array, count: int) -> None:
        """Draws `count` more samples in each of some regions, an index or a mask array."""
        counts = np.zeros_like(self.n)
        counts[regions] = count
        self.draw(counts)
