"""What a round of self-evaluation is to certify, and what it concludes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from drake_screw.errors import DrakeScrewError
from drake_screw.typing import Array

Pull = Callable[[Array], Array]
"""Draws counts (K,) int fresh, independent samples; answers the failures among them, (K,) int."""


LEAST = 1e-12
"""Of a probability: below, 1 - p may be 1 and 1 / p infinite, and machines err more often."""


class BanditError(DrakeScrewError):
    """A goal, a strategy or an option of one, or an answer to a pull that cannot be used."""


@dataclass(frozen=True)
class Goal:
    """The statement to certify: every region fails at most 1 - beta of the time.

    Args:
        beta: coverage wanted in every region, in [`LEAST`, 1).
        epsilon: indifference, in (0, 1 - beta). Regions that fail between q and tau of the time
            may be judged either way.
        delta: the chance of error allowed, in [`LEAST`, 1).

    Raises:
        BanditError: a value outside its range.
    """

    beta: float
    epsilon: float
    delta: float

    def __post_init__(self) -> None:
        for name in ("beta", "delta"):
            value = getattr(self, name)
            if not LEAST <= value < 1.0:
                raise BanditError(
                    f"{name} is {value}",
                    remedy=f"Give {name} a value of at least {LEAST:g} and below 1.",
                )
        if not (self.epsilon > 0.0 and self.q > LEAST):
            raise BanditError(
                f"epsilon is {self.epsilon} with beta {self.beta}: no round could ever certify",
                remedy=f"Give epsilon a value strictly between 0 and 1 - beta = {self.tau:.6g}.",
            )

    @property
    def tau(self) -> float:
        """The failure probability that no region may exceed: 1 - beta."""
        return 1.0 - self.beta

    @property
    def q(self) -> float:
        """A region that fails more often than this may be asked about: 1 - beta - epsilon."""
        return self.tau - self.epsilon


@dataclass(frozen=True, eq=False)
class Verdict:
    """What a strategy concludes in one round about K regions.

    Args:
        certified: every region is shown to fail at most 1 - beta of the time.
        region: the weakest region, also when certified.
        reason: why the round ended, human-readable.
        claim: what the verdict states, with its confidence, human-readable.
        samples: (K,) int, samples drawn in each region.
        failures: (K,) int, failures among them.
        lower: (K,) confidence bounds from below on the failure probability mu_j.
        upper: (K,) the same from above.
        level: confidence of the bounds.
        simultaneous: the level holds for all 2 K bounds at once, else for each region by itself.
        gap: bound, at the same confidence, on max_j mu_j - mu_region; None where none is claimed.
        coverage: beta', the success probability shown for every region at confidence 1 - delta (of
            this attempt, where the strategy spends delta over attempts); at least 0.
        attempted: a look was reached at which some region could have passed. The number of such
            rounds, plus one, is the `attempt` of the next.
        looks: how often the counts were looked at.
    """

    certified: bool
    region: int
    reason: str
    claim: str
    samples: Array
    failures: Array
    lower: Array
    upper: Array
    level: float
    simultaneous: bool
    gap: float | None
    coverage: float
    attempted: bool
    looks: int

    @property
    def estimates(self) -> Array:
        """(K,) share of failures; NaN where a region has no samples."""
        return np.divide(
            self.failures,
            self.samples,
            out=np.full(len(self.samples), np.nan),
            where=self.samples > 0,
        )

    @property
    def weakest(self) -> int | None:
        """The weakest region; None where no sample fails, as none is weaker then."""
        return self.region if self.failures.any() else None

    @property
    def total_samples(self) -> int:
        """Samples drawn in all regions together."""
        return int(self.samples.sum())


@runtime_checkable
class OfFixedSize(Protocol):
    """A strategy of which one knows beforehand how many samples a round takes."""

    def total(self, K: int, *, attempt: int) -> int:
        """Of all K regions together; takes what `Strategy.decide` does."""
        ...


class Strategy(Protocol):
    """One way to reach a verdict.

    Attributes:
        name: as in `make_strategy`.
        guarantee: what can be relied on, in one sentence.
    """

    name: ClassVar[str]
    guarantee: ClassVar[str]

    def decide(self, pull: Pull, K: int, *, attempt: int) -> Verdict:
        """Runs one round on K regions.

        Args:
            pull: draws fresh samples.
            K: number of regions, at least 1.
            attempt: 1 + the number of earlier rounds of this run whose verdict was `attempted`.
        """
        ...
