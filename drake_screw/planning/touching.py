"""What touches: from outcomes that are collisions to the names of bodies."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from drake_screw.planning.outcomes import Cause, Outcomes, Plan
from drake_screw.robot import Workcell
from drake_screw.typing import Array

LEAST = 0.03
"""Share of the collisions from which on a pair is named."""
NEARLY = 0.02
"""m. Where an outcome says that something touches, bodies this near are looked for, too: a place is
known to the precision of a float, and between the points of a plan along straight lines."""

Pair = tuple[str, str]
"""Names of two bodies, that of the robot's first."""


@dataclass(frozen=True)
class CollisionCounts:
    """How failing instances collide, each by its best attempt.

    Attributes:
        failures: how many instances fail.
        collisions: how many of these by a collision.
        pairs: how many of these by the two bodies that touch, as `pair_name` names them, the most
            frequent ones first; the sum is less than `collisions` where it is not known of some.
    """

    failures: int
    collisions: int
    pairs: Mapping[str, int]

    def __str__(self) -> str:
        words = f"{self.collisions:,} of {self.failures:,} failures are collisions"
        shares = [
            f"{pair} {share:.0%}"
            for pair, count in self.pairs.items()
            if (share := count / self.collisions) >= LEAST
        ]
        if len(shares) == 0:
            return words
        rest = self.collisions - sum(list(self.pairs.values())[: len(shares)])
        if rest > 0:
            shares.append(f"others {rest / self.collisions:.0%}")
        return f"{words}: {', '.join(shares)}"


def pair_name(pair: Pair) -> str:
    """Two bodies as one word."""
    return "-".join(pair)


def touch_words(pair: Pair, clearance: float = 0.0) -> str:
    """That two bodies touch, or come nearer to one another than a clearance in m."""
    if clearance > 0.0:
        return f"{pair[0]} is nearer than {100.0 * clearance:g} cm to {pair[1]}"
    return f"{pair[0]} touches {pair[1]}"


def known_pair(outcome: Outcomes, workcell: Workcell) -> Pair | None:
    """The bodies that touch, as far as an outcome of shape () says so itself."""
    pair = int(outcome.pair)
    return workcell.touching(pair) if 0 <= pair < len(workcell.pairs) else None


def touching_bodies(
    outcome: Outcomes, workcell: Workcell, q: Array, X_WO: Array, clearance: float = 0.0
) -> tuple[Pair, ...]:
    """The bodies that touch, in pairs.

    Where the outcome does not say it, Drake is asked; where nothing touches by its account, the
    nearest pair is taken. Empty where nothing is near.

    Args:
        outcome: of shape (), a collision.
        workcell: that it was found in.
        q: (n,) rad or m, the configuration there.
        X_WO: (k, 4, 4) the objects.
        clearance: m, that had to be kept.
    """
    pair = known_pair(outcome, workcell)
    if pair is not None:
        return (pair,)
    found = workcell.colliding_bodies(q, X_WO, clearance)
    return found or workcell.colliding_bodies(q, X_WO, clearance + NEARLY)[:1]


class CollisionTally:
    """Counts what touches, of outcomes that come bit by bit.

    Args:
        workcell: that they are of.
    """

    def __init__(self, workcell: Workcell) -> None:
        self._workcell = workcell
        self._failures = self._collisions = 0
        self._pairs: Counter[int] = Counter()

    def add(self, outcomes: Outcomes) -> None:
        """Counts the failing instances of outcomes (N, D)."""
        best = outcomes.best
        collided = best.cause == Cause.COLLISION
        self._failures += int((~best.success & (best.cause != Cause.NOT_TRIED)).sum())
        self._collisions += int(collided.sum())
        index, count = np.unique(best.pair[collided], return_counts=True)
        self._pairs.update(dict(zip(index.tolist(), count.tolist(), strict=True)))

    @property
    def counts(self) -> CollisionCounts:
        """Of all that were added."""
        pairs: dict[str, int] = {}
        known = len(self._workcell.pairs)
        for index, count in sorted(self._pairs.items(), key=lambda item: (-item[1], item[0])):
            if 0 <= index < known:
                pair = pair_name(self._workcell.touching(index))
                pairs[pair] = pairs.get(pair, 0) + count
        return CollisionCounts(self._failures, self._collisions, pairs)


def count_collisions(outcomes: Outcomes, workcell: Workcell) -> CollisionCounts:
    """Count what touches in the failing instances of outcomes (N, D)."""
    tally = CollisionTally(workcell)
    tally.add(outcomes)
    return tally.counts


def cut_short(plan: Plan, outcome: Outcomes) -> Plan:
    """A plan up to where another outcome of it, of shape (), says that it ended.

    A collision is what planning for the joints alone does not see.
    """
    segment, fraction = int(outcome.segment), float(outcome.fraction)
    progress, end = plan.segment + plan.s, segment + fraction
    k = int(np.searchsorted(progress, end))
    if k == 0 or k == len(progress):
        kept = slice(0, max(k, 1))
        q, segments, s = plan.q[kept], plan.segment[kept], plan.s[kept]
        return replace(plan, q=q, segment=segments, s=s, outcome=outcome)
    share = (end - progress[k - 1]) / (progress[k] - progress[k - 1])
    last = plan.q[k - 1] + share * (plan.q[k] - plan.q[k - 1])
    return replace(
        plan,
        q=np.concatenate([plan.q[:k], last[None]]),
        segment=np.append(plan.segment[:k], segment),
        s=np.append(plan.s[:k], fraction),
        outcome=outcome,
    )
