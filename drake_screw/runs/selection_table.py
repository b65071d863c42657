"""The table of outcomes on which sets of recordings are compared, and what is asked of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from drake_screw.acquisition.cover_table import CoverTable
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Demonstration
from drake_screw.runs.selection_events import Listener
from drake_screw.steps import Step
from drake_screw.tasks import Regions, box_regions, draw_in_all

ROUND = 2_000_000
"""The round whose instances the table has; those that follow certify. No run gets that far."""

CELLS = 1024  # regions of the table at most, where they are adaptive
BATCH = 512  # instances


@dataclass(frozen=True, eq=False)
class Asked:
    """What a set has to solve of each region: the same of all.

    Attributes:
        regions: the scenario's, or where they are adaptive the smallest cells, if these are not
            too many.
        tau: failure probability that may not be exceeded.
        q: failure rate on the table that a set should have before it is tried.
    """

    regions: Regions
    tau: float
    q: float

    @classmethod
    def of(cls, setup: Setup) -> Self:
        """What a scenario asks."""
        goal, tree = setup.goal, setup.tree
        if tree is None:
            return cls(setup.regions, goal.tau, goal.q)
        cells = tree.cells(CELLS)
        corners = [cell.lower for cell in cells], [cell.upper for cell in cells]
        tau = tree.tau(cells[0])
        return cls(box_regions(setup.area, *corners), tau, tau * goal.q / goal.tau)

    def allowed(self, table: CoverTable) -> NDArray[np.int64]:
        """(K,) failures on the table before a set is tried.

        That is `q` of the instances, and `tau` of them in a region that is `relaxed`.
        """
        return np.where(self.relaxed(table), _part(self.tau, table), _part(self.q, table))

    def relaxed(self, table: CoverTable) -> NDArray[np.bool_]:
        """(K,) the regions that even all recordings together fail oftener than `q`."""
        return table.failures(range(table.D)) > _part(self.q, table)

    def short(self, table: CoverTable) -> NDArray[np.int64]:
        """The regions that even all recordings together fail oftener than `tau`."""
        return np.flatnonzero(table.failures(range(table.D)) > _part(self.tau, table))

    def surely_short(self, table: CoverTable, delta: float) -> bool:
        """Whether a table has instances enough to take `short` regions for more than bad luck.

        If none failed oftener than `tau`, the answer would be yes with probability `delta` at most.
        """
        from scipy.stats import binom  # takes long to import

        chance = binom.sf(table.failures(range(table.D)) - 1, table.samples, self.tau)
        return bool((chance <= delta / table.K).any())


def _part(share: float, table: CoverTable) -> NDArray[np.int64]:
    """(K,) that share of each region's instances, rounded down but for rounding errors."""
    return np.floor(share * table.samples + 1e-9).astype(np.int64)


class GrowingTable:
    """Instances drawn uniformly in each region, planned with all recordings.

    Args:
        setup: of the scenario.
        demonstrations: D of them.
        regions: to draw in.
        each: instances in each region at first; every time it grows, it doubles.
        tell: is told how far the planning is.

    Attributes:
        each: instances in each region so far.
        looks: how often it has been looked at.
    """

    def __init__(
        self,
        setup: Setup,
        demonstrations: Sequence[Demonstration],
        regions: Regions,
        each: int,
        tell: Listener,
    ) -> None:
        self._setup = setup
        self._demonstrations = demonstrations
        self._regions = regions
        self._tell = tell
        self.each, self.looks = 0, 0
        self._first = each
        self._solved: list[NDArray[np.bool_]] = []
        self._region: list[NDArray[np.int64]] = []

    def grown(self) -> CoverTable:
        """The table with more instances, those that it had among them."""
        setup, had = self._setup, self.each
        self.each = 2 * had or self._first
        self.looks += 1
        coordinates, region = draw_in_all(
            self._regions, self.each - had, seed=setup.scenario.seed, round=ROUND, starts=had
        )
        N, D = len(region), len(self._demonstrations)
        words = f"planning {N:,} instances with {D} recording{'' if D == 1 else 's'}"
        self._tell(Step(words, 0, N))
        for first in range(0, N, BATCH):
            some = slice(first, first + BATCH)
            outcomes = setup.evaluate(self._demonstrations, coordinates[some])
            self._solved.append(outcomes.success)
            self._region.append(region[some])
            self._tell(Step(words, min(first + BATCH, N), N))
        return CoverTable.of(
            np.concatenate(self._solved), np.concatenate(self._region), self._regions.K
        )
