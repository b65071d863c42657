"""A free approach: the way to the first guiding pose is any joint motion, not a screw.

Nothing that the task asks for happens before the first guiding pose. So the arm may come there in
any configuration: the planner follows screws to it from many others than the start (that is its
inverse kinematics), goes on from there, and the way from the start is a straight line in joint
space, which keeps joint limits wherever its ends do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drake_screw.planning.outcomes import Outcomes, Plan
from drake_screw.planning.paths import SPACING
from drake_screw.robot import ScrewChain
from drake_screw.screws.endless import within_a_turn
from drake_screw.typing import Array

WIDE, NARROW = 0.98, 0.5
"""Parts of the joints' ranges, about their middles, in which configurations are drawn by turns."""


def seeds(chain: ScrewChain, count: int) -> Array:
    """Configurations (count, n), spread evenly over the joints' ranges; the same every time.

    A joint without limits has a turn for its range.
    """
    from scipy.stats import qmc  # takes long to import

    u = qmc.Sobol(chain.n, seed=0).random(int(2 ** np.ceil(np.log2(max(count, 1)))))[:count] - 0.5
    part = np.where(np.arange(count) % 2 == 0, NARROW, WIDE)
    lower, upper = within_a_turn(chain.lower, chain.upper)
    return np.asarray((lower + upper) / 2.0 + part[:, None] * u * (upper - lower))


def approached(plan: Plan, q_start: Array) -> Plan:
    """A plan from another configuration with a straight joint motion in place of its first segment.

    Where it does not reach the first guiding pose, the arm stays where it starts.
    """
    there = np.flatnonzero((plan.segment == 0) & (plan.s >= 1.0))
    if len(there) == 0:
        still = np.zeros(1, dtype=np.int64), np.zeros(1)
        return replace(plan, q=q_start[None], segment=still[0], s=still[1], approach=True)
    last = int(there[-1])
    q, segment, s = straight(q_start, plan.q[last])
    return replace(
        plan,
        q=np.concatenate([q, plan.q[last + 1 :]]),
        segment=np.concatenate([segment, plan.segment[last + 1 :]]),
        s=np.concatenate([s, plan.s[last + 1 :]]),
        approach=True,
    )


def stuck(
    q_start: Array, outcomes: Outcomes, guides: Sequence[Array], angles: Array
) -> tuple[Plan, ...]:
    """Plans that stay where they start, q_start (n,): of outcomes (N,) of a start that fails."""
    stay = np.zeros(1, dtype=np.int64), np.zeros(1)
    return tuple(
        Plan(q_start[None], *stay, outcomes[i], guides[i], angles[i]) for i in range(len(guides))
    )


def straight(q_start: Array, q_end: Array) -> tuple[Array, Array, Array]:
    """A straight joint motion (n,) to (n,): points (m, n), their segment 0 and fraction s (m,)."""
    parts = max(int(np.ceil(np.abs(q_end - q_start).sum() / SPACING)), 1)
    s = np.linspace(0.0, 1.0, parts + 1)
    return q_start + s[:, None] * (q_end - q_start), np.zeros(parts + 1, dtype=np.int64), s
