"""How much better a set of recordings is than others, on a table of outcomes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drake_screw.acquisition.cover import best_of_size, too_few
from drake_screw.acquisition.cover_table import Chosen, CoverTable
from drake_screw.bandits import Verdict
from drake_screw.bandits.spending import attempt_delta
from drake_screw.runs.selection import RecordingShare, RegionRate, SetOnTable
from drake_screw.runs.selection_table import Asked
from drake_screw.tasks import Regions


@dataclass(frozen=True, eq=False)
class Margins:
    """A chosen set beside its alternatives.

    Attributes:
        table: of outcomes.
        asked: what was asked of sets.
        names: of the D recordings.
        best: the set that was chosen; empty if there is none.
        tried: all sets that were tried, in their order.
        looks: how many tables were looked at, this one included.
    """

    table: CoverTable
    asked: Asked
    names: Sequence[str]
    best: Chosen
    tried: Sequence[Chosen]
    looks: int

    @property
    def chosen(self) -> SetOnTable | None:
        """The set itself."""
        return self._on_table(self.best) if self.best else None

    @property
    def fewer(self) -> SetOnTable | None:
        """The best set of one recording fewer; None if there is none, or it was not found."""
        return None if self._fewer is None else self._on_table(self._fewer)

    @property
    def runner_up(self) -> SetOnTable | None:
        """The best of the other sets of the same size; None likewise."""
        if not self.best:
            return None
        found = best_of_size(self.table, len(self.best), other_than=[self.best])
        return None if found is None else self._on_table(found)

    def fewer_ruled_out(self, delta: float) -> bool:
        """Whether no set of one recording fewer fails at most `tau` of the time in every region.

        Wrong with probability `delta` at most, however many tables were looked at: the k-th has
        the share of delta that attempt k to certify has.
        """
        if self._fewer is None:
            return False
        share = attempt_delta(delta, self.looks, spend=True)
        return too_few(self.table, self._fewer, self.asked.tau, share)

    def recordings(self) -> tuple[RecordingShare, ...]:
        """What each recording solves alone, and what the chosen solve without it."""
        found = []
        for d, name in enumerate(self.names):
            chosen, alone = d in self.best, self._shares((d,))
            others = [other for other in self.best if other != d]
            without = self._shares(others) if chosen else (None, None)
            found.append(RecordingShare(name, chosen, *alone, *without))
        return tuple(found)

    @cached_property
    def _fewer(self) -> Chosen | None:
        return best_of_size(self.table, len(self.best) - 1) if len(self.best) > 1 else None

    def _shares(self, chosen: Sequence[int]) -> tuple[float, float]:
        """What a set solves of the work area, and of its weakest region."""
        rates = self.table.rates(chosen)
        return 1.0 - float(rates @ self.asked.regions.shares), 1.0 - float(rates.max())

    def _on_table(self, chosen: Chosen) -> SetOnTable:
        whole, weakest = self._shares(chosen)
        return SetOnTable(
            recordings=tuple(self.names[d] for d in chosen),
            success=whole,
            success_in_weakest=weakest,
            weakest_region=self.asked.regions.name(int(np.argmax(self.table.rates(chosen)))),
            attempt=next(
                (i for i, tried in enumerate(self.tried, start=1) if set(chosen) <= set(tried)),
                None,
            ),
        )


def certified_rates(verdict: Verdict | None, regions: Regions) -> tuple[RegionRate, ...]:
    """The regions of a verdict; none without one."""
    if verdict is None:
        return ()
    return tuple(
        RegionRate(
            j,
            regions.name(j),
            int(verdict.samples[j]),
            int(verdict.failures[j]),
            float(verdict.upper[j]),
        )
        for j in range(len(verdict.samples))
    )


def short_rates(table: CoverTable, asked: Asked) -> tuple[RegionRate, ...]:
    """The regions that are too much for all recordings together, the weakest first."""
    samples, failures = table.samples, table.failures(range(table.D))
    short = sorted(asked.short(table).tolist(), key=lambda j: -failures[j])
    return tuple(
        RegionRate(j, asked.regions.name(j), int(samples[j]), int(failures[j]), None) for j in short
    )
