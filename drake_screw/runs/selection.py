"""What a selection of recordings found, in plain values and in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from drake_screw.errors import confidence


@dataclass(frozen=True)
class TableSummary:
    """The table of outcomes that sets are chosen on.

    Attributes:
        regions: of the table; where regions are adaptive, cells of one size.
        instances_per_region: drawn in each.
        success_asked: share of a region's instances that a set has to solve before it is tried.
        success_needed: success probability that is to be certified in each.
        relaxed: regions in which not even all recordings together solve what is asked; there a set
            has to solve what is needed.
    """

    regions: int
    instances_per_region: int
    success_asked: float
    success_needed: float
    relaxed: int


@dataclass(frozen=True)
class RecordingShare:
    """What a recording solves on the table, shares of the work area and of its weakest region.

    Attributes:
        name: of the recording.
        chosen: whether it is kept.
        alone, alone_in_weakest: what it solves.
        without, without_in_weakest: what the others of the chosen solve; None unless it is chosen.
    """

    name: str
    chosen: bool
    alone: float
    alone_in_weakest: float
    without: float | None
    without_in_weakest: float | None


@dataclass(frozen=True)
class RegionRate:
    """A region: how many instances were planned, how many failed, and a bound on the probability.

    `failure_at_most` is that of the verdict; None where it is a region of the table.
    """

    region: int
    name: str
    samples: int
    failures: int
    failure_at_most: float | None


@dataclass(frozen=True)
class SetOnTable:
    """A set of recordings, by what it solves on the table.

    Attributes:
        recordings: their names.
        success: share of the work area.
        success_in_weakest: share of its weakest region, and
        weakest_region: that region's name.
        attempt: number, from 1, of the attempt to certify it or a set with all of it; None where
            there was none.
    """

    recordings: tuple[str, ...]
    success: float
    success_in_weakest: float
    weakest_region: str
    attempt: int | None


@dataclass(frozen=True)
class Attempt:
    """An attempt to certify a set of recordings, on fresh instances."""

    recordings: tuple[str, ...]
    instances: int
    certified: bool
    reason: str


@dataclass(frozen=True)
class PassedOver:
    """A recording that is not used, and why."""

    name: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class Selection:
    """The smallest set of recordings that suffices, as far as there is one.

    Attributes:
        scenario: its name.
        seed: of all random draws.
        source: the folder of recordings.
        status: "certified" or "insufficient".
        reason: why it ended.
        chosen: names of the recordings to keep; those tried last where not certified, none where
            not even all of them together were worth trying.
        folders: where those are.
        smallest: whether it is certain that no smaller set solves enough of the table.
        certificate: what is stated, as in run.json.
        statement: the same in sentences.
        on_table: what the chosen solve of the table; None if there are none.
        fewer: the best set of one recording fewer; None if there is none, or it was not found.
        fewer_ruled_out: whether no set of that size succeeds often enough in every region of the
            table, with confidence 1 - delta.
        runner_up: the next best set of the same size; None likewise.
        table: how it was chosen.
        recordings: what each solves.
        passed_over: recordings of which no motion would be kept.
        regions: of the last attempt to certify.
        short: regions of the table where all recordings together fail more often than 1 - beta.
        attempts: to certify, in their order.
        confidence: 1 - delta.
        seconds: that it took.
    """

    scenario: str
    seed: int
    source: Path
    status: str
    reason: str
    chosen: tuple[str, ...]
    folders: tuple[Path, ...]
    smallest: bool
    certificate: Mapping[str, Any]
    statement: tuple[str, ...]
    on_table: SetOnTable | None
    fewer: SetOnTable | None
    fewer_ruled_out: bool
    runner_up: SetOnTable | None
    table: TableSummary
    recordings: tuple[RecordingShare, ...]
    passed_over: tuple[PassedOver, ...]
    regions: tuple[RegionRate, ...]
    short: tuple[RegionRate, ...]
    attempts: tuple[Attempt, ...]
    confidence: float
    seconds: float

    @property
    def certified(self) -> bool:
        """Whether it ended with a certificate."""
        return self.status == "certified"

    @property
    def margin(self) -> tuple[str, ...]:
        """How much better the chosen are than others, sentence by sentence."""
        if self.on_table is None:
            return ()
        return (self._chosen(), self._fewer(), self._runner_up())

    def snippet(self, budget: int) -> str:
        """The block of a scenario that starts from the chosen, as YAML.

        Args:
            budget: the scenario's, most demonstrations; raised where they are more.
        """
        block: dict[str, Any] = {"initial": [str(folder) for folder in self.folders]}
        if len(self.folders) > budget:
            block["budget"] = len(self.folders)
        return yaml.safe_dump(
            {"demonstrations": block}, sort_keys=False, allow_unicode=True, width=10_000
        )

    def _chosen(self) -> str:
        assert self.on_table is not None
        n, total, table = len(self.chosen), len(self.recordings), self.table
        if not self.certified:
            return f"{n} of {_count(total)} were tried last. {_found(self.on_table)}"
        asked = f"{_percent(table.success_asked)} of {_instances(table)}"
        if table.relaxed:
            asked += (
                f" ({_percent(table.success_needed)} in {table.relaxed} of them, where all "
                "recordings together solve no more)"
            )
        if self.smallest:
            which = f"the fewest that solve {asked}"
            tried = len(self.attempts) - 1
            which += f", sets tried before ({tried}) and parts of them aside" if tried else ""
        else:
            which = f"they solve {asked}; there are too many sets to show that none is smaller"
        return f"{n} of {_count(total)}: {which}. {_found(self.on_table)}"

    def _fewer(self) -> str:
        n = len(self.chosen) - 1
        if n == 0:
            return "There is nothing smaller than a single recording."
        if self.fewer is None:
            return f"The best set of {n} was not found: there are too many sets."
        found = f"The best set of {n} is {_names(self.fewer.recordings)}. {_found(self.fewer)}"
        if self.fewer_ruled_out:
            needed = f"{_percent(self.table.success_needed)} of the time in {_regions(self.table)}"
            held = f"confidence {confidence(self.confidence)}"
            return f"{found} No set of {n} succeeds {needed} ({held})."
        if self.fewer.attempt is not None:
            attempt = f"attempt {self.fewer.attempt}"
            return f"{found} It, or a set with all of it, was not certified in {attempt}."
        if self.fewer.success_in_weakest >= self.table.success_needed:
            return (
                f"{found} That is less than is asked before a set is tried; a smaller "
                "coverage.epsilon asks for less."
            )
        return (
            f"{found} That is too little, but does not rule out that {n} suffice; a larger table "
            "might."
        )

    def _runner_up(self) -> str:
        n, total = len(self.chosen), len(self.recordings)
        if self.runner_up is not None:
            names = _names(self.runner_up.recordings)
            return f"The runner-up of {n} is {names}. {_found(self.runner_up)}"
        if n == total:
            return "There is no other set of as many: these are all of them."
        return f"No runner-up of {n} was found: there are none, or too many sets."


def _found(of: SetOnTable) -> str:
    return (
        f"On the table: {_percent(of.success_in_weakest)} of the weakest region "
        f"({of.weakest_region}), {_percent(of.success)} of the work area."
    )


def _instances(table: TableSummary) -> str:
    return f"{table.instances_per_region:,} instances in {_regions(table)}"


def _regions(table: TableSummary) -> str:
    return f"each of {table.regions} regions" if table.regions > 1 else "the only region"


def _names(names: Sequence[str]) -> str:
    *others, last = names
    return f"{', '.join(others)} and {last}" if others else last


def _count(n: int) -> str:
    return f"{n} recording{'' if n == 1 else 's'}"


def _percent(share: float) -> str:
    return f"{100 * share:.4g} %"
