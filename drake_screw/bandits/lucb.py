"""Sample the region that looks weakest, and its strongest rival."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from drake_screw.bandits.bound_strategy import BoundStrategy
from drake_screw.bandits.tally import Tally
from drake_screw.typing import Array


@dataclass(frozen=True)
class Lucb(BoundStrategy):
    """LUCB on the bounds of `BoundStrategy`.

    Kalyanakrishnan, Tewari, Auer, Stone, "PAC subset selection in stochastic multi-armed bandits"
    (ICML 2012); with likelihood-based bounds as here, close to KL-LUCB of Kaufmann and
    Kalyanakrishnan, "Information complexity in bandit subset selection" (COLT 2013).
    """

    name: ClassVar[str] = "lucb"
    guarantee: ClassVar[str] = (
        "With probability 1 - delta in the whole run (in each round if delta is not spent) a "
        "certificate is true and a region asked for is epsilon-worst, however often one looks."
    )

    def choose(self, tally: Tally, lower: Array, upper: Array) -> Array:
        """The region with the largest estimate, and of the others that with the largest bound."""
        region = int(np.argmax(tally.estimates))
        others = upper.copy()
        others[region] = -1.0
        return np.unique([region, int(np.argmax(others))])
