"""Links that touch wherever the arm is: a matter of how their shapes were drawn."""

from __future__ import annotations

from collections import Counter
from dataclasses import fields, replace

import numpy as np

from drake_screw.errors import ModelError
from drake_screw.onboarding.hand_ik import Range, spread
from drake_screw.robot import RobotConfig, Workcell
from drake_screw.screws import pose
from drake_screw.typing import Array

Pair = tuple[str, str]

CONFIGURATIONS = 48
"""That are looked at."""

ALWAYS = 0.95
"""Share of them from which on a pair touches always."""

MOSTLY = 0.5
"""Share that is enough of a pair that touches in the middle of all ranges, too."""

CAN_BE_IGNORED = "ignore_collisions" in {field.name for field in fields(RobotConfig)}
"""Whether a robot's configuration can say which pairs may touch."""


def always_touching(workcell: Workcell, within: Range) -> tuple[Pair, ...]:
    """Pairs of the robot's links that touch in nearly all configurations of the arm.

    Args:
        workcell: of the robot alone.
        within: where the arm's configurations are.
    """
    away = np.arange(1.0, len(workcell.objects) + 1)[:, None] * [0.0, 0.0, 1e3]
    X_WO = pose(np.eye(3), away)

    def touching(q: Array) -> set[Pair]:
        return {(min(a, b), max(a, b)) for a, b in workcell.colliding_bodies(q, X_WO)}

    at_rest = touching(within.middle)
    found = Counter(pair for q in spread(within, CONFIGURATIONS) for pair in touching(q))
    return tuple(
        sorted(
            pair
            for pair, n in found.items()
            if n >= (MOSTLY if pair in at_rest else ALWAYS) * CONFIGURATIONS
        )
    )


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
    return replace(config, ignore_collisions=pairs)  # type: ignore[call-arg]
