"""Whether a constant screw between two poses of a path holds the samples between, in order.

A screw leads from one pose of a path to another. It holds the samples between if each can be given
a parameter s in [0, 1], never less than that of the sample before, at which the screw is within the
position *and* the rotation tolerance of it. Giving each sample the least admissible s is enough to
decide that: whatever other assignment there is, its parameters are nowhere smaller, so it leaves
later samples no more to choose from.

The least admissible s is found by stepping as far as the tolerances are missed. Along a constant
screw the origin moves at one speed L and the frame turns at one speed theta, so a sample that is
missed by d metres stays missed for d / L, and one missed by a radians for a / theta. Steps have a
least length of 1 % of the tolerances: s may be too late by that, and a sample that the screw
touches for less may count as missed. What counts as held is held.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drake_screw.compile_cache import cached_njit
from drake_screw.typing import Array

LARGEST_TURN = 3.0  # rad; at pi a screw between two poses is no longer the only one
_LEAST_STEP = 0.01


@cached_njit()
def search(
    p: Array,
    q: Array,
    candidates: Array,
    rank: Array,
    failed: Array,
    share: float,
    position_tolerance: float,
    rotation_tolerance: float,
) -> tuple[Array, Array]:
    """Breadth first: the candidates reached from the first by one screw, by two, and so on.

    Args:
        p, q: (m, 3) m and (m, 4), positions and quaternions of the path.
        candidates: (c,) increasing indices of poses between which screws may lead.
        rank: (c,) the only number of screws by which each may be reached; -1 for any.
        failed: (c, c) share of the tolerances at which a screw is known not to hold; updated.
        share: of the tolerances.
        position_tolerance, rotation_tolerance: m, rad.

    Returns:
        (c,) the least number of screws to each candidate, -1 where none was found before the last
        one was reached; and (c,) the candidate before it on the way.
    """
    count = len(candidates)
    place, turn = share * position_tolerance, share * rotation_tolerance
    screws, before, killer = np.full(count, -1), np.full(count, -1), np.full(count, -1)
    screws[0] = 0
    every = np.arange(len(p))
    for number in range(1, count):
        advanced = False
        for j in range(number, count):
            if screws[j] >= 0 or (rank[j] >= 0 and rank[j] != number):
                continue
            for i in range(j - 1, -1, -1):
                if screws[i] != number - 1 or failed[i, j] >= share:
                    continue
                a, b = candidates[i], candidates[j]
                screw = _screw(p, q, a, b)
                held = j == i + 1 or 2.0 * screw[0] <= LARGEST_TURN
                if held and a <= killer[i] <= b:
                    again = killer[i]
                    held = _first_missed(p, q, a, screw, every, again, again + 1, place, turn) < 0
                if held:
                    missed = _first_missed(p, q, a, screw, candidates, i, j + 1, place, turn)
                    if missed < 0:
                        missed = _first_missed(p, q, a, screw, every, a, b + 1, place, turn)
                    held = missed < 0
                    if not held:
                        killer[i] = missed
                if held:
                    screws[j], before[j], advanced = number, i, True
                    break
                failed[i, j] = share
        if screws[count - 1] >= 0 or not advanced:
            break
    return screws, before


@cached_njit()
def poses_on_screws(p: Array, q: Array, count: int) -> tuple[Array, Array]:
    """Poses evenly, by the screw parameter, on the constant screws from each pose to the next.

    Args:
        p, q: (g, 3) m and (g, 4), positions and quaternions.
        count: of poses on a screw, both ends among them; at least 2.

    Returns:
        (g - 1, count, 3) m and (g - 1, count, 4).
    """
    P, Q = np.empty((len(p) - 1, count, 3)), np.empty((len(p) - 1, count, 4))
    for i in range(len(p) - 1):
        half, _, axis, along, across, turned = _screw(p, q, i, i + 1)
        a0, a1, a2, a3 = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
        # (0, axis) * q_a, towards which the quaternion turns
        onward = (
            -(axis[0] * a1 + axis[1] * a2 + axis[2] * a3),
            axis[0] * a0 + axis[1] * a3 - axis[2] * a2,
            axis[1] * a0 + axis[2] * a1 - axis[0] * a3,
            axis[2] * a0 + axis[0] * a2 - axis[1] * a1,
        )
        for n in range(count):
            s = n / (count - 1)
            sine, cosine = np.sin(half * s), np.cos(half * s)
            ratio = sine / np.sin(half) if half > 1e-9 else s
            lag, lead = np.cos(half * (1.0 - s)), -np.sin(half * (1.0 - s))
            for c in range(3):
                P[i, n, c] = p[i, c] + s * along[c] + ratio * (lag * across[c] + lead * turned[c])
            for c in range(4):
                Q[i, n, c] = cosine * q[i, c] + sine * onward[c]
    return P, Q


@cached_njit()
def _screw(p: Array, q: Array, a: int, b: int) -> tuple[Any, ...]:
    """The constant screw from pose a to pose b.

    Returns:
        Half its turn; the speed of the origin in m for unit time; the axis (3); p_ab along the
        axis, across it, and the latter turned by a right angle about the axis, (3) each.
    """
    a0, a1, a2, a3 = q[a, 0], q[a, 1], q[a, 2], q[a, 3]
    b0, b1, b2, b3 = q[b, 0], q[b, 1], q[b, 2], q[b, 3]
    w = a0 * b0 + a1 * b1 + a2 * b2 + a3 * b3
    l0 = a0 * b1 - b0 * a1 - b2 * a3 + b3 * a2
    l1 = a0 * b2 - b0 * a2 - b3 * a1 + b1 * a3
    l2 = a0 * b3 - b0 * a3 - b1 * a2 + b2 * a1
    sine = np.sqrt(l0 * l0 + l1 * l1 + l2 * l2)
    half = np.arctan2(sine, abs(w))
    if sine > 0.0:
        scale = (-1.0 if w < 0.0 else 1.0) / sine
        l0, l1, l2 = scale * l0, scale * l1, scale * l2
    d0, d1, d2 = p[b, 0] - p[a, 0], p[b, 1] - p[a, 1], p[b, 2] - p[a, 2]
    travel = d0 * l0 + d1 * l1 + d2 * l2
    c0, c1, c2 = d0 - travel * l0, d1 - travel * l1, d2 - travel * l2
    arc = np.sqrt(c0 * c0 + c1 * c1 + c2 * c2)
    if half > 1e-9:
        arc *= half / np.sin(half)
    return (
        half, np.sqrt(travel * travel + arc * arc), (l0, l1, l2),
        (travel * l0, travel * l1, travel * l2), (c0, c1, c2),
        (l1 * c2 - l2 * c1, l2 * c0 - l0 * c2, l0 * c1 - l1 * c0),
    )  # fmt: skip


@cached_njit()
def _first_missed(
    p: Array,
    q: Array,
    a: int,
    screw: tuple[Any, ...],
    order: Array,
    start: int,
    stop: int,
    place: float,
    turn: float,
) -> int:
    """The first of the poses order[start:stop] that the screw from pose a does not hold, or -1."""
    half, speed, axis, along, across, turned = screw
    sin_half = np.sin(half)
    least_cosine = np.cos(0.5 * turn)
    rate = max(speed / place, 2.0 * half / turn)
    least_step = _LEAST_STEP / rate if rate > 0.0 else 2.0
    a0, a1, a2, a3 = q[a, 0], q[a, 1], q[a, 2], q[a, 3]
    # (0, axis) * q_a, towards which the quaternion turns
    r0 = -(axis[0] * a1 + axis[1] * a2 + axis[2] * a3)
    r1 = axis[0] * a0 + axis[1] * a3 - axis[2] * a2
    r2 = axis[1] * a0 + axis[2] * a1 - axis[0] * a3
    r3 = axis[2] * a0 + axis[0] * a2 - axis[1] * a1
    s, sine, cosine, ratio = 0.0, 0.0, 1.0, 0.0
    lag, lead = np.cos(half), -sin_half
    for index in range(start, stop):
        k = order[index]
        at_start = a0 * q[k, 0] + a1 * q[k, 1] + a2 * q[k, 2] + a3 * q[k, 3]
        onward = r0 * q[k, 0] + r1 * q[k, 1] + r2 * q[k, 2] + r3 * q[k, 3]
        d0, d1, d2 = p[k, 0] - p[a, 0], p[k, 1] - p[a, 1], p[k, 2] - p[a, 2]
        while True:
            e0 = d0 - s * along[0] - ratio * (lag * across[0] + lead * turned[0])
            e1 = d1 - s * along[1] - ratio * (lag * across[1] + lead * turned[1])
            e2 = d2 - s * along[2] - ratio * (lag * across[2] + lead * turned[2])
            away = np.sqrt(e0 * e0 + e1 * e1 + e2 * e2)
            off = abs(cosine * at_start + sine * onward)
            if away <= place and off >= least_cosine:
                break
            if s >= 1.0 or (away > place and speed == 0.0) or (off < least_cosine and half == 0.0):
                return k
            step = least_step
            if away > place:
                step = max(step, (away - place) / speed)
            if off < least_cosine:
                step = max(step, (np.arccos(off) - 0.5 * turn) / half)
            s = min(s + step, 1.0)
            sine, cosine = np.sin(half * s), np.cos(half * s)
            ratio = sine / sin_half if half > 1e-9 else s
            lag = cosine * np.cos(half) + sine * sin_half
            lead = sine * np.cos(half) - cosine * sin_half
    return -1
