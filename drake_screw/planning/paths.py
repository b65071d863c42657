"""Joint paths of many plans at once, where the batch planner answers outcomes only.

Each path solves the reference planner's equation, dq/ds = J(q)^+ V along a constant screw, by the
classical Runge-Kutta method. All instances of one demonstration take their steps together, as many
in a segment as the largest motion among them asks for; every step aims anew at the guiding pose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning.contract import POSITION_TOLERANCE, hand_motion
from drake_screw.robot import ScrewChain
from drake_screw.screws import inverse, log, shift, translation_distance
from drake_screw.screws.rotations import cross, skew
from drake_screw.typing import Array

STEP = 0.08
"""Hand motion in one step, rad and (divided by CHARACTERISTIC_LENGTH) m together."""

REFINEMENT = 8
"""Into how many parts a step is divided where a path missed its guiding poses."""


@dataclass(frozen=True, eq=False)
class Paths:
    """Joint paths of N plans with one demonstration, m points each.

    Attributes:
        q: (N, m, n) rad or m, from the start configuration to the last guiding pose.
        segment: (m,) the segment each point lies in, from 0.
        s: (m,) how far along that segment, 0 to 1.
    """

    q: Array
    segment: NDArray[np.int64]
    s: Array


class Frames:
    """Where an arm's links are for many configurations: a product of exponentials, batched.

    For a unit twist exp(S q) is a polynomial in the matrix S with coefficients that depend on q
    only (Modern Robotics, eq. 3.51 and 3.88), so all joints take one matrix product.
    """

    def __init__(self, chain: ScrewChain) -> None:
        self.chain = chain
        S = np.zeros((chain.n, 4, 4))
        S[:, :3, :3], S[:, :3, 3] = skew(chain.screws[:, :3]), chain.screws[:, 3:]
        powers = np.stack([np.broadcast_to(np.eye(4), S.shape), S, S @ S, S @ S @ S], axis=1)
        self._powers = powers.reshape(chain.n, 4, 16)

    def __call__(self, q: ArrayLike) -> Array:
        """exp(S_1 q_1) ... exp(S_i q_i) for every i; (N, n) to (n, N, 4, 4)."""
        angle = np.asarray(q, dtype=float).T
        one = np.ones_like(angle)
        c = np.stack([one, angle, 1.0 - np.cos(angle), angle - np.sin(angle)], axis=-1)
        E = (c @ self._powers).reshape(*angle.shape, 4, 4)
        for i in range(1, len(E)):
            E[i] = E[i - 1] @ E[i]
        return E

    def pose(self, q: ArrayLike) -> Array:
        """X_WE; (N, n) to (N, 4, 4)."""
        return np.asarray(self(q)[-1] @ self.chain.home)

    def jacobian(self, q: ArrayLike) -> Array:
        """Spatial Jacobian about W's origin; (N, n) to (N, 6, n)."""
        E = self(q)
        before = np.concatenate([np.broadcast_to(np.eye(4), E[:1].shape), E[:-1]])
        R, p = before[..., :3, :3], before[..., :3, 3]
        w = (R @ self.chain.screws[:, None, :3, None])[..., 0]
        v = (R @ self.chain.screws[:, None, 3:, None])[..., 0] + cross(p, w)
        return np.moveaxis(np.concatenate([w, v], axis=-1), 0, -1)


def joint_paths(
    frames: Frames, demonstration: Demonstration, X_WO: ArrayLike, q_start: ArrayLike
) -> Paths:
    """Joint paths of instances that a demonstration solves.

    Limits are not looked at: that these plans succeed is known. Where a path passes a near-singular
    pose and misses a guiding pose by more than plans may, it is computed again in smaller steps.

    Args:
        frames: of the arm.
        demonstration: to plan with.
        X_WO: (N, k, 4, 4) object poses of the instances.
        q_start: (n,) rad or m.
    """
    guides = demonstration.transfer(X_WO)
    q, segment, s, missed = _follow(frames, guides, np.asarray(q_start, dtype=float), 1)
    if missed.any():
        steps = np.bincount(segment[1:], minlength=guides.shape[1])
        q[missed] = _follow(frames, guides[missed], q[0, 0], REFINEMENT, steps)[0]
    return Paths(q, segment, s)


def _follow(
    frames: Frames, guides: Array, q_start: Array, parts: int, counts: Array | None = None
) -> tuple[Array, NDArray[np.int64], Array, Array]:
    """Paths through guiding poses (N, g, 4, 4), each step in so many parts; and which missed."""
    q = np.tile(q_start, (len(guides), 1))
    points, segments, fractions = [q], [0], [0.0]
    missed = np.zeros(len(guides), dtype=bool)
    for segment in range(guides.shape[1]):
        X_WG = guides[:, segment]
        steps = _steps(X_WG, frames.pose(q)) if counts is None else int(counts[segment])
        left = steps * parts
        for step in range(steps):
            for _ in range(parts):
                V = log(X_WG @ inverse(frames.pose(q))) / left
                q, left = _runge_kutta(frames, q, V), left - 1
            points.append(q)
            segments.append(segment)
            fractions.append((step + 1) / steps)
        missed |= ~(translation_distance(frames.pose(q), X_WG) <= POSITION_TOLERANCE)
    return np.stack(points, axis=1), np.array(segments), np.array(fractions), missed


def _steps(X_WG: Array, X_WE: Array) -> int:
    size = hand_motion(shift(log(X_WG @ inverse(X_WE)), X_WE[:, :3, 3]))
    return max(2, int(np.ceil(size.max(initial=0.0) / STEP)))


def _runge_kutta(frames: Frames, q: Array, V: Array) -> Array:
    k1 = _rates(frames, q, V)
    k2 = _rates(frames, q + k1 / 2, V)
    k3 = _rates(frames, q + k2 / 2, V)
    k4 = _rates(frames, q + k3, V)
    return q + (k1 + 2 * k2 + 2 * k3 + k4) / 6


def _rates(frames: Frames, q: Array, V: Array) -> Array:
    """J^+ V for twists V (N, 6) about W's origin: the least joint rates."""
    J = frames.jacobian(q)
    Jt = np.swapaxes(J, -1, -2)
    return np.asarray((Jt @ np.linalg.solve(J @ Jt, V[..., None]))[..., 0])
