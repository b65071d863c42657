"""Whether an arm touches anything along a step of a joint path, and where first.

A stretch of a step is free where, at its middle, every two shapes are farther apart than they can
come nearer on the way to its ends (see `motion`). Pairs of which that is not so are looked at again
in its two halves, and so on: what comes out holds for all of the path, not for points of it.
"""

from __future__ import annotations

import math

import numpy as np
from numba import uintp

from drake_screw.planning.compiled.inner import inlined, inner
from drake_screw.planning.swept.bounds import between, exactly, outside, standing_shapes
from drake_screw.planning.swept.cell import DEEPEST, QUESTIONS
from drake_screw.planning.swept.motion import (
    place_arm,
    place_balls,
    place_object_shapes,
)
from drake_screw.planning.swept.separation import BAND

FINEST = 1e-5
"""m, of travel to either side of a configuration: stretches as short as that are not halved. So
much deeper than at the configurations looked at may shapes touch unnoticed."""

PART = 0.25
"""rad (or m), summed up over the joints: parts of a step in which to look at all pairs."""

COARSE = 5e-3
"""m, the same where it is known that something touches and only the place is sought."""

NONE = 2.0
"""A place in a step, 0 to 1, that says that nothing touches."""


@inlined
def as_polynomial(q, room):  # type: ignore[no-untyped-def]
    """A step of a trace (5, n) as a polynomial of fourth degree, by its five Bernstein ordinates.

    They are those of `dense_output`. The polynomial changes at most as fast as they do from one to
    the next, times its degree.

    Returns:
        How far the joints move in the step at most, summed up, rad or m.
    """
    motion = 0.0
    for k in range(q.shape[1]):
        q0, q1, d0, d1, e = q[0, k], q[1, k], q[2, k], q[3, k], q[4, k]
        middle = 0.5 * (q0 + q1) + (d0 - d1 + e) / 6.0
        room.bend[0, k] = q0
        room.bend[1, k] = q0 + 0.25 * d0
        room.bend[2, k] = middle
        room.bend[3, k] = q1 - 0.25 * d1
        room.bend[4, k] = q1
        inside = max(abs(room.bend[1, k] - middle), abs(room.bend[3, k] - middle))
        room.fastest[k] = 4.0 * max(inside, 0.25 * max(abs(d0), abs(d1)))
        motion += room.fastest[k]
    return motion


@inlined
def go_to(cell, room, u, half):  # type: ignore[no-untyped-def]
    """Puts the arm at a place u of a step; says how far its joints are from it within a half."""
    v, bend = 1.0 - u, room.bend
    for k in range(len(room.q)):
        c0, c1, c2, c3, c4 = bend[0, k], bend[1, k], bend[2, k], bend[3, k], bend[4, k]
        room.dq[k] = room.fastest[k] * half
        q = v * v * (v * v * c0 + 4.0 * u * v * c1 + 6.0 * u * u * c2)
        q += u * u * (4.0 * u * v * c3 + u * u * c4)
        room.q[k] = min(max(q, cell.limits[0, k]), cell.limits[1, k])
    place_arm(cell, room)
    place_balls(cell, room)


@inlined
def look(cell, room, depth):  # type: ignore[no-untyped-def]
    """Which of a list's pairs may touch within `room.dq` of `room.q`: the list of the next depth.

    Returns:
        The first pair that surely touches at `room.q`, -1 if none does; the longest travel among
        the pairs listed, m; whether some of them may touch at `room.q` already.
    """
    found, longest, doubt, kept = -1, 0.0, False, 0
    for i in range(room.lengths[depth]):
        number = room.listed[depth, i]
        pair = uintp(number)
        slot = uintp(cell.slot[pair])
        travel = room.travel[slot]
        lower, upper = between(cell, room, pair, travel)
        spare = lower - cell.clearance - travel - BAND
        if spare > 0.0:
            if depth == 0:
                room.until[pair] = room.gone[slot] + spare
            continue
        if upper < cell.clearance - BAND and found < 0:
            found = number
        doubt |= lower <= cell.clearance + BAND
        longest = max(longest, travel)
        room.listed[depth + 1, kept] = number
        kept += 1
    room.lengths[depth + 1] = kept
    return found, longest, doubt


@inlined
def list_near(cell, room):  # type: ignore[no-untyped-def]
    """Lists all pairs but those that were so far apart that they cannot have met since."""
    gone, travel, first, until = room.gone, room.travel, room.first, room.until
    for slot in range(uintp(len(gone))):
        gone[slot] += 2.0 * travel[slot]
    kept = 0
    moved, around, C = uintp(standing_shapes(cell)), cell.around, uintp(len(first))
    for span in range(uintp(len(room.wake))):
        slot = uintp(cell.span_slot[span])
        so_far = gone[slot]
        if so_far < room.wake[span]:
            continue
        m = uintp(cell.span_shape[span]) - moved
        x, y, z = room.centers[0, m], room.centers[1, m], room.centers[2, m]
        apart = cell.clearance + travel[slot] + BAND + cell.moved_reach[m]
        soonest = 1e300
        for group in range(uintp(cell.spans[span]), uintp(cell.spans[span + uintp(1)])):
            least = first[group]
            if so_far >= least:
                a = max(around[group] - x, x - around[group + 3 * C], 0.0)
                b = max(around[group + C] - y, y - around[group + 4 * C], 0.0)
                c = max(around[group + 2 * C] - z, z - around[group + 5 * C], 0.0)
                square = a * a + b * b + c * c
                if square > apart * apart:
                    least = so_far + math.sqrt(square) - apart
                else:
                    least = 1e300
                    begin, end = cell.groups[group], cell.groups[group + uintp(1)]
                    for pair in range(uintp(begin), uintp(end)):
                        if so_far >= until[pair]:
                            room.listed[0, kept] = np.int64(pair)
                            kept += 1
                            least = so_far
                        else:
                            least = min(least, until[pair])
                first[group] = least
            soonest = min(soonest, least)
        room.wake[span] = soonest
    room.lengths[0] = kept


