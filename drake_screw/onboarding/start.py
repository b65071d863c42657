"""Configurations to start from: the hand level before the work area, far from limits, touching
nothing."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from drake_screw.onboarding.free_axis import free_axis
from drake_screw.onboarding.hand_ik import Range, kinematics, nearest_seeds, solve, spread
from drake_screw.onboarding.rectangles import Rectangle
from drake_screw.robot import ScrewChain, Workcell
from drake_screw.screws import pose
from drake_screw.typing import Array

ABOVE = (0.2, 0.3, 0.4)
"""m, heights of the hand over the table."""
BEFORE = (-0.1, 0.0, 0.1, 0.2)
"""m, that it is before the middle of the work area's near edge, towards the shoulder."""
SIDES = (-0.25, 0.0, 0.25)
"""Parts of the work area's width that it is beside the middle."""
ASIDE = (-0.6, 0.0, 0.6)
"""rad, from the straight way out, that it points."""
PITCH = (0.0, 0.15)
"""rad, of its z axis below the horizon."""
SEEDS = 8
COMFORT = 1.0
"""rad, of distance from the limits beyond which more is no better."""
APART = 0.5
"""rad, in some joint, between starts that are worth trying both."""
LEAST = 0.15
"""rad, from every limit."""
CLEARANCE = 0.02
"""m, from the table; links of one arm may be nearer to one another."""
DIGITS = 3


@dataclass(frozen=True)
class Start:
    """A configuration (n,) rad or m, its distance from the limits, and a score.

    With fewer joints than six, the axis of the hand about which its roll is to be free.
    """

    q: tuple[float, ...]
    margin: float
    score: float
    free_axis: tuple[float, float, float] | None = None


def starts(
    workcell: Workcell,
    chain: ScrewChain,
    within: Range,
    area: Rectangle,
    top: float,
    count: int,
    task: str,
) -> list[Start]:
    """The best configurations to start from, unlike one another, the best first.

    Args:
        workcell: to touch nothing in; its objects are taken away.
        chain: the arm.
        within: where configurations are looked for.
        area: the work area as it is known so far.
        top: m, the table's height.
        count: most to return.
        task: "pouring" or "scooping", for which an axis to roll about is chosen.
    """
    p, z = _targets(chain.shoulder, area, top)
    bank = spread(within, 3000)
    seeds = nearest_seeds(chain, bank, p, z, SEEDS)
    q, there = solve(
        chain, within, np.repeat(p, SEEDS, 0), np.repeat(z, SEEDS, 0), seeds.reshape(-1, chain.n)
    )
    q = q[there]
    if _rolls(chain):
        q[:, -1] = within.middle[-1]
    q = np.round(q, DIGITS)
    margin = within.margin(q)
    q, margin = q[margin >= LEAST], margin[margin >= LEAST]
    score = np.minimum(margin, COMFORT) + _agility(chain, q) + 0.3 * _elbow(chain, q)
    score -= 0.5 * np.abs(chain.pose(q)[:, 1, 3] - sum(area.y) / 2.0)
    away = np.arange(1.0, len(workcell.objects) + 1)[:, None] * [0.0, 0.0, 1e3]
    X_WO = pose(np.eye(3), away)
    checker = workcell.checker.Clone()
    for clearance in (CLEARANCE, CLEARANCE / 10.0):  # the shoulder of a small arm is near the table
        checker.SetPaddingAllRobotEnvironmentPairs(clearance)
        found: list[Start] = []
        for i in np.argsort(-score):
            if any(np.abs(q[i] - other.q).max() < APART for other in found):
                continue
            if workcell.collides(q[i : i + 1], X_WO, checker=checker)[0]:
                continue
            start = tuple(map(float, q[i] + 0.0))
            axis = free_axis(chain, start, task)
            found.append(Start(start, float(margin[i]), float(score[i]), axis))
            if len(found) == count:
                break
        if found:
            break
    return found


def _targets(shoulder: Array, area: Rectangle, top: float) -> tuple[Array, Array]:
    """Places (m, 3) and directions (m, 3) of the hand."""
    places, directions = [], []
    middle = sum(area.y) / 2.0
    for side, before, above, aside, pitch in itertools.product(SIDES, BEFORE, ABOVE, ASIDE, PITCH):
        edge = np.array([area.x[0], middle + side * area.size[1]]) - shoulder[:2]
        azimuth, distance = np.arctan2(edge[1], edge[0]), np.linalg.norm(edge) - before
        out = np.array([np.cos(azimuth), np.sin(azimuth)])
        places.append([*(shoulder[:2] + distance * out), top + above])
        azimuth, level = azimuth + aside, np.cos(pitch)
        directions.append([level * np.cos(azimuth), level * np.sin(azimuth), -np.sin(pitch)])
    return np.array(places), np.array(directions)


def _rolls(chain: ScrewChain) -> bool:
    """Whether the last joint turns the hand about its own z axis, so that any roll will do."""
    w = chain.home[:3, :3].T @ chain.screws[-1, :3]
    return bool(abs(w[2]) > 0.999)


def _agility(chain: ScrewChain, q: Array) -> Array:
    """(N,) how far from a singularity: the least singular value of J, lengths in half metres."""
    _, J = kinematics(chain, q)
    values = np.linalg.svd(J * np.repeat([[0.5], [1.0]], 3, axis=0), compute_uv=False)
    return np.asarray(np.minimum(2.0 * values[:, -1], 1.0))


def _elbow(chain: ScrewChain, q: Array) -> Array:
    """(N,) m, how high the middle of the arm is above the hand and below 0.5."""
    if len(q) == 0:
        return np.zeros(0)
    motions = chain.motions(q)
    middle = chain.n // 2
    S = chain.screws[middle]
    point = np.append(np.cross(S[:3], S[3:]), 1.0)
    z = (motions[middle] @ point)[:, 2]
    return np.asarray(np.clip(z - chain.pose(q)[:, 2, 3], -0.5, 0.5))
