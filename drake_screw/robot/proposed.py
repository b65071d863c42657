"""Pairs of a robot's links that touch where nothing is wrong: at rest, always, or never."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from drake_screw.robot.workcell import Workcell
from drake_screw.typing import Array

Kind = Literal["start", "always", "never"]

TURN = np.pi
"""rad to either side, of joints that may turn farther, or without limits."""


@dataclass(frozen=True)
class ProposedPair:
    """Two links of a robot that need not be looked at for touching one another.

    Attributes:
        a, b: names of the links, in the order of the model.
        kind: "start" where they touch at the start, "always" where they do wherever the arm is,
            "never" where they were never found to.
        reason: in words.
        share: of the configurations that were looked at in which they touch.
    """

    a: str
    b: str
    kind: Kind
    reason: str
    share: float


def proposed_pairs(
    workcell: Workcell, rng: np.random.Generator, count: int = 1000, *, never: bool = False
) -> tuple[ProposedPair, ...]:
    """Pairs of the robot's links that touch at the start, or wherever the arm is.

    Configurations are drawn uniformly within the joint limits; joints that are not the arm's rest.
    Pairs that are let touch already are left out, and so is what the hand holds.

    Args:
        workcell: of the robot.
        rng: draws the configurations.
        count: of them, at least 1.
        never: whether pairs that never touch are proposed, too. It is not shown that they cannot:
            of n configurations in which nothing touches, a part of 3/n may touch anyway.

    Returns:
        In the order of the model's links.
    """
    if count < 1:
        raise ValueError(f"count is {count}, expected at least 1")
    arm = workcell.arm
    lower, upper = np.maximum(arm.lower, -TURN), np.minimum(arm.upper, TURN)
    drawn = rng.uniform(lower, upper, (count, arm.n))
    pairs = _own_pairs(workcell)
    touch = _touching(workcell, np.vstack([workcell.start, drawn]), pairs)
    at_start, share = touch[0], touch[1:].mean(axis=0)
    found = []
    for i, (a, b) in enumerate(pairs):
        kind, reason = _reason(bool(at_start[i]), float(share[i]), count, never)
        if kind is not None:
            found.append(ProposedPair(a, b, kind, reason, float(share[i])))
    return tuple(found)


def _reason(at_start: bool, share: float, count: int, never: bool) -> tuple[Kind | None, str]:
    drawn = f"{count:,} configurations drawn within the joint limits"
    if share == 1.0:
        return "always", f"touch in all of {drawn}" + (", and at the start" if at_start else "")
    if at_start:
        return "start", f"touch at the start, and in {share:.0%} of {drawn}"
    if never and share == 0.0:
        return "never", f"touch in none of {drawn}"
    return None, ""


def _own_pairs(workcell: Workcell) -> tuple[tuple[str, str], ...]:
    """Names of two links of the robot that could touch, as far as Drake looks at them."""
    tool = None if workcell.tool is None else workcell.tool.index()
    return tuple(
        workcell.touching(i)
        for i, pair in enumerate(workcell.pairs)
        if tool not in pair and all(map(workcell.checker.IsPartOfRobot, pair))
    )


def _touching(workcell: Workcell, q: Array, pairs: tuple[tuple[str, str], ...]) -> Array:
    """Whether the links of each pair touch, (m, pairs) bool, at q (m, n)."""
    number = {frozenset(pair): i for i, pair in enumerate(pairs)}
    touch = np.zeros((len(q), len(pairs)), dtype=bool)
    for i, each in enumerate(q):
        for names in workcell.colliding_bodies(each, workcell.objects_away):
            place = number.get(frozenset(names))
            if place is not None:
                touch[i, place] = True
    return touch
