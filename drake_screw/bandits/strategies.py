"""The strategies by name."""

from __future__ import annotations

import inspect
from typing import Any

from drake_screw.bandits.verdict import BanditError, Goal, Strategy
from drake_screw.errors import PluginError, unknown
from drake_screw.plugins import BUILT_IN, find

STRATEGIES: tuple[str, ...] = tuple(BUILT_IN["strategies"])
"""Names of the built-in strategies for `make_strategy`; the first is the default one."""


def make_strategy(name: str, goal: Goal, **options: Any) -> Strategy:
    """The strategy called `name`, for a goal, with options as in the docstring of its class.

    Args:
        name: of a built-in or installed strategy, or ``package.module:Class``.
        goal: what to certify.
        options: further arguments of the class.

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
    try:
        strategy = find("strategies", name)
    except PluginError as error:
        raise BanditError(error.message, remedy=error.remedy) from error
    signature = inspect.signature(strategy)
    valid = [option for option in signature.parameters if option != "goal"]
    takes_any = any(p.kind is p.VAR_KEYWORD for p in signature.parameters.values())
    for option in options:
        if option not in valid and not takes_any:
            message, remedy = unknown("option", option, f"bandit '{name}'", valid)
            raise BanditError(message, remedy=remedy)
    made: Strategy = strategy(goal, **options)
    return made
