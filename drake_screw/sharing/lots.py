"""How many jobs are sent at a time."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

MOST = 1000
"""Jobs in a lot."""


@dataclass(frozen=True)
class Lot:
    """Jobs that are sent together.

    Attributes:
        places: of the jobs among all.
        tries: how often they were sent before.
    """

    places: range
    tries: int = 0


class Lots:
    """Cuts jobs into lots, single ones at first, and as many to a lot as their length allows.

    Args:
        count: of jobs.
    """

    def __init__(self, count: int) -> None:
        self._count, self._next = count, 0
        self._again: deque[Lot] = deque()
        self._mean: float | None = None

    def __bool__(self) -> bool:
        return self._next < self._count or bool(self._again)

    def take(self, shares: int, seconds: float) -> Lot:
        """The next lot.

        Args:
            shares: how many lots are under way at a time.
            seconds: that one is to take.
        """
        if self._again:
            return self._again.popleft()
        first = self._next
        self._next = min(first + self._size(shares, seconds), self._count)
        return Lot(range(first, self._next))

    def put_back(self, lot: Lot) -> None:
        """A lot was lost; its jobs are sent once more, each by itself."""
        self._again.extend(Lot(range(at, at + 1), lot.tries + 1) for at in lot.places)

    def took(self, lot: Lot, seconds: float) -> None:
        """Learn from a lot how long jobs take; the last lots count most."""
        each = seconds / len(lot.places)
        self._mean = each if self._mean is None else 0.7 * self._mean + 0.3 * each

    def _size(self, shares: int, seconds: float) -> int:
        if self._mean is None:
            return 1
        fair = -(-(self._count - self._next) // shares)
        return max(1, min(fair, MOST, int(seconds / max(self._mean, 1e-9))))
