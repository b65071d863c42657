"""What is drawn of a round. The events of an acquisition run have this shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from drake_screw.bandits import Verdict
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import counted
from drake_screw.planning import Cause, Outcomes
from drake_screw.tasks import Regions
from drake_screw.typing import Array


class Instances(Protocol):
    """Task instances and their outcomes."""

    @property
    def coordinates(self) -> Array:
        """(N, k, c) m and rad."""

    @property
    def outcomes(self) -> Outcomes:
        """(N, D), one column for each demonstration in hand."""


class Place(Protocol):
    """Where a demonstration is wanted."""

    @property
    def region(self) -> int:
        """The region it is wanted for."""

    @property
    def coordinates(self) -> Array:
        """(k, c) m and rad."""


class Round(Protocol):
    """A finished round; `acquisition.RoundFinished` is one."""

    @property
    def round(self) -> int:
        """Counted from 0; people see it counted from 1."""

    @property
    def demonstrations(self) -> Sequence[Demonstration]:
        """Those in hand, in the order in which they were given."""

    @property
    def evaluation(self) -> Instances:
        """The round's instances."""

    @property
    def verdict(self) -> Verdict:
        """What the strategy concluded."""

    @property
    def suggestion(self) -> Place | None:
        """Where the next demonstration is wanted, if it is."""


@dataclass(frozen=True, eq=False)
class Sample:
    """Some of a round's instances, few enough to draw.

    Attributes:
        coordinates: (n, k, c) m and rad.
        cause: (n,) `Cause` values, of the best attempts.
        total: how many instances the round had.
    """

    coordinates: Array
    cause: NDArray[np.uint8]
    total: int

    @property
    def statement(self) -> str:
        """How much of the round is shown, in words."""
        if len(self.cause) == self.total:
            return f"all {counted(self.total, 'instance')}"
        return f"{len(self.cause):,} of {counted(self.total, 'instance')}, drawn at random"

    def count(self, cause: Cause) -> int:
        """How many of the shown instances ended so."""
        return int(np.count_nonzero(self.cause == cause))


def sample(evaluation: Instances, most: int) -> Sample:
    """A uniform random subset of at most `most` instances, the same at every call."""
    total = len(evaluation.coordinates)
    chosen = np.arange(total)
    if total > most:
        chosen = np.sort(np.random.default_rng(0).choice(total, most, replace=False))
    return Sample(evaluation.coordinates[chosen], evaluation.outcomes[chosen].best.cause, total)


def headline(event: Round) -> str:
    """A round and how it ended, in few words."""
    count = len(event.demonstrations)
    verdict = "certified" if event.verdict.certified else "not certified"
    return f"round {event.round + 1}, {count} demonstration{'' if count == 1 else 's'}: {verdict}"


def details(event: Round, regions: Regions) -> str:
    """The weakest region of a round and the strategy's reason."""
    region = event.verdict.weakest
    if region is None:
        return f"no instance fails; {event.verdict.reason}"
    return f"weakest region: {regions.name(region)}; {event.verdict.reason}"


def bounds_over(verdict: Verdict, beta: float) -> str:
    """Why a certified round has upper bounds over 1 - beta; "" where it has none."""
    over = int(np.count_nonzero(verdict.upper > 1.0 - beta + 1e-12))
    if not verdict.certified or not over:
        return ""
    K = len(verdict.upper)
    of = f"{over} of {K} regions" if K > 1 else "this region"
    return (
        f"The upper bound of {of} is over 1 - beta = {1.0 - beta:.6g} although the round is "
        "certified: the bounds are two-sided and hold for all regions at once, and are wider for "
        "it than the strategy's own test, on which the certificate rests."
    )


def mean_failure(verdict: Verdict, regions: Regions | None) -> float:
    """Estimate of the failure probability in all regions that have samples; NaN where none has.

    Each counts by its share of the work area, or all alike if there are no `regions`.
    """
    known = verdict.samples > 0
    if not known.any():
        return np.nan
    weights = None if regions is None else regions.shares[known]
    return float(np.average(verdict.estimates[known], weights=weights))
