"""Which failed instance the next demonstration is asked for at: the rules to choose from.

A rule is named in the scenario as `demonstrations.ask`. What it is called with, and what it
answers, is said at `AskingRule`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from drake_screw.acquisition.events import Evaluation
from drake_screw.tasks import Regions, WorkArea
from drake_screw.typing import Array

AskingRule = Callable[[Evaluation, int, Regions, np.random.Generator], NDArray[np.int64]]
"""(evaluation of a round, its weakest region, its regions, random numbers) to rows of the
evaluation: failed instances, the one to ask for first and those to ask for if the teacher has no
answer there after it. Where it answers none, no demonstration is asked for."""

NEIGHBOURHOOD = 0.25
"""Half the width of the box around an instance in which its neighbours are, of the work area's."""

MOST = 1024
"""Failed instances that are looked at, drawn at random where there are more."""


def earliest(
    evaluation: Evaluation, region: int, regions: Regions, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Failed instances of the weakest region, the one that failed earliest first.

    An instance counts by its best attempt: the furthest screw segment that any demonstration in
    hand got to. Those that got least far come first, in random order among equals (the paper's
    heuristic: there the demonstrations in hand help least).
    """
    failed = np.flatnonzero(evaluation.failed & (evaluation.region == region))
    segment = evaluation.outcomes[failed].furthest_segment
    return failed[np.lexsort((rng.random(len(failed)), segment))]


def densest(
    evaluation: Evaluation, region: int, regions: Regions, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Failed instances of the weakest region, the one with most failures around it first.

    Neighbours are the failed instances of all regions in a box around it, half as wide as the work
    area along every axis. Each counts by how much of the work area it stands for, so it makes no
    difference that more instances are drawn in some regions than in others. The second one is not
    a neighbour of the first, nor the third of these, as long as there are others.
    """
    mine = evaluation.failed & (evaluation.region == region)
    return _by_density(evaluation, mine, regions, rng)


def densest_anywhere(
    evaluation: Evaluation, region: int, regions: Regions, rng: np.random.Generator
) -> NDArray[np.int64]:
    """As `densest`, but of all failed instances, whichever region they are in."""
    return _by_density(evaluation, evaluation.failed, regions, rng)


def shares(evaluation: Evaluation, regions: Regions) -> Array:
    """(N,) share of the work area that each instance stands for: its region's over its region's N.

    Regions that nothing was drawn in are stood for by none.
    """
    drawn = np.bincount(evaluation.region, minlength=regions.K)
    return (regions.shares / np.maximum(drawn, 1))[evaluation.region]


def evenly(
    evaluation: Evaluation, regions: Regions, rng: np.random.Generator, count: int
) -> NDArray[np.int64]:
    """Rows of failed instances, drawn evenly over the part of the work area that fails.

    Args:
        evaluation: of a round.
        regions: its regions.
        rng: draws them.
        count: how many; some may be drawn more than once.

    Returns:
        (count,), or (0,) where nothing fails.
    """
    failed = np.flatnonzero(evaluation.failed)
    if len(failed) == 0:
        return failed
    share = shares(evaluation, regions)[failed]
    return rng.choice(failed, count, p=share / share.sum())


def apart(area: WorkArea, here: Array, there: Array) -> Array:
    """How far task instances are from each other, as a part of the work area's extent.

    Args:
        area: the work area.
        here: (A, k, c).
        there: (B, k, c).

    Returns:
        (A, B), along the axis along which they are farthest apart; a yaw or roll that may be
        anything goes round.
    """
    here, there = area.flat(here), area.flat(there)
    extent = area.flat(area.upper) - area.flat(area.lower)
    turns = [axis in ("yaw", "roll") for axis in area.axes]
    closed = turns & (extent > 2.0 * np.pi - 1e-9)
    farthest = np.zeros((len(here), len(there)))
    for i, j in zip(*np.nonzero(area.free), strict=True):
        along = np.abs(here[:, None, i, j] - there[:, i, j]) / extent[i, j]
        if closed[i, j]:
            along = np.minimum(along, 1.0 - along)
        np.maximum(farthest, along, out=farthest)
    return farthest


def _by_density(
    evaluation: Evaluation,
    candidate: NDArray[np.bool_],
    regions: Regions,
    rng: np.random.Generator,
) -> NDArray[np.int64]:
    """Rows of `candidate` (N,) by how much fails around them, first those apart."""
    around = _some(np.flatnonzero(evaluation.failed), rng)
    rows = _some(np.flatnonzero(candidate), rng)
    place, share = evaluation.coordinates, shares(evaluation, regions)
    near = apart(regions.area, place[rows], place[around]) <= NEIGHBOURHOOD
    left, weight = np.full(len(rows), True), near.astype(float) @ share[around]
    chosen: list[int] = []
    while left.any():
        best = int(np.argmax(np.where(left, weight, -1.0)))
        chosen.append(best)
        left &= apart(regions.area, place[rows], place[rows[best], None])[:, 0] > NEIGHBOURHOOD
    left[:] = True
    left[chosen] = False
    others = np.flatnonzero(left)
    others = others[np.argsort(-weight[others], kind="stable")]
    return rows[[*chosen, *others]]


def _some(rows: NDArray[np.int64], rng: np.random.Generator) -> NDArray[np.int64]:
    return rows if len(rows) <= MOST else np.sort(rng.choice(rows, MOST, replace=False))
