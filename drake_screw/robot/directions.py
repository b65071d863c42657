"""Which motions of the hand an arm has: all six, or which axis of the hand it cannot do without."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.robot.screw_chain import ScrewChain
from drake_screw.screws import shift
from drake_screw.typing import Array

LENGTH = 0.3
"""m, that count as a radian."""

RANK = 0.05
"""Least singular value, lengths in LENGTH, that a Jacobian of use has at the best of places."""

LOOKED_AT = 32
"""Configurations; what an arm hardly does at any of them it hardly does anywhere."""


def jacobians(chain: ScrewChain, q: ArrayLike) -> Array:
    """(N, 6, n) of configurations (N, n): twists [w; v / LENGTH] in E, about E's origin."""
    q = np.asarray(q, dtype=float)
    X_WE, J = chain.pose_and_jacobian(q)
    J_WE = shift(np.swapaxes(J, -1, -2), X_WE[:, None, :3, 3])
    R = X_WE[:, :3, :3]
    return np.swapaxes(np.concatenate([J_WE[..., :3] @ R, J_WE[..., 3:] @ R / LENGTH], -1), -1, -2)


def spread_configurations(chain: ScrewChain, count: int = LOOKED_AT) -> Array:
    """(count, n) random configurations within the limits, a turn of joints without; always the
    same."""
    lower = np.where(np.isfinite(chain.lower), chain.lower, -np.pi)
    upper = np.where(np.isfinite(chain.upper), chain.upper, np.pi)
    return np.random.default_rng(0).uniform(lower, upper, (count, chain.n))


def has(chain: ScrewChain, free_axis: ArrayLike | None = None) -> bool:
    """Whether the arm can move its hand in every direction somewhere.

    Args:
        chain: the arm.
        free_axis: (3,) in E, about which turns do not count; None where all do.
    """
    return bool(least(chain, spread_configurations(chain), free_axis).max() > RANK)


def least(chain: ScrewChain, q: ArrayLike, free_axis: ArrayLike | None = None) -> Array:
    """(N,) how well the hand moves in the direction in which it does worst, at q (N, n).

    That is the least singular value of the Jacobian, lengths in LENGTH; 0 for too few joints.

    Args:
        chain: the arm.
        q: configurations, rad or m.
        free_axis: (3,) in E, about which turns do not count; None where all do.
    """
    J = jacobians(chain, q)
    if free_axis is not None:
        z = np.asarray(free_axis, dtype=float) / np.linalg.norm(free_axis)
        across = np.linalg.svd(z[None])[2][1:]
        J = np.concatenate([across @ J[:, :3], J[:, 3:]], axis=1)
    if J.shape[2] < J.shape[1]:
        return np.zeros(len(J))
    return np.asarray(np.linalg.svd(J, compute_uv=False)[:, -1])


def missing_turn(chain: ScrewChain, q: ArrayLike) -> Array:
    """(N, 3) about which axis in E an arm of five joints cannot turn its hand on the spot.

    The vectors are those parts of the unit twists which the arm lacks that are turns: where one is
    short, it is a shift rather than a turn that the arm lacks.
    """
    U = np.linalg.svd(jacobians(chain, q))[0]
    lacking = U[:, :3, -1]
    return lacking if chain.n == 5 else 0.0 * lacking
