"""What a study found, in plain values."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from drake_screw.studies.study import Study


@dataclass(frozen=True)
class Finding:
    """How many demonstrations the runs with K regions needed.

    Attributes:
        K: number of regions.
        runs: finished ones.
        certified: how many of them were.
        mean, most: demonstrations of those; NaN and 0 where there are none.
        counts: certified runs by their number of demonstrations.
    """

    K: int
    runs: int
    certified: int
    mean: float
    most: int
    counts: dict[int, int]


@dataclass(frozen=True)
class Findings:
    """What a study found.

    Attributes:
        directory: of the study.
        scenario: its name.
        seed: of the study.
        strategy: the bandit.
        regions: what was found with each K, rising.
    """

    directory: Path
    scenario: str
    seed: int
    strategy: str
    regions: tuple[Finding, ...]


def findings(study: Study) -> Findings:
    """What the finished runs of a study show."""
    return Findings(
        directory=study.path,
        scenario=study.scenario.name,
        seed=study.scenario.seed,
        strategy=study.scenario.coverage.strategy,
        regions=tuple(
            Finding(K, found.runs, len(found.numbers), found.mean, found.most, found.counts)
            for K, found in study.summary().items()
        ),
    )
