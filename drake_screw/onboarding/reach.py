"""How well an arm reaches places on a table: inverse kinematics, before anything is taught."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.onboarding.hand_ik import Range, nearest_seeds, solve, spread
from drake_screw.robot import ScrewChain
from drake_screw.typing import Array

BANK = 1500
SEEDS = 4
"""Configurations that each target is tried from."""

COMFORT = 0.12
"""rad, of distance from the limits that counts as reached."""


@dataclass(frozen=True)
class Hold:
    """How the hand is at an object while the task is done, as people have it; m and rad.

    Attributes:
        behind: from its origin forward to the object's axis.
        height: above the object's bottom.
        pitch: of its z axis below the horizon.
    """

    behind: float
    height: float
    pitch: float


HOLDS: Mapping[str, Hold] = {
    "pouring": Hold(0.13, 0.14, 0.16),
    "scooping": Hold(0.22, 0.11, 0.28),
}

ASIDE = (-0.6, 0.0, 0.6)
"""rad, from the straight way out to an object, from which it is come to."""


@dataclass(frozen=True, eq=False)
class ReachMap:
    """Shares of directions of approach that work.

    Attributes:
        x, y: (X,), (Y,) m, of the places.
        share: (X, Y).
    """

    x: Array
    y: Array
    share: Array


def hand_targets(
    xy: Array, z: float, p_WS: Array, hold: Hold, aside: tuple[float, ...] = ASIDE
) -> tuple[Array, Array]:
    """Where the hand is and points at objects.

    Args:
        xy: (M, 2) m, the objects.
        z: m, their bottoms' height.
        p_WS: (3,) the shoulder.
        hold: how.
        aside: rad, A directions of approach, from the straight one.

    Returns:
        p, z (M, A, 3).
    """
    away = xy - p_WS[:2]
    azimuth = np.arctan2(away[:, 1], away[:, 0])[:, None] + np.array(aside)
    c, s = np.cos(azimuth), np.sin(azimuth)
    p = np.stack(
        [
            xy[:, :1] - hold.behind * c,
            xy[:, 1:] - hold.behind * s,
            np.full_like(c, z + hold.height),
        ],
        axis=-1,
    )
    down, level = np.sin(hold.pitch), np.cos(hold.pitch)
    return p, np.stack([c * level, s * level, np.full_like(c, -down)], axis=-1)


def reached(
    chain: ScrewChain, within: Range, p: Array, z: Array, bank: Array | None = None
) -> tuple[Array, NDArray[np.bool_]]:
    """The most comfortable configuration for each of N targets, and whether there is one.

    Args:
        chain: the arm.
        within: where configurations are looked for.
        p, z: (N, 3) of the targets.
        bank: (B, n) configurations to begin from.

    Returns:
        (N, n) and (N,).
    """
    bank = spread(within, BANK) if bank is None else bank
    best, fine = np.tile(within.middle, (len(p), 1)), np.zeros(len(p), dtype=bool)
    near = np.flatnonzero(np.linalg.norm(p - chain.shoulder, axis=1) <= chain.reach)
    if len(near):
        best[near], fine[near] = _reached(chain, within, p[near], z[near], bank)
    return best, fine


def _reached(
    chain: ScrewChain, within: Range, p: Array, z: Array, bank: Array
) -> tuple[Array, NDArray[np.bool_]]:
    seeds, N = nearest_seeds(chain, bank, p, z, SEEDS), len(p)
    q, there = solve(
        chain, within, np.repeat(p, SEEDS, 0), np.repeat(z, SEEDS, 0), seeds.reshape(-1, chain.n)
    )
    margin = np.where(there, within.margin(q), -1.0).reshape(N, SEEDS)
    best = margin.argmax(axis=1)
    rows = np.arange(N)
    return q.reshape(N, SEEDS, -1)[rows, best], margin[rows, best] >= COMFORT


def reach_map(
    chain: ScrewChain,
    within: Range,
    x: Array,
    y: Array,
    z: float,
    hold: Hold,
    aside: tuple[float, ...] = ASIDE,
) -> ReachMap:
    """Shares of directions from which objects on a level at height z can be come to."""
    xy = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    p, z_axis = hand_targets(xy, z, chain.shoulder, hold, aside)
    _, there = reached(chain, within, p.reshape(-1, 3), z_axis.reshape(-1, 3))
    share = there.reshape(len(xy), -1).mean(axis=1)
    return ReachMap(x, y, share.reshape(len(x), len(y)))
