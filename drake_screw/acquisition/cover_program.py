"""The best set of a size as a mixed-integer linear program, for when there are too many sets
to go through.

There is a variable x_d for each candidate, 0 or 1: is it chosen; and a variable y_i for each kind
of instance, at most 1 and at most the sum of x_d over the candidates that solve it: is it solved.
HiGHS solves the program to the end, or gives it up. Counts are whole numbers, so constraints on
them are set half a failure wide, and no rounding in HiGHS decides.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

from drake_screw.acquisition.cover_table import Chosen, CoverTable, GaveUp
from drake_screw.typing import Array

TIME_LIMIT = 60.0
"""s, of one linear program. There are three for each answer, and more where sets are as good."""

_OPTIMAL, _INFEASIBLE = 0, 2  # status of scipy.optimize.milp


class Program:
    """The linear program of a table; each constraint makes another program.

    Its variables are x (D,), y (P,), and a number of failures that no region exceeds.

    Args:
        table: of what candidates solve.
        allowed: (K,) failures allowed in each region.
        beyond: sets none of which may have all of the answer among them.
    """

    def __init__(
        self, table: CoverTable, allowed: ArrayLike, beyond: Sequence[Sequence[int]] = ()
    ) -> None:
        self._table = table
        self._width = table.D + len(table.region) + 1
        self._nothing = np.zeros(self._width)
        self._integers = np.ones(self._width)
        self._integers[table.D : -1] = 0.0
        self._size, self._solved, self._worst = (self._nothing.copy() for _ in range(3))
        self._size[: table.D] = 1.0
        self._solved[table.D : -1] = table.weight
        self._worst[-1] = 1.0
        worst = self._regions().tolil()
        worst[:, -1] = 1.0
        self._constraints = (
            LinearConstraint(self._links(), -np.inf, 0.0),
            LinearConstraint(worst.tocsr(), table.samples, np.inf),
            self._within(np.asarray(allowed)),
            *(self._not_among(others) for others in ((), *beyond)),
        )

    def smallest(self) -> int | None:
        """The size of the smallest sets; None if there is none.

        Raises:
            GaveUp: HiGHS did not solve it; for want of time mostly, or of accuracy.
        """
        found = self._least(self._size)
        return None if found is None else len(found)

    def best(self, size: int) -> Chosen | None:
        """The best set of a size, in the sense of `cover.smallest`; None if there is none.

        Raises:
            GaveUp: HiGHS did not solve it; for want of time mostly, or of accuracy.
        """
        table = self._table
        among = [LinearConstraint(self._size[None], size, size)]
        found = self._least(self._worst, among)
        if found is None:
            return None
        among += [self._within(np.full(table.K, table.failures(found).max()))]
        found = self._least(-self._solved, among) or found
        solved = table.samples.sum() - table.failures(found).sum()
        among += [LinearConstraint(self._solved[None], solved - 0.5, np.inf)]
        if self._least(self._nothing, [*among, self._not_among(found)]) is None:
            return found
        for d in range(table.D):
            if d not in found:
                found = self._least(self._nothing, [*among, self._given(d, True)]) or found
            among += [self._given(d, d in found)]
        return found

    def _least(self, objective: Array, among: Sequence[LinearConstraint] = ()) -> Chosen | None:
        """A set that makes an objective least; None if none keeps the constraints."""
        D = self._table.D
        found = milp(
            objective,
            integrality=self._integers,
            bounds=Bounds(0.0, np.append(np.ones(self._width - 1), np.inf)),
            constraints=[*self._constraints, *among],
            options={"mip_rel_gap": 0.0, "time_limit": TIME_LIMIT},
        )
        if found.status == _INFEASIBLE:
            return None
        if found.status != _OPTIMAL:
            raise GaveUp(found.message)
        return tuple(np.flatnonzero(found.x[:D] > 0.5).tolist())

    def _within(self, allowed: Array) -> LinearConstraint:
        """At most so many failures in each region, (K,)."""
        return LinearConstraint(self._regions(), self._table.samples - allowed - 0.5, np.inf)

    def _not_among(self, others: Sequence[int]) -> LinearConstraint:
        """At least one candidate that is not among others."""
        row = self._size.copy()
        row[list(others)] = 0.0
        return LinearConstraint(row[None], 1.0, np.inf)

    def _given(self, candidate: int, chosen: bool) -> LinearConstraint:
        """Whether a candidate is chosen."""
        row = self._nothing.copy()
        row[candidate] = 1.0
        return LinearConstraint(row[None], int(chosen), int(chosen))

    def _links(self) -> csr_array:
        """(P, ...) y_i less the sum of x_d over those that solve it."""
        kind, candidate = np.nonzero(self._table.solves)
        P, D = self._table.solves.shape
        values = np.concatenate([-np.ones(len(kind)), np.ones(P)])
        rows = np.concatenate([kind, np.arange(P)])
        columns = np.concatenate([candidate, D + np.arange(P)])
        return csr_array((values, (rows, columns)), shape=(P, self._width))

    def _regions(self) -> csr_array:
        """(K, ...) instances of each region that are solved."""
        table = self._table
        where = table.region, table.D + np.arange(len(table.region))
        return csr_array((table.weight.astype(float), where), shape=(table.K, self._width))
