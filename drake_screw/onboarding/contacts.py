"""Links that touch wherever the arm is: a matter of how their shapes were drawn."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from drake_screw.errors import ModelError
from drake_screw.robot import RobotConfig, Workcell
from drake_screw.robot.proposed import proposed_pairs

Pair = tuple[str, str]

CONFIGURATIONS = 200
"""That are looked at."""

MOSTLY = 0.5
"""Share of them in which a pair touches that touches at rest, too, and may from then on."""

CAN_BE_IGNORED = "ignore_collisions" in {field.name for field in fields(RobotConfig)}
"""Whether a robot's configuration can say which pairs may touch."""


def always_touching(workcell: Workcell) -> tuple[Pair, ...]:
    """Pairs of links that touch in all configurations of the arm, or at rest and mostly.

    Args:
        workcell: of the robot alone, its start the arm at rest.
    """
    found = proposed_pairs(workcell, np.random.default_rng(0), CONFIGURATIONS)
    return tuple((pair.a, pair.b) for pair in found if pair.share >= MOSTLY)


def letting_touch(config: RobotConfig, pairs: tuple[Pair, ...]) -> RobotConfig:
    """A robot whose links may touch one another in pairs.

    Raises:
        ModelError: there are such pairs, and a configuration cannot say so.
    """
    if not pairs:
        return config
    if not CAN_BE_IGNORED:
        both = " and ".join(f"'{a}' and '{b}'" for a, b in pairs[:4])
        more = f" and {len(pairs) - 4} more pairs" if len(pairs) > 4 else ""
        raise ModelError(
            f"links touch wherever the arm is: {both}{more}, so that no plan can succeed",
            remedy="Mend the collision shapes of the model.",
            file=config.model,
        )
    return replace(config, ignore_collisions=pairs)
