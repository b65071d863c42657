"""Finished runs side by side, in plain values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from drake_screw.acquisition import RoundFinished
from drake_screw.demonstrations import Recording
from drake_screw.errors import RunDirectoryError
from drake_screw.runs.common_regions import RegionTable, alike, region_table, same_area, same_boxes
from drake_screw.runs.comparison_notes import notes
from drake_screw.runs.run import Run, open_run
from drake_screw.runs.shared_instances import SharedInstances, shared_instances
from drake_screw.runs.summary import RunSummary, summarize_run
from drake_screw.scenario.differences import Difference, differences, scenario_differences
from drake_screw.steps import Step, Tell, to_nobody
from drake_screw.tasks import Regions
from drake_screw.typing import PathLike
from drake_screw.visualization.palette import OUTCOME_NAMES
from drake_screw.visualization.rounds import mean_failure

MOST_RUNS = 12
_SENTENCES = ("claim", "reason", "guarantee")


@dataclass(frozen=True)
class ComparedDemonstration:
    """A demonstration of a run.

    Attributes:
        name: of its recording.
        kept: how faithfully it is kept, a sentence for each object.
        also_in: the other runs, by their numbers, that have the very same recording.
    """

    name: str
    kept: tuple[str, ...]
    also_in: tuple[int, ...]


@dataclass(frozen=True)
class ComparedRun:
    """A run, and what its last round found; None or empty where it ended before its first round.

    Attributes:
        summary: what it came to.
        demonstrations: in the order of use.
        instances: drawn in the last round.
        outcomes: how many of these ended how, each by its best attempt.
        regions: how many there were.
        success: estimated share of the work area in which instances succeed: the mean of the
            regions with samples, each by its share of it.
        weakest_region: in words.
        success_in_weakest: its estimate.
        confidence_of_bounds: on the failure probability of regions.
        bounds_hold_at_once: in all regions, else in each by itself.
    """

    summary: RunSummary
    demonstrations: tuple[ComparedDemonstration, ...]
    instances: int
    outcomes: Mapping[str, int]
    regions: int | None = None
    success: float | None = None
    weakest_region: str | None = None
    success_in_weakest: float | None = None
    confidence_of_bounds: float | None = None
    bounds_hold_at_once: bool | None = None


@dataclass(frozen=True)
class Comparison:
    """Runs side by side; they are numbered from 1, in the order in which they were given.

    Attributes:
        runs: at least two.
        scenario: the keys in which their scenarios differ.
        made_with: the versions, models and parts in which they differ.
        certificates: the entries in which these differ.
        regions: a table for all runs that have the same regions, and in order of the first.
        shared: of runs with the same work area the first and each other one, on what both drew.
        notes: what cannot be compared, or only with care, and why.
    """

    runs: tuple[ComparedRun, ...]
    scenario: tuple[Difference, ...]
    made_with: tuple[Difference, ...]
    certificates: tuple[Difference, ...]
    regions: tuple[RegionTable, ...]
    shared: tuple[SharedInstances, ...]
    notes: tuple[str, ...]


def open_runs(directories: Sequence[PathLike], tell: Tell = to_nobody) -> list[Run]:
    """Open finished runs to compare them; `tell` is told how far it is.

    Raises:
        RunDirectoryError: one is not a run, cannot be read, has not finished, or is given twice;
            or there are fewer than two or more than `MOST_RUNS`.
    """
    if len(directories) < 2:
        raise RunDirectoryError(
            f"there is nothing to compare {directories[0] if directories else 'it'} with",
            remedy="Give two run directories or more: drake-screw compare RUN RUN.",
        )
    if len(directories) > MOST_RUNS:
        raise RunDirectoryError(
            f"{len(directories):,} runs are too many to be seen side by side",
            remedy=f"Give at most {MOST_RUNS}; drake-screw study has a table of many runs.",
        )
    for one, other in combinations(map(Path, directories), 2):
        if one.resolve() == other.resolve():
            raise RunDirectoryError(
                "this run is given twice", remedy="Name each run once.", file=other
            )
    runs: list[Run] = []
    for path in directories:
        tell(Step("reading runs", len(runs), len(directories)))
        runs.append(open_run(path))
        summarize_run(runs[-1])
    return runs


def compare_runs(runs: Sequence[Run]) -> Comparison:
    """Put finished runs side by side.

    Raises:
        RunDirectoryError: one has not finished, or is damaged.
    """
    rounds = last_rounds(runs)
    scenario = scenario_differences([run.setup.scenario for run in runs])
    same_objects = not any(d.key.startswith("objects") for d in scenario)

    def areas(one: Regions, other: Regions) -> bool:
        return same_area(one.area, other.area, same_objects=same_objects)

    def regions(one: Regions, other: Regions) -> bool:
        return areas(one, other) and same_boxes(one, other)

    tables = tuple(
        region_table(group, rounds) for group in alike(rounds, regions) if len(group) > 1
    )
    by_area = alike(rounds, areas)
    shared = tuple(
        shared_instances(group[0], rounds[group[0]].evaluation, other, rounds[other].evaluation)
        for group in by_area
        for other in group[1:]
    )
    compared = tuple(_compared(runs, i, rounds.get(i + 1)) for i in range(len(runs)))
    certificates = differences([run.summary.certificate for run in compared])
    return Comparison(
        runs=compared,
        scenario=scenario,
        made_with=_made_with(runs),
        certificates=certificates,
        regions=tables,
        shared=shared,
        notes=notes(range(1, len(runs) + 1), rounds, by_area, tables, shared, certificates),
    )


def without_sentences(certificates: Sequence[Difference]) -> tuple[Difference, ...]:
    """Entries of certificates without those that their statements say in sentences."""
    return tuple(d for d in certificates if d.key not in _SENTENCES)


def last_rounds(runs: Sequence[Run]) -> dict[int, RoundFinished]:
    """The last rounds of runs, by their numbers from 1, without those that have none."""
    readers = {number: run.reader for number, run in enumerate(runs, start=1)}
    return {i: reader.event(reader.rounds - 1) for i, reader in readers.items() if reader.rounds}


def _compared(runs: Sequence[Run], number: int, event: RoundFinished | None) -> ComparedRun:
    summary = summarize_run(runs[number])
    lessons = _demonstrations(runs, number)
    if event is None:
        return ComparedRun(summary, lessons, 0, {})
    verdict, cause = event.verdict, event.evaluation.outcomes.best.cause
    counts = {name: int(np.count_nonzero(cause == c)) for c, name in OUTCOME_NAMES.items()}
    return ComparedRun(
        summary=summary,
        demonstrations=lessons,
        instances=len(cause),
        outcomes={name: count for name, count in counts.items() if count},
        regions=event.regions.K,
        success=1.0 - mean_failure(event.verdict, event.regions),
        weakest_region=event.regions.name(verdict.region),
        success_in_weakest=1.0 - float(verdict.estimates[verdict.region]),
        confidence_of_bounds=verdict.level,
        bounds_hold_at_once=verdict.simultaneous,
    )


def _demonstrations(runs: Sequence[Run], number: int) -> tuple[ComparedDemonstration, ...]:
    reader = runs[number].reader
    others = [
        (i + 1, [run.reader.recording(j) for j in range(len(run.directory.record.demonstrations))])
        for i, run in enumerate(runs)
        if i != number
    ]
    return tuple(
        ComparedDemonstration(
            name=entry.name,
            kept=tuple(map(str, entry.fidelity)),
            also_in=tuple(
                i
                for i, known in others
                if any(same_recording(reader.recording(d), each) for each in known)
            ),
        )
        for d, entry in enumerate(reader.directory.record.demonstrations)
    )


def same_recording(one: Recording, other: Recording) -> bool:
    """Whether recordings have the same motion beside the same objects, whatever their names."""
    if one.joint_names != other.joint_names or (one.X_WE is None) != (other.X_WE is None):
        return False
    paths = () if one.X_WE is None else ((one.X_WE, other.X_WE),)
    pairs = ((one.t, other.t), (one.q, other.q), (one.X_WO, other.X_WO), *paths)
    return all(np.array_equal(a, b) for a, b in pairs)


def _made_with(runs: Sequence[Run]) -> tuple[Difference, ...]:
    """What may make runs of one scenario differ, and is not in the scenario."""
    records = [run.directory.record for run in runs]
    return differences(
        [
            {
                "versions": record.versions,
                "led_around": record.led_around,
                "passed_in": list(record.passed_in),
                "hashes": record.hashes,
            }
            for record in records
        ]
    )
