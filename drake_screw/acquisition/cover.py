"""The fewest candidates that between them solve enough instances of every region.

That is a partial set cover. Candidates are known by what they solve of a table of instances, and by
nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import binom

from drake_screw.acquisition.cover_program import GaveUp, Program
from drake_screw.acquisition.cover_search import searched
from drake_screw.acquisition.cover_table import Chosen, CoverTable

MOST_WORK = 2e10
"""Sets of a size, times kinds of instances, that are gone through, which takes a minute at worst.
Where there are more of them, a linear program is solved."""


class Cover(NamedTuple):
    """A set of candidates that covers; `smallest` says whether none with fewer does."""

    chosen: Chosen
    smallest: bool


def smallest_cover(
    table: CoverTable, allowed: ArrayLike, *, beyond: Sequence[Sequence[int]] = ()
) -> Cover | None:
    """The best of the smallest sets that fail at most `allowed` instances of each region.

    Of sets of one size the best is that whose worst region has the fewest failures; of several, the
    one with the fewest failures in all; of several still, the first in order.

    Args:
        table: of what candidates solve.
        allowed: (K,) failures allowed in each region.
        beyond: sets none of which may have all of the answer among them: what they leave unsolved,
            any part of them leaves unsolved, too.

    Returns:
        The set; that of `greedy_cover` where looking for the smallest would take too long. None if
        there is none.
    """
    small = greedy_cover(table, allowed, beyond=beyond)
    if small is None:
        return None
    for size in range(1, len(small) + 1):
        if not _few(table, size):
            return _programmed(Program(table, allowed, beyond)) or Cover(small, False)
        found = searched(table, size, allowed, beyond)
        if found is not None:
            return Cover(found, True)
    return Cover(small, True)


def best_of_size(
    table: CoverTable, size: int, *, other_than: Sequence[Chosen] = ()
) -> Chosen | None:
    """The best set of a size, in the sense of `smallest_cover`, whether or not it solves enough.

    Args:
        table: of what candidates solve.
        size: of the set, at least 1.
        other_than: sets of that size which the answer must not be.

    Returns:
        The set; None if there is none, or looking for it would take too long.
    """
    if _few(table, size):
        return searched(table, size, table.samples, other_than)
    try:
        return Program(table, table.samples, other_than).best(size)
    except GaveUp:
        return None


def too_few(table: CoverTable, best: Chosen, tau: ArrayLike, delta: float) -> bool:
    """Whether no set of a size fails seldom enough in every region, with confidence 1 - delta.

    A set that does would fail as often on the table as the best of that size, or oftener, in its
    worst region: for each of the sets and regions the chance of that is one of a binomial
    distribution, and the answer is yes where all of them add up to delta at most.

    Args:
        table: of instances drawn uniformly in each region.
        best: the set of that size whose worst region has the fewest failures, see `best_of_size`.
        tau: (K,) failure probability that a set may have in each region; or one for all.
        delta: chance that the answer is yes although there is such a set.

    >>> table = CoverTable.of([[1, 0]] * 50 + [[0, 1]] * 50, [0] * 100, K=1)
    >>> too_few(table, (0,), 0.05, delta=0.05), too_few(table, (0,), 0.45, delta=0.05)
    (True, False)
    """
    failures = table.failures(best).max()
    chance = binom.sf(failures - 1, table.samples, np.asarray(tau)).sum()
    return bool(comb(table.D, len(best)) * chance <= delta)


def greedy_cover(
    table: CoverTable, allowed: ArrayLike, *, beyond: Sequence[Sequence[int]] = ()
) -> Chosen | None:
    """A small set that fails at most `allowed` instances of each region; not always the smallest.

    One after the other the candidate is added that leaves the fewest failures above those allowed,
    the first of several; then each is left out again, the last added first, where the others do.

    Args:
        table, allowed, beyond: as for `smallest_cover`.

    Returns:
        The set; None if there is none.
    """
    limit = np.asarray(allowed)

    def missing(chosen: Sequence[int]) -> tuple[int, int]:
        excess = np.maximum(table.failures(chosen) - limit, 0)
        return int(excess.sum()), sum(set(chosen) <= set(others) for others in beyond)

    chosen: list[int] = []
    while not chosen or any(missing(chosen)):
        left = [d for d in range(table.D) if d not in chosen]
        if not left:
            return None
        chosen.append(min(left, key=lambda d: missing([*chosen, d])))
    for d in reversed(chosen.copy()):
        fewer = [other for other in chosen if other != d]
        if fewer and not any(missing(fewer)):
            chosen = fewer
    return tuple(sorted(chosen))


def _few(table: CoverTable, size: int) -> bool:
    return comb(table.D, size) * len(table.region) <= MOST_WORK


def _programmed(program: Program) -> Cover | None:
    try:
        size = program.smallest()
        found = None if size is None else program.best(size)
    except GaveUp:
        return None
    return None if found is None else Cover(found, True)
