"""Links that touch wherever the arm is: a matter of how their shapes were drawn."""

from __future__ import annotations

import numpy as np

from drake_screw.robot import Workcell
from drake_screw.robot.proposed import proposed_pairs

Pair = tuple[str, str]

CONFIGURATIONS = 200
"""That are looked at."""

MOSTLY = 0.5
"""Share of them in which a pair touches that touches at rest, too, and may from then on."""


def always_touching(workcell: Workcell) -> tuple[Pair, ...]:
    """Pairs of links that touch in all configurations of the arm, or at rest and mostly.

    Args:
        workcell: of the robot alone, its start the arm at rest.
    """
    found = proposed_pairs(workcell, np.random.default_rng(0), CONFIGURATIONS)
    return tuple((pair.a, pair.b) for pair in found if pair.share >= MOSTLY)
