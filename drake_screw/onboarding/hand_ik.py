"""Configurations that bring the hand to a place, pointing somewhere: the roll of it is free.

Damped least squares (Nakamura and Hanafusa, 1986) for the five directions that are asked for, many
targets and beginnings at a time; what joints are left over moves them to the middles of their
ranges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.robot import ScrewChain
from drake_screw.screws import adjoint, shift
from drake_screw.typing import Array

STEPS = 30
LONGEST_STEP = 0.4
"""rad, of a joint in one step."""
DAMPING = 0.03
TO_THE_MIDDLE = 0.05
"""Part of the way to the middles of their ranges that joints go in a step, where they are free."""
ARRIVED = (1e-3, 1e-2)
"""m, rad."""

ENDLESS = np.pi
"""rad, to either side, that a joint without limits is looked for in."""


@dataclass(frozen=True)
class Range:
    """Where configurations are looked for: (n,) least and greatest, rad or m, all finite."""

    lower: Array
    upper: Array

    @property
    def middle(self) -> Array:
        """(n,) halfway."""
        return (self.lower + self.upper) / 2.0

    @property
    def half(self) -> Array:
        """(n,) to either side of the middle."""
        return (self.upper - self.lower) / 2.0

    def margin(self, q: Array) -> Array:
        """(...) the least distance to a limit, in rad, or in quarters of its range of a slide."""
        return np.asarray((np.minimum(q - self.lower, self.upper - q) / self._unit).min(axis=-1))

    @property
    def _unit(self) -> Array:
        return np.where(self.half < 0.5, self.half, 1.0)


def range_of(chain: ScrewChain) -> Range:
    """The joints' limits; more than a turn, or none, counts as half a turn to either side."""
    lower = np.where(np.isfinite(chain.lower), chain.lower, -ENDLESS)
    upper = np.where(np.isfinite(chain.upper), chain.upper, ENDLESS)
    wide = (lower < -ENDLESS) & (upper > ENDLESS)
    return Range(np.where(wide, -ENDLESS, lower), np.where(wide, ENDLESS, upper))


def spread(within: Range, count: int) -> Array:
    """Configurations (count, n), spread evenly over nine tenths of the ranges."""
    from scipy.stats import qmc  # takes long to import

    u = qmc.Sobol(len(within.lower), seed=0).random(int(2 ** np.ceil(np.log2(count))))[:count]
    return np.asarray(within.middle + 0.9 * (2.0 * u - 1.0) * within.half)


def solve(
    chain: ScrewChain, within: Range, p: Array, z: Array, q: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Bring the hand to places.

    Args:
        chain: the arm.
        within: where joints are kept.
        p: (N, 3) m, where the hand's origin is to be.
        z: (N, 3) directions of its z axis.
        q: (N, n) to begin with.

    Returns:
        Configurations (N, n), and which of them are there (N,).
    """
    q = q.copy()
    done = np.zeros(len(q), dtype=bool)
    for step in range(STEPS + 1):
        left = np.flatnonzero(~done)
        X, J = kinematics(chain, q[left])
        e_p, e_w, near = _errors(X, p[left], z[left])
        done[left] = near
        if step == STEPS or done.all():
            break
        left, e_p, e_w, X, J = left[~near], e_p[~near], e_w[~near], X[~near], J[~near]
        w, v, z_E = J[:, :3], J[:, 3:], X[:, :3, 2]
        w = w - z_E[:, :, None] * (z_E[:, None, :] @ w)
        A = np.concatenate([w * 0.3, v], axis=1)
        e = np.concatenate([e_w * 0.3, e_p], axis=1)
        At = np.swapaxes(A, 1, 2)
        G = A @ At + DAMPING**2 * np.eye(6)
        pull = TO_THE_MIDDLE * (within.middle - q[left])
        rest = e - (A @ pull[..., None])[..., 0]
        dq = pull + (At @ np.linalg.solve(G, rest[..., None]))[..., 0]
        dq *= np.minimum(1.0, LONGEST_STEP / np.maximum(np.abs(dq).max(axis=1), 1e-12))[:, None]
        q[left] = np.clip(q[left] + dq, within.lower, within.upper)
    return q, done


def kinematics(chain: ScrewChain, q: Array) -> tuple[Array, Array]:
    """X_WE (N, 4, 4) and J_WE (N, 6, n), [w; v] at E's origin, of configurations (N, n)."""
    motions = chain.motions(q)
    X = motions[-1] @ chain.home
    moved = [
        chain.screws[0],
        *(adjoint(E) @ S for E, S in zip(motions[:-1], chain.screws[1:], strict=True)),
    ]
    return X, np.stack([shift(S, X[:, :3, 3]) for S in moved], axis=-1)


def _errors(X: Array, p: Array, z: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Of position (N, 3) and direction (N, 3), a rotation vector; and whether both are small."""
    e_p = p - X[:, :3, 3]
    z_E = X[:, :3, 2]
    axis, cos = np.cross(z_E, z), (z_E * z).sum(axis=1)
    sin = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(sin, cos)
    opposite = (sin < 1e-9) & (cos < 0.0)
    axis = np.where(opposite[:, None], X[:, :3, 0], axis / np.maximum(sin, 1e-12)[:, None])
    near = (np.linalg.norm(e_p, axis=1) < ARRIVED[0]) & (angle < ARRIVED[1])
    return e_p, axis * angle[:, None], near


def nearest_seeds(chain: ScrewChain, bank: Array, p: Array, z: Array, count: int) -> Array:
    """Of configurations (B, n) those (N, count, n) whose hands are nearest to what is asked for."""
    X = chain.motions(bank)[-1] @ chain.home
    away = np.linalg.norm(p[:, None] - X[None, :, :3, 3], axis=-1)
    turned = np.arccos(np.clip(z @ X[:, :3, 2].T, -1.0, 1.0))
    order = np.argsort(away + 0.3 * turned, axis=1)[:, :count]
    return np.asarray(bank[order])
