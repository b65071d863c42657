"""Where the e-processes decide, as whole numbers of samples, remembered between rounds."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from drake_screw.bandits.mixture import ln_e_clear, ln_e_flag
from drake_screw.typing import Array


class ClearBoundary:
    """The least n for which n samples with s failures are evidence exp(c) against "t or more".

    With s failures, another success never lowers the evidence, so a region clears at this n and at
    every larger one.

    Args:
        t: failure probability that is tested.
        c: threshold of `mixture.ln_e_clear`, positive.
    """

    def __init__(self, t: float, c: float) -> None:
        self._t = t
        self._c = c
        self._known = np.full(64, -1, dtype=np.int64)

    def __call__(self, s: Array | int) -> Array:
        """least n (...) int for s (...) failures."""
        s = np.asarray(s)
        if s.max() >= len(self._known):
            grown = np.full(2 * int(s.max()), -1, dtype=np.int64)
            grown[: len(self._known)] = self._known
            self._known = grown
        n = self._known[s]
        if (n < 0).any():
            unknown = np.unique(s[n < 0])
            self._known[unknown] = self._search(unknown)
            n = self._known[s]
        return n

    def _search(self, s: Array) -> Array:
        below, above = s.copy(), s + 64
        while (late := ln_e_clear(above, s, self._t) < self._c).any():
            below = np.where(late, above, below)
            above = np.where(late, 2 * above, above)
        while (above - below > 1).any():
            middle = (below + above) // 2
            clears = ln_e_clear(middle, s, self._t) >= self._c
            above = np.where(clears, middle, above)
            below = np.where(clears, below, middle)
        return above


@lru_cache(maxsize=1024)
def clear_boundary(t: float, c: float) -> ClearBoundary:
    """The one `ClearBoundary` for t and c."""
    return ClearBoundary(t, c)


@lru_cache(maxsize=1024)
def deciding_size(tau: float, c_clear: float, q: float, c_flag: float) -> int:
    """The least n at which every number of failures is cleared or flagged.

    Cleared: evidence exp(c_clear) against "tau or more". Flagged: evidence exp(c_flag) against "q
    or less", with q < tau.
    """
    boundary = clear_boundary(tau, c_clear)

    def decides(s: int) -> bool:
        return bool(ln_e_flag(int(boundary(s)), s + 1, q) >= c_flag)

    below, above = -1, 1
    while not decides(above):
        below, above = above, 2 * above
    while above - below > 1:
        middle = (below + above) // 2
        below, above = (below, middle) if decides(middle) else (middle, above)
    return int(boundary(above))
