"""The strategies by name."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from drake_screw.bandits.clopper_pearson import ClopperPearson
from drake_screw.bandits.eprocess import EProcess
from drake_screw.bandits.lucb import Lucb
from drake_screw.bandits.median_elimination import MedianElimination
from drake_screw.bandits.naive_pac import NaivePac
from drake_screw.bandits.successive_elimination import SuccessiveElimination
from drake_screw.bandits.ucb import Ucb
from drake_screw.bandits.verdict import BanditError, Goal, Strategy
from drake_screw.errors import unknown

_CLASSES: dict[str, type] = {
    strategy.name: strategy
    for strategy in (
        EProcess,
        NaivePac,
        ClopperPearson,
        SuccessiveElimination,
        Lucb,
        Ucb,
        MedianElimination,
    )
}

STRATEGIES: tuple[str, ...] = tuple(_CLASSES)
"""Names for `make_strategy`; the first is the default one."""


def make_strategy(name: str, goal: Goal, **options: Any) -> Strategy:
    """The strategy called `name`, for a goal, with options as in the docstring of its class.

    Raises:
        BanditError: no such strategy, or it has no such option.

    A first round with four regions, of which only the third ever fails:

    >>> import numpy as np
    >>> strategy = make_strategy("eprocess", Goal(beta=0.95, epsilon=0.02, delta=0.05))
    >>> verdict = strategy.decide(lambda n: np.where(np.arange(4) == 2, n, 0), 4, attempt=1)
    >>> verdict.certified, verdict.region, verdict.samples.tolist()
    (False, 2, [16, 16, 16, 16])

    And one in which nothing fails:

    >>> verdict = strategy.decide(lambda n: 0 * n, 16, attempt=1)
    >>> verdict.certified, verdict.total_samples
    (True, 1440)
    """
    if name not in _CLASSES:
        message, remedy = unknown("bandit", name, "drake_screw", STRATEGIES)
        raise BanditError(message, remedy=remedy)
    strategy = _CLASSES[name]
    valid = [field.name for field in fields(strategy) if field.name != "goal"]
    for option in options:
        if option not in valid:
            message, remedy = unknown("option", option, f"bandit '{name}'", valid)
            raise BanditError(message, remedy=remedy)
    return strategy(goal, **options)
