"""Certify or split: a box of any dimension, cut more finely only where something fails.

A grid fine enough to see a small part that fails has too many regions once several objects may
move. The tree below is fixed in advance: the unit box, halved along its axes in cyclic order. A
cell that cannot be cleared as a whole hands its samples down to its two halves. That is valid
because which cells exist does not depend on the samples, and the samples of one epoch that fall in
a cell are independent and uniform there, whichever ancestor they were drawn for.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from drake_screw.bandits.cell import Cell
from drake_screw.bandits.decision_boundary import clear_boundary
from drake_screw.bandits.mixture import confidence_interval, ln_e_flag
from drake_screw.bandits.tally import FIRST
from drake_screw.bandits.verdict import BanditError, Goal
from drake_screw.errors import confidence
from drake_screw.typing import Array

CellPull = Callable[[Array, Array, int], tuple[Array, Array]]
"""Lower and upper corner (d,) of a cell and a count -> fresh points (count, d), drawn uniformly and
independently in it, and which of them failed, (count,) bool."""


@dataclass(frozen=True, eq=False)
class TreeVerdict:
    """What a round on the tree concludes.

    Args:
        certified: all of the frontier is cleared.
        cell: where to ask for a demonstration; None when certified.
        reason: why the round ended, human-readable.
        claim: what the verdict states, human-readable.
        frontier: the cells that now make up the box, to be handed to the next round.
        total_samples: samples drawn in this round.
    """

    certified: bool
    cell: Cell | None
    reason: str
    claim: str
    frontier: tuple[Cell, ...]
    total_samples: int


@dataclass(frozen=True)
class CertifyOrSplit:
    """Tests on the frontier of a dyadic tree, by the e-processes of `mixture`.

    A cell of volume v is cleared below tau_c = min(1 - beta, level * smallest / v), so that no part
    of it with volume `smallest` or more fails over `level` of the time. Depth d and epoch e share
    delta: delta_c = delta 2^-d / ((d + 1) (d + 2)) / (e (e + 1)). An uncleared cell with a failure
    is split while larger than `smallest`. A cell is asked for once flagged (evidence 1/delta_c that
    it fails over (1 - epsilon / (1 - beta)) tau_c of the time), if it is of the smallest size or
    fails at least half of the time. Otherwise the failing cells of the smallest size, or if there
    are none all uncleared cells, at most double their samples.

    Args:
        goal: what to certify.
        dimension: axes of the unit box.
        smallest: volume of the smallest cells distinguished, in (0, 1].
        level: failure probability tolerated in a cell of that volume, in (0, 1).

    Raises:
        BanditError: a value outside its range.
    """

    name: ClassVar[str] = "certify_or_split"
    guarantee: ClassVar[str] = (
        "With probability 1 - delta in the whole run a certificate is true: every dyadic cell of "
        "at least the smallest volume fails at most max(level, 1 - beta) of the time, the whole "
        "box at most 1 - beta; a failing part that straddles cells can be missed."
    )

    goal: Goal
    dimension: int
    smallest: float
    level: float

    def __post_init__(self) -> None:
        if self.dimension < 1:
            raise BanditError(f"dimension is {self.dimension}", remedy="Give at least one axis.")
        if not 0.0 < self.smallest <= 1.0:
            raise BanditError(f"smallest is {self.smallest}", remedy="Give a volume in (0, 1].")
        if not 0.0 < self.level < 1.0:
            raise BanditError(f"level is {self.level}", remedy="Give a probability in (0, 1).")

    def start(self, epoch: int = 1) -> tuple[Cell, ...]:
        """The frontier of a first round: the whole box, uncleared."""
        d = self.dimension
        nothing = np.zeros((0, d)), np.zeros(0, dtype=bool)
        return (Cell(np.zeros(d), np.ones(d), 0, epoch, *nothing),)

    def cells(self, most: int) -> tuple[Cell, ...]:
        """The cells in which splitting ends, or larger ones if there are more than `most`."""
        cells = self.start()
        while cells[0].volume > self.smallest and 2 * len(cells) <= most:
            cells = tuple(half for cell in cells for half in cell.halves())
        return cells

    def advance(self, frontier: tuple[Cell, ...]) -> tuple[Cell, ...]:
        """The frontier after a new demonstration: cleared cells stay so, the others start over."""
        return tuple(cell if cell.cleared else cell.renewed() for cell in frontier)

    def decide(self, pull: CellPull, frontier: tuple[Cell, ...]) -> TreeVerdict:
        """Runs one round.

        Args:
            pull: draws fresh samples in a cell.
            frontier: from `start`, or by `advance` from the verdict of the round before.

        Raises:
            BanditError: a pull does not answer points of the cell and whether each failed.
        """
        cells, total = list(frontier), 0
        while True:
            cells = [part for cell in cells for part in self._settled(cell)]
            asked = [cell for cell in cells if self._asks(cell)]
            unsure = [i for i, cell in enumerate(cells) if not cell.cleared]
            if asked or not unsure:
                break
            for i in [i for i in unsure if cells[i].s > 0] or unsure:
                count = self._count(cells[i])
                cells[i] = _sampled(cells[i], pull, count)
                total += count
        cell = max(asked, key=lambda cell: cell.s / cell.n * cell.volume, default=None)
        return TreeVerdict(
            certified=cell is None,
            cell=cell,
            reason="all cells cleared" if cell is None else "cell flagged",
            claim=self._claim(cell),
            frontier=tuple(cells),
            total_samples=total,
        )

    def bounds(self, cell: Cell) -> tuple[float, float]:
        """Bounds on the failure probability of a cell, at its own share of delta.

        With probability 1 - delta those of all cells hold, in all rounds of a run.
        """
        low, high = confidence_interval(cell.n, cell.s, self._threshold(cell))
        return float(low), float(high)

    def least(self, cell: Cell) -> int:
        """The least number of samples at which the cell clears with the failures it has."""
        return int(clear_boundary(self.tau(cell), self._threshold(cell))(cell.s))

    def tau(self, cell: Cell) -> float:
        """The failure probability below which a cell is cleared."""
        return min(self.goal.tau, self.level * self.smallest / cell.volume)

    def _threshold(self, cell: Cell) -> float:
        """ln(1 / delta_c)."""
        d, e = cell.depth, cell.epoch
        share = cell.volume / ((d + 1) * (d + 2) * e * (e + 1))
        return -math.log(self.goal.delta * share)

    def _settled(self, cell: Cell) -> list[Cell]:
        """The cell, cleared where it clears; its parts, where it has to be split."""
        if cell.cleared or cell.n == 0:
            return [cell]
        if cell.n >= self.least(cell):
            return [replace(cell, cleared=True)]
        if cell.s == 0 or cell.volume <= self.smallest or self._asks(cell):
            return [cell]
        return [part for half in cell.halves() for part in self._settled(half)]

    def _asks(self, cell: Cell) -> bool:
        if cell.cleared or cell.s == 0:
            return False
        c = self._threshold(cell)
        q = self.tau(cell) * self.goal.q / self.goal.tau
        if ln_e_flag(cell.n, cell.s, q) < c:
            return False
        return cell.volume <= self.smallest or self.bounds(cell)[0] >= 0.5

    def _count(self, cell: Cell) -> int:
        """Samples to draw next in an uncleared cell."""
        more = self.least(cell) - cell.n
        if cell.s == 0:
            return min(more, max(FIRST, cell.n))
        return max(FIRST, min(more, cell.n))

    def _claim(self, cell: Cell | None) -> str:
        if cell is None:
            least = confidence(1.0 - max(self.level, self.goal.tau))
            held = f"confidence {confidence(1.0 - self.goal.delta)} for the whole run"
            return (
                f"every dyadic cell that takes up at least {self.smallest:.4g} of the whole "
                f"succeeds at least {least} of the time, the "
                f"whole at least {confidence(self.goal.beta)} ({held})"
            )
        return f"this cell fails at least {self.bounds(cell)[0]:.4f} of the time"


def _sampled(cell: Cell, pull: CellPull, count: int) -> Cell:
    points, failed = pull(cell.lower, cell.upper, count)
    points, failed = np.asarray(points, dtype=float), np.asarray(failed)
    if points.shape != (count, len(cell.lower)) or failed.shape != (count,):
        raise BanditError(
            f"a pull of {count} answered points {points.shape} and failures {failed.shape}",
            remedy=f"It must answer points ({count}, {len(cell.lower)}) and failures ({count},).",
        )
    if failed.dtype != np.bool_:
        raise BanditError(
            f"a pull answered failures of type {failed.dtype}", remedy="Answer true or false."
        )
    if ((points < cell.lower) | (points > cell.upper)).any():
        raise BanditError(
            "a pull answered points outside its cell", remedy="Draw them uniformly in the cell."
        )
    return cell.grown(points, failed)
