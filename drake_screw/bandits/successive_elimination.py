"""Sample every region that may still be the weakest, equally often."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from drake_screw.bandits.bound_strategy import BoundStrategy
from drake_screw.bandits.tally import Tally
from drake_screw.typing import Array


@dataclass(frozen=True)
class SuccessiveElimination(BoundStrategy):
    """Even-Dar, Mannor and Mansour (COLT 2002), Section 3.2, on the bounds of `BoundStrategy`.

    A region whose upper bound is below another's lower bound is sampled no more, nor is one whose
    upper bound is at most 1 - beta: neither can change the verdict.
    """

    name: ClassVar[str] = "successive_elimination"
    guarantee: ClassVar[str] = (
        "With probability 1 - delta in the whole run (in each round if delta is not spent) a "
        "certificate is true and a region asked for is epsilon-worst, however often one looks."
    )

    def choose(self, tally: Tally, lower: Array, upper: Array) -> Array:
        """(K,) mask of the regions that may be the weakest and may fail over 1 - beta."""
        return (upper >= lower.max()) & (upper > self.goal.tau)
