"""Runs that have the same regions, side by side in each of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from drake_screw.acquisition import RoundFinished
from drake_screw.tasks import Regions, WorkArea


@dataclass(frozen=True)
class RegionRow:
    """One region in the last rounds of several runs; of each run a number.

    Attributes:
        region: from 0.
        name: its ranges.
        samples: instances drawn.
        failures: among them.
        failure_rate: None without samples.
        at_least, at_most: confidence bounds on the failure probability, each run's own.
        apart: whether the bounds of some two runs do not overlap.
    """

    region: int
    name: str
    samples: tuple[int, ...]
    failures: tuple[int, ...]
    failure_rate: tuple[float | None, ...]
    at_least: tuple[float, ...]
    at_most: tuple[float, ...]
    apart: bool


@dataclass(frozen=True)
class RegionTable:
    """Runs with the same regions.

    Attributes:
        runs: their numbers, from 1.
        regions: a row for each.
    """

    runs: tuple[int, ...]
    regions: tuple[RegionRow, ...]

    def telling(self, most: int) -> tuple[RegionRow, ...]:
        """All rows; where there are more than `most`, first those that differ, then the worst."""
        if len(self.regions) <= most:
            return self.regions
        return tuple(sorted(self.regions, key=_telling, reverse=True)[:most])


def _telling(row: RegionRow) -> tuple[bool, float]:
    rates = (rate for rate in row.failure_rate if rate is not None)
    return row.apart, max(rates, default=-1.0)


def same_area(one: WorkArea, other: WorkArea, *, same_objects: bool) -> bool:
    """Whether instances of two work areas are drawn from the same distribution.

    Args:
        one, other: the work areas.
        same_objects: whether nothing else that is said of the objects differs, either: where they
            must not overlap, their shapes matter.
    """
    if (one.overlap is None) != (other.overlap is None):
        return False
    return one.objects == other.objects and (one.overlap is None or same_objects)


def same_boxes(one: Regions, other: Regions) -> bool:
    """Whether partitions of the same work area have the same regions in the same order."""
    if one.K != other.K:
        return False
    everyone = np.arange(one.K)
    return np.array_equal(np.stack(one.bounds(everyone)), np.stack(other.bounds(everyone)))


def alike(
    rounds: Mapping[int, RoundFinished], same: Callable[[Regions, Regions], bool]
) -> list[tuple[int, ...]]:
    """Numbers of runs whose rounds have the same regions, in some sense, together; in order."""
    groups: list[list[int]] = []
    for number, event in rounds.items():
        for group in groups:
            if same(rounds[group[0]].regions, event.regions):
                group.append(number)
                break
        else:
            groups.append([number])
    return [tuple(group) for group in groups]


def region_table(numbers: Sequence[int], rounds: Mapping[int, RoundFinished]) -> RegionTable:
    """A table of runs, by their numbers, that have the same regions in their last rounds."""
    regions = rounds[numbers[0]].regions
    verdicts = [rounds[number].verdict for number in numbers]
    lower = np.stack([v.lower for v in verdicts])
    upper = np.stack([v.upper for v in verdicts])
    apart = lower.max(axis=0) > upper.min(axis=0)
    rows = tuple(
        RegionRow(
            region=j,
            name=regions.name(j),
            samples=tuple(int(v.samples[j]) for v in verdicts),
            failures=tuple(int(v.failures[j]) for v in verdicts),
            failure_rate=tuple(float(v.estimates[j]) if v.samples[j] else None for v in verdicts),
            at_least=tuple(lower[:, j].tolist()),
            at_most=tuple(upper[:, j].tolist()),
            apart=bool(apart[j]),
        )
        for j in range(regions.K)
    )
    return RegionTable(tuple(numbers), rows)
