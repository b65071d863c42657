"""Plans whose free approach is led around what is in its way.

Of a free approach nothing is asked but to come to the first guiding pose. Where the straight joint
motion touches something and the rest of the plan does not, any other motion to the same
configuration will do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.connection import connect
from drake_screw.planning.outcomes import Plan
from drake_screw.planning.plan_checker import PlanChecker
from drake_screw.typing import Array

TRIED = 4
"""Variants of a demonstration, at one instance, to which a way around is sought at most."""

APART = 0.1
"""rad (or m), Euclidean, by which the configurations they come to differ at least."""


def led_around(checker: PlanChecker, plan: Plan, X_WO: Array) -> Plan | None:
    """A successful plan with a way around in place of its first segment; None if there is none.

    The same plan has the same way around, whatever was planned before.

    Args:
        checker: by which the whole plan touches nothing then.
        plan: touches something in its first segment.
        X_WO: (k, 4, 4) the objects.
    """
    rest = ahead(plan)
    if not checker.free(rest.q, X_WO):
        return None
    q = connect(checker, plan.q[0], rest.q[0], X_WO)
    if q is None:
        return None
    led = replace(
        plan,
        q=np.concatenate([q, rest.q[1:]]),
        segment=np.concatenate([np.zeros(len(q), dtype=np.int64), rest.segment[1:]]),
        s=np.concatenate([np.linspace(0.0, 1.0, len(q)), rest.s[1:]]),
        approach=True,
    )
    return led if checker.free(led.q, X_WO) else None


def ahead(plan: Plan) -> Plan:
    """A plan from its first guiding pose on."""
    last = int(np.flatnonzero(plan.segment == 0)[-1])
    return replace(plan, q=plan.q[last:], segment=plan.segment[last:], s=plan.s[last:])


def tried_first(plans: Sequence[Plan]) -> NDArray[np.int64]:
    """Indices of TRIED plans at most, in the order in which to seek ways around.

    The one whose first guiding pose is reached nearest to the start, then each time the one that
    reaches it farthest from all before; none within APART of another.
    """
    chosen: list[int] = []
    if plans:
        q = np.stack([ahead(plan).q[0] for plan in plans])
        chosen.append(int(np.linalg.norm(q - plans[0].q[0], axis=1).argmin()))
        away = np.linalg.norm(q - q[chosen[0]], axis=1)
        while len(chosen) < TRIED and away.max() > APART:
            chosen.append(int(away.argmax()))
            away = np.minimum(away, np.linalg.norm(q - q[chosen[-1]], axis=1))
    return np.array(chosen, dtype=np.int64)
