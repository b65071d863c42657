"""Sample the region with the largest UCB1 index."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from drake_screw.bandits.bound_strategy import BoundStrategy
from drake_screw.bandits.tally import Tally
from drake_screw.typing import Array


@dataclass(frozen=True)
class Ucb(BoundStrategy):
    """UCB1 for sampling, the bounds of `BoundStrategy` for stopping.

    Auer, Cesa-Bianchi, Fischer, "Finite-time analysis of the multiarmed bandit problem" (Machine
    Learning 2002). Its index is made for small regret, not for a quick verdict, so it returns to
    regions that look weak for longer than the verdict needs.
    """

    name: ClassVar[str] = "ucb"
    guarantee: ClassVar[str] = (
        "With probability 1 - delta in the whole run (in each round if delta is not spent) a "
        "certificate is true and a region asked for is epsilon-worst, however often one looks."
    )

    def choose(self, tally: Tally, lower: Array, upper: Array) -> Array:
        """The region with the largest estimate + sqrt(2 ln(total samples) / its samples)."""
        bonus = np.sqrt(2.0 * np.log(tally.n.sum()) / tally.n)
        return np.array([np.argmax(tally.estimates + bonus)])
