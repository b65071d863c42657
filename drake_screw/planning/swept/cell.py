"""A workcell as arrays: the shapes that an arm moves, all others, and which could touch."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.swept.convex import Convex

Array = NDArray[np.float64]
Index = NDArray[np.int64]

DEEPEST = 24
"""Times that a step is halved at most."""

QUESTIONS = 16
"""Configurations of a path that are put to Drake at most; where that is not enough, it is asked
about all of the path."""


class Cell(NamedTuple):
    """An arm of n joints and S shapes, of which it moves the last M, in the order of its joints.

    Pairs are in groups: shapes near one another that one shape could touch, on links of the same
    joint.

    Attributes:
        screws: (n, 6) of its joints at q = 0, in W about its origin.
        limits: (2, n) that its joints keep to.
        shapes: the shapes.
        X_WG: (S, 3, 4) their poses at q = 0; of a shape of an object X_OG.
        joint: (S,) the last joint before each, from 0; -1 for what the arm does not move.
        object: (S,) the object whose shape it is; -1.
        reach: (S,) m, of its points from the origin of G, at most.
        box: (S, 3) m, half extents of a box about G that holds each shape.
        centers: (3, M) m, origins of G of what the arm moves, at q = 0.
        moved_joint, moved_reach: (M,) as `joint` and `reach` have them.
        begin: (n,) the first of the M that each joint moves.
        pairs: (P, 2) shapes that could touch, the second one moved by more joints.
        slot: (P,) the place of a pair's motion in `Room.travel`: that of its second shape, seen
            from behind the joint that moves the first one.
        groups: (C + 1,) where the pairs of each group begin.
        spans: (D + 1,) where the groups of each slot begin; span_slot, span_shape: (D,) which slot
            that is, and the second shape of its pairs.
        around: (6 C,) m, lower and upper x, y, z of boxes in W around each group's shapes; infinite
            where they are not fixed in W.
        standing: (R, 2) shapes that could touch of which the arm moves neither.
        clearance: m, that they have to be apart.
    """

    screws: Array
    limits: Array
    shapes: Convex
    X_WG: Array
    joint: Index
    object: Index
    reach: Array
    box: Array
    centers: Array
    moved_joint: Index
    moved_reach: Array
    begin: Index
    pairs: Index
    slot: Index
    groups: Index
    spans: Index
    span_slot: Index
    span_shape: Index
    around: Array
    standing: Index
    clearance: float


class Room(NamedTuple):
    """What one thread works in.

    Attributes:
        E: (n + 1, 3, 4) how each joint moves what lies behind it.
        axes: (n, 6) the joints' screws as they are.
        q, dq: (n,) a configuration, and how far joints are from it at most, rad or m.
        fastest: (n,) how fast each joint moves in a step at most.
        sines, cosines: (n,) of q.
        bend: (5, n) a step as a polynomial.
        centers: (3, M) m, origins of the shapes that the arm moves.
        travel: (n M,) m, how far each is from there at most, seen from before each joint.
        way: (M,) m, of the joints so far.
        gone: (n M,) m, the sum of all travel.
        until: (P,) m, up to which of it a pair need not be looked at; first: (C,) least of a group;
            wake: (D,) least of a slot.
        start: (n,) where the last path started; until_at_start, first_at_start: what is known there
            wherever objects are.
        X_WG: (S, 3, 4) poses of shapes.
        stamp: (S,) when they were last written; clock: (1,) now.
        v: (P + R, 3), hints: (P + R, 2) of each pair, where its bounds were found last.
        listed: (DEEPEST + 2, P) pairs to look at in halves of halves of a step; lengths: of lists.
        place: (DEEPEST + 2,) which half of halves.
        W, weights, pa, pb: of `separation`.
        asked: (QUESTIONS, n) rad or m, questions to Drake; at: (QUESTIONS, 2) their step and place
            in it; questions: (1,) of them, those that found no room included.
    """

    E: Array
    axes: Array
    q: Array
    dq: Array
    fastest: Array
    sines: Array
    cosines: Array
    bend: Array
    centers: Array
    travel: Array
    way: Array
    gone: Array
    until: Array
    first: Array
    wake: Array
    start: Array
    until_at_start: Array
    first_at_start: Array
    X_WG: Array
    stamp: Index
    clock: Index
    v: Array
    hints: Index
    listed: Index
    lengths: Index
    place: Index
    W: Array
    weights: Array
    pa: Array
    pb: Array
    asked: Array
    at: Array
    questions: Index


def room_for(cell: Cell) -> Room:
    """Room to work in, for one thread."""
    n, M, P = len(cell.screws), len(cell.moved_joint), len(cell.pairs)
    both = P + len(cell.standing)
    return Room(
        E=np.tile(np.eye(4)[:3], (n + 1, 1, 1)),
        axes=np.zeros((n, 6)),
        q=np.zeros(n),
        dq=np.zeros(n),
        fastest=np.zeros(n),
        sines=np.zeros(n),
        cosines=np.zeros(n),
        bend=np.zeros((5, n)),
        centers=np.zeros((3, M)),
        travel=np.zeros(n * M),
        way=np.zeros(M),
        gone=np.zeros(n * M),
        until=np.zeros(P),
        first=np.zeros(len(cell.groups) - 1),
        wake=np.zeros(len(cell.span_slot)),
        start=np.full(n, np.nan),
        until_at_start=np.zeros(P),
        first_at_start=np.zeros(len(cell.groups) - 1),
        X_WG=np.array(cell.X_WG),
        stamp=np.zeros(len(cell.joint), dtype=np.int64),
        clock=np.zeros(1, dtype=np.int64),
        v=np.zeros((both, 3)),
        hints=np.zeros((both, 2), dtype=np.int64),
        listed=np.zeros((DEEPEST + 2, P), dtype=np.int64),
        lengths=np.zeros(DEEPEST + 2, dtype=np.int64),
        place=np.zeros(DEEPEST + 2, dtype=np.int64),
        W=np.zeros((5, 3)),
        weights=np.zeros(4),
        pa=np.zeros(6),
        pb=np.zeros(6),
        asked=np.zeros((QUESTIONS, n)),
        at=np.zeros((QUESTIONS, 2)),
        questions=np.zeros(1, dtype=np.int64),
    )
