"""How far from its shoulder an arm can bring its wrist."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.robot.screw_chain import ScrewChain
from drake_screw.screws import inverse
from drake_screw.typing import Array

SAMPLES, POLISHED = 4096, 3


@dataclass(frozen=True, eq=False)
class Wrist:
    """The two points that an arm's reach lies between, C for the wrist's centre.

    Attributes:
        p_WS: (3,) m, the shoulder: the point of the first joint's axis nearest to the second's.
        p_EC: (3,) m, the wrist: the point of the last joint's axis nearest to the one before,
            which is fixed to the end effector E.
        least, most: m, between the two within the joint limits.
    """

    p_WS: Array
    p_EC: Array
    least: float
    most: float

    def centre(self, X_WE: ArrayLike) -> Array:
        """p_WC (..., 3) of end effector poses (..., 4, 4)."""
        X = np.asarray(X_WE, dtype=float)
        return X[..., :3, :3] @ self.p_EC + X[..., :3, 3]

    def distance(self, X_WE: ArrayLike) -> Array:
        """Distance (...) in m from shoulder to wrist at end effector poses (..., 4, 4)."""
        return np.linalg.norm(self.centre(X_WE) - self.p_WS, axis=-1)


def wrist_of(chain: ScrewChain) -> Wrist | None:
    """Shoulder, wrist and reach of an arm; None where a joint slides, or there are fewer than four.

    The reach is the extreme of a smooth function of the joints between, found from the best of
    many samples, the same ones every time.
    """
    if chain.n < 4 or (np.linalg.norm(chain.screws[:, :3], axis=1) < 0.5).any():
        return None
    p_WS = _foot(chain.screws[0], chain.screws[1], chain.home[:3, 3])
    p_WC = _foot(chain.screws[-1], chain.screws[-2], chain.home[:3, 3])
    X_EW = inverse(chain.home)
    p_EC = X_EW[:3, :3] @ p_WC + X_EW[:3, 3]
    ends = [abs(_extreme(chain, p_WS, p_EC, sign)) for sign in (1.0, -1.0)]
    return Wrist(p_WS, p_EC, *ends)


def _foot(S: Array, other: Array, near: Array) -> Array:
    """The point of a revolute axis nearest to another; the one nearest to `near` if parallel."""
    a, b = S[:3], other[:3]
    p, r = np.cross(a, S[3:]), np.cross(b, other[3:])
    n = np.cross(a, b)
    if np.linalg.norm(n) < 1e-6:
        return p + a * (a @ (near - p))
    return p + a * (np.cross(r - p, b) @ n / (n @ n))


def _extreme(chain: ScrewChain, p_WS: Array, p_EC: Array, sign: float) -> float:
    """The least of `sign` times the distance from shoulder to wrist."""
    from scipy.optimize import minimize  # takes long to import

    lower = np.where(np.isfinite(chain.lower), chain.lower, -np.pi)
    upper = np.where(np.isfinite(chain.upper), chain.upper, np.pi)
    p_WC0 = chain.home[:3, :3] @ p_EC + chain.home[:3, 3]

    def value(q: Array) -> tuple[float, Array]:
        motions = chain.motions(q[None])[-1, 0]
        p = motions[:3, :3] @ p_WC0 + motions[:3, 3]
        away = p - p_WS
        J = chain.jacobian(q)
        slope = (np.cross(J[:3].T, p) + J[3:].T) @ (2.0 * away)
        return sign * float(away @ away), sign * slope

    q = np.random.default_rng(0).uniform(lower, upper, (SAMPLES, chain.n))
    q[0] = np.clip(0.0, lower, upper)
    last = chain.motions(q)[-1]
    squares = ((last[:, :3, :3] @ p_WC0 + last[:, :3, 3] - p_WS) ** 2).sum(axis=-1)
    found = [
        minimize(value, start, jac=True, bounds=list(zip(lower, upper, strict=True))).fun
        for start in q[np.argsort(sign * squares, kind="stable")[:POLISHED]]
    ]
    return float(sign * np.sqrt(max(sign * min(found), 0.0)))
