"""The single runs of a study, and the grids they are made on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from drake_screw.acquisition import (
    Evaluator,
    Event,
    Finished,
    RecordedTeacher,
    RoundFinished,
    Teacher,
    UsableLessons,
    acquire,
)
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Demonstration, Recording
from drake_screw.errors import ScenarioError
from drake_screw.scenario.schema import MOST_REGIONS, Scenario
from drake_screw.tasks import ANGLES, GridRegions, WorkArea, grid_regions

MOST_RUNS = 10_000_000
"""Of a study, for all numbers of regions together."""


def numbers_of_regions(text: str) -> tuple[int, ...]:
    """Reads ``1,2,4,8,16``.

    Raises:
        ScenarioError: it is not such a list, or a number is not from 1 to MOST_REGIONS.
    """
    try:
        numbers = tuple(int(part) for part in text.split(","))
    except ValueError as error:
        raise ScenarioError(
            f"'{text}' is not a list of numbers of regions", remedy="Write, say, 1,2,4,8,16."
        ) from error
    for K in numbers:
        if not 1 <= K <= MOST_REGIONS:
            raise ScenarioError(
                f"{K:,} regions; a grid has 1 to {MOST_REGIONS:,}",
                remedy="Write smaller numbers; every round draws in each region.",
            )
    return numbers


def check_runs(runs: int, regions: Sequence[int]) -> None:
    """Refuse a study that would not end in a lifetime.

    Raises:
        ScenarioError: there are no runs, or too many.
    """
    total = runs * len(regions)
    if total < 1:
        raise ScenarioError(
            f"{runs} runs for {len(regions)} numbers of regions",
            remedy="Give at least one run, and one number of regions.",
        )
    if total > MOST_RUNS:
        raise ScenarioError(
            f"{total:,} runs, of which a study has {MOST_RUNS:,} at most",
            remedy=f"At a second each they would take {total / 31_557_600:,.1f} years of one "
            "processor; a thousand for each number of regions tell a mean to a few per cent.",
        )


def split(area: WorkArea, K: int) -> GridRegions:
    """A grid of K equal regions, as square as it goes: 1 x 1, 1 x 2, 2 x 2, 2 x 4, 4 x 4, ...

    The prime factors of K, the largest first, go in turn to the axes that can be split: those in
    metres before the angles, the longest first.

    Raises:
        ScenarioError: K is not positive, or no axis can be split.
    """
    extent = area.flat(area.upper) - area.flat(area.lower)
    axes = sorted(
        zip(*np.nonzero(extent > 0.0), strict=True),
        key=lambda axis: (area.axes[axis[1]] in ANGLES, -extent[axis]),
    )
    if K < 1 or (K > 1 and not axes):
        raise ScenarioError(
            f"the work area cannot be split into {K} regions",
            remedy="Give positive numbers of regions, and objects that may move.",
        )
    counts = np.ones_like(extent, dtype=np.int64)
    for i, factor in enumerate(_prime_factors(K)):
        counts[axes[i % len(axes)]] *= factor
    named = {
        f"{item.name}.{axis}": int(counts[i, j])
        for i, item in enumerate(area.objects)
        for j, axis in enumerate(area.axes)
    }
    return grid_regions(area, named)


def _prime_factors(number: int) -> list[int]:
    factors, candidate = [], 2
    while number > 1:
        while number % candidate == 0:
            factors.append(candidate)
            number //= candidate
        candidate += 1
    return factors[::-1]


def run_seed(seed: int, K: int, run: int) -> int:
    """Seed of one run of a study; an ordinary run with this seed and grid is the same run."""
    sequence = np.random.SeedSequence(seed, spawn_key=(K, run))
    return int(sequence.generate_state(1, np.uint64)[0])


@dataclass(frozen=True)
class StudyRun:
    """What is kept of one run.

    Attributes:
        K: number of regions.
        run: from 0.
        seed: of the run, see `run_seed`.
        status: how it ended, "certified" or "insufficient".
        demonstrations: how many were in hand then.
        rounds: of self-evaluation.
        samples: instances drawn in all rounds together.
        names: of the demonstrations, in the order in which they were given.
    """

    K: int
    run: int
    seed: int
    status: str
    demonstrations: int
    rounds: int
    samples: int
    names: tuple[str, ...]

    @property
    def certified(self) -> bool:
        """Whether it ended with a certificate."""
        return self.status == "certified"


class Experiment:
    """Carries out runs of one scenario with any number of regions, on one thread.

    Args:
        scenario: all but its regions is used; its seed is the study's.

    Raises:
        ScenarioError: it wants plans to be executed.
    """

    def __init__(self, scenario: Scenario) -> None:
        if scenario.coverage.success == "execution":
            raise ScenarioError(
                "coverage.success: the runs of a study plan and do not execute",
                remedy="Write coverage.success: plan, or carry out a single run: drake-screw run",
                file=scenario.source,
            )
        self.setup = Setup(scenario)
        for one in self.setup.arms:
            one.batch_planner.threads = 1
        self._learned: dict[Path, Demonstration] = {}

    def run(self, K: int, run: int) -> StudyRun:
        """Carry a run out and keep its counts."""
        rounds, samples = 0, 0
        for event in self.events(K, run):
            if isinstance(event, RoundFinished):
                rounds += 1
                samples += event.verdict.total_samples
        assert isinstance(event, Finished)
        names = tuple(d.name for d in event.demonstrations)
        seed = run_seed(self.setup.scenario.seed, K, run)
        return StudyRun(K, run, seed, event.status.value, len(names), rounds, samples, names)

    def events(self, K: int, run: int) -> Iterator[Event]:
        """All events of a run."""
        setup = self.setup
        seed = run_seed(setup.scenario.seed, K, run)
        regions = split(setup.area, K)
        evaluator = Evaluator(setup.planner, regions, setup.start, setup.strategy, seed)
        return acquire(
            evaluator.evaluate,
            UsableLessons(self._teacher(regions), self._learn),
            self._learn,
            regions,
            initial=setup.initial,
            budget=setup.scenario.demonstrations.budget,
            seed=seed,
            ask=setup.ask,
            first=setup.first,
        )

    def _teacher(self, regions: GridRegions) -> Teacher:
        teacher = self.setup.teacher
        if isinstance(teacher, RecordedTeacher):
            return replace(teacher, regions=regions)
        return teacher

    def _learn(self, recording: Recording) -> Demonstration:
        if recording.source is None:
            return self.setup.learn(recording)
        if recording.source not in self._learned:
            self._learned[recording.source] = self.setup.learn(recording)
        return self._learned[recording.source]
