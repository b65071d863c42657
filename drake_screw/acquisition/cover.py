"""The fewest candidates that between them solve enough instances of every region.

That is a partial set cover. Candidates are known by what they solve of a table of instances, and by
nothing else. Sets are gone through (`cover_search`), in seconds as a rule. Where that is too much
work, a linear program is solved (`cover_program`); where that takes too long, too, sets are gone
through once more, for a minute.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.acquisition.cover_program import Program
from drake_screw.acquisition.cover_search import searched
from drake_screw.acquisition.cover_table import Chosen, CoverTable, GaveUp

WORK = 2e9, 3e10
"""Of going through sets before it is given up, at first and in the end; some seconds, and a minute.
"""


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

    def through(most_work: float) -> Chosen | None:
        sizes = range(1, len(small) + 1)
        found = (searched(table, size, allowed, beyond, most_work=most_work) for size in sizes)
        return next(filter(None, found), None)

    def programmed() -> Chosen | None:
        program = Program(table, allowed, beyond)
        size = program.smallest()
        return None if size is None else program.best(size)

    with suppress(GaveUp):
        found = _first(through, programmed)
        return Cover(small, False) if found is None else Cover(found, True)
    return Cover(small, False)


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

    def through(most_work: float) -> Chosen | None:
        return searched(table, size, table.samples, other_than, most_work=most_work)

    with suppress(GaveUp):
        return _first(through, lambda: Program(table, table.samples, other_than).best(size))
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
    from scipy.stats import binom  # takes long to import

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


def _first(
    through: Callable[[float], Chosen | None], programmed: Callable[[], Chosen | None]
) -> Chosen | None:
    """The answer of the first way that gives one.

    Raises:
        GaveUp: none does.
    """
    with suppress(GaveUp):
        return through(WORK[0])
    with suppress(GaveUp):
        return programmed()
    return through(WORK[1])