@inner
def sweep(cell, room, step, q):  # type: ignore[no-untyped-def]
    """The first touch in a step.

    Args:
        step: its number, for questions.
        q: (5, n) the step as a trace has it.

    Returns:
        Its place in the step, NONE if nothing surely touches, and the pair that does. What is left
        open is put down in `room.asked`.
    """
    motion = as_polynomial(q, room)
    parts = math.ceil(motion / PART) if motion > PART else 1
    for part in range(parts):
        hit, pair = _part(cell, room, step, part, parts)
        if hit < NONE:
            return hit, pair
    return NONE, -1


@inner
def _part(cell, room, step, part, parts):  # type: ignore[no-untyped-def]
    """As `sweep`, of one of so many parts of a step."""
    hit, touching = NONE, -1
    depth = 0
    room.place[0] = part
    half = 0.5 / parts
    while True:
        u = (2 * room.place[depth] + 1) * half
        deeper = False
        if u - half < hit:
            go_to(cell, room, u, half)
            if depth == 0:
                list_near(cell, room)
            pair, travel, doubt = look(cell, room, depth)
            if pair >= 0 and u < hit:
                hit, touching = u, pair
            deeper = room.lengths[depth + 1] > 0
            if hit < NONE:
                deeper &= travel > COARSE and depth < DEEPEST
            elif deeper and (travel <= FINEST or depth == DEEPEST):
                deeper = False
                if doubt or travel > FINEST:
                    ask(room, step, u)
        if deeper:
            room.place[depth + 1] = 2 * room.place[depth]
            depth += 1
            half *= 0.5
            continue
        while depth > 0 and room.place[depth] & 1:
            depth -= 1
            half *= 2.0
        if depth == 0:
            return hit, touching
        room.place[depth] += 1


@inlined
def ask(room, step, u):  # type: ignore[no-untyped-def]
    """Puts down a question: the configuration `room.q`, at a place u of a step."""
    k = room.questions[0]
    room.questions[0] += 1
    if k >= QUESTIONS:
        return
    for j in range(len(room.q)):
        room.asked[k, j] = room.q[j]
    room.at[k, 0], room.at[k, 1] = step, u


@inner
def stand(cell, room, X_WO, q):  # type: ignore[no-untyped-def]
    """Places the objects; the first pair that the arm does not move and that surely touches, or -1.

    What is left open is put down as a question about the configuration q (n,).
    """
    place_object_shapes(cell, room, X_WO)
    room.questions[0] = 0
    for i in range(len(cell.standing)):
        a, b, number = cell.standing[i, 0], cell.standing[i, 1], len(cell.pairs) + i
        B, needed = room.X_WG[b], cell.clearance + 2.0 * BAND
        apart = needed + cell.reach[b]
        if outside(cell, room, uintp(a), B[0, 3], B[1, 3], B[2, 3]) > apart * apart:
            continue
        lower, upper = exactly(
            cell.shapes, uintp(a), room.X_WG[a], uintp(b), B, room.v[number], room.hints[number],
            needed, cell.clearance, room.W, room.weights, room.pa, room.pb,
        )  # fmt: skip
        if lower > cell.clearance + BAND:
            continue
        if upper < cell.clearance - BAND:
            return number
        for j in range(len(q)):
            room.q[j] = q[j]
        ask(room, 0, 0.0)
    return -1


@inlined
def set_out(cell, room, q):  # type: ignore[no-untyped-def]
    """What is known of each pair at the start q (n,) of a path: as much as of the last path that
    started there, but of objects, which are elsewhere."""
    same = True
    for k in range(len(q)):
        same &= room.start[k] == q[k]
    if not same:
        for k in range(len(q)):
            room.start[k] = room.q[k] = q[k]
            room.dq[k] = 0.0
        _at_start(cell, room)
    for slot in range(len(room.gone)):
        room.gone[slot] = 0.0
    for span in range(len(room.wake)):
        room.wake[span] = -1.0
    for group in range(len(room.first)):
        room.first[group] = room.first_at_start[group]
    for pair in range(len(room.until)):
        room.until[pair] = room.until_at_start[pair]


@inner
def _at_start(cell, room):  # type: ignore[no-untyped-def]
    """Finds how far pairs are apart at `room.q`, but for those of objects."""
    place_arm(cell, room)
    place_balls(cell, room)
    for slot in range(len(room.gone)):
        room.gone[slot] = 0.0
    for span in range(len(room.wake)):
        room.wake[span] = -1.0
    for group in range(len(room.first)):
        room.first[group] = -1.0
    for pair in range(len(room.until)):
        room.until[pair] = -1.0
    list_near(cell, room)
    look(cell, room, 0)
    for group in range(len(room.first)):
        least = room.first[group]
        for pair in range(cell.groups[group], cell.groups[group + 1]):
            if cell.object[cell.pairs[pair, 0]] >= 0:
                least = room.until[pair] = -1.0
            room.until_at_start[pair] = room.until[pair]
        room.first_at_start[group] = least
