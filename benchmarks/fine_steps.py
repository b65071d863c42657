"""The reference planner's method in numpy, on many plans at once.

`ReferencePlanner` defines the answers but takes a tenth of a second for a plan. This does the same
steps from the arm's screws, all plans together, and stands in for it once `planner.py --agreement`
has seen the two agree on a sample.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drake_screw.planning import Cause
from drake_screw.planning.contract import (
    ORIENTATION_MIN,
    POSITION_TOLERANCE,
    RATE_LIMIT,
    RESIDUAL_LIMIT,
    ROTATION_TOLERANCE,
    motion_size,
)
from drake_screw.robot import ScrewChain
from drake_screw.screws import inverse, log, pose, rotation_angle, shift, translation_distance
from drake_screw.screws.rotations import cross, skew
from drake_screw.typing import Array


@dataclass(frozen=True)
class FineOutcomes:
    """Answers to P plans.

    Attributes:
        cause, segment, joint: (P,) as in `Outcomes`.
        margin: (P,) rad or m, the least distance to a joint limit on the way.
        rate: (P,) the largest joint rate per unit of end-effector motion on the way.
    """

    cause: Array
    segment: Array
    joint: Array
    margin: Array
    rate: Array


class Kinematics:
    """End-effector pose and Jacobian of an arm of at least six joints, for many configurations."""

    def __init__(self, chain: ScrewChain) -> None:
        if chain.n < 6:
            raise ValueError("the fine steps are for arms of at least six joints")
        self.home = chain.home
        self.screws = chain.screws
        self.turns = np.linalg.norm(chain.screws[:, :3], axis=1) > 0.5
        self.points = cross(chain.screws[:, :3], chain.screws[:, 3:])

    def __call__(self, q: Array) -> tuple[Array, Array]:
        """q (M, n) to X_WE (M, 4, 4) and J (M, 6, n), twists about W's origin."""
        R, p = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
        J = np.empty((len(q), 6, q.shape[1]))
        for i, S in enumerate(self.screws):
            w = R @ S[:3]
            J[:, :3, i], J[:, 3:, i] = w, R @ S[3:] + cross(p, w)
            if self.turns[i]:
                K = skew(S[:3])
                s, c = np.sin(q[:, i, None, None]), np.cos(q[:, i, None, None])
                Q = np.eye(3) + s * K + (1.0 - c) * (K @ K)
                p = p + (R @ (self.points[i] - Q @ self.points[i])[..., None])[..., 0]
                R = R @ Q
            else:
                p = p + q[:, i, None] * (R @ S[3:])
        return pose(R, p) @ self.home, J


def rates(J: Array, V: Array) -> tuple[Array, Array]:
    """J^+ V (M, n) and V - J J^+ V (M, 6)."""
    y = np.linalg.solve(J @ np.swapaxes(J, -1, -2) + 1e-18 * np.eye(6), V[..., None])
    dq = np.swapaxes(J, -1, -2) @ y
    return dq[..., 0], V - (J @ dq)[..., 0]


def fine_outcomes(
    chain: ScrewChain,
    q_start: Array,
    guides: Sequence[Array],
    *,
    step: float = 0.04,
    joint_step: float = 0.02,
    slack: float = 0.0,
    rate_limit: float = RATE_LIMIT,
) -> FineOutcomes:
    """Plan P sequences of guiding poses (g, 4, 4) each.

    Args:
        chain: an arm of at least six joints.
        q_start: (n,) rad or m.
        guides: P of them.
        step, joint_step: as in `ReferencePlanner`.
        slack: rad or m by which all joint limits are further out.
        rate_limit: in place of RATE_LIMIT.
    """
    arm = Kinematics(chain)
    lower, upper = chain.lower - slack, chain.upper + slack
    P, count = len(guides), np.array([len(g) for g in guides])
    X_WG = np.stack([np.resize(g, (count.max(), 4, 4)) for g in guides])
    q = np.tile(np.asarray(q_start, dtype=float), (P, 1))
    s, size, segment = np.zeros(P), np.zeros(P), np.zeros(P, dtype=int)
    out = FineOutcomes(
        np.full(P, Cause.SUCCESS, dtype=int),
        np.full(P, -1),
        np.full(P, -1),
        np.full(P, np.inf),
        np.zeros(P),
    )
    live = np.arange(P)
    while len(live):
        X_WE, J = arm(q[live])
        goal = X_WG[live, segment[live]]
        V = log(goal @ inverse(X_WE)) / (1.0 - s[live])[:, None]
        size[live] = np.where(s[live] == 0.0, motion_size(shift(V, X_WE[:, :3, 3])), size[live])
        k1, rest = rates(J, V)
        rate = np.linalg.norm(k1, axis=1)
        ratio = rate / np.maximum(size[live], 1e-12)
        out.rate[live] = np.maximum(out.rate[live], ratio)
        stuck = rate > rate_limit * size[live]
        stuck |= (
            motion_size(shift(rest, X_WE[:, :3, 3])) * (1.0 - s[live]) > RESIDUAL_LIMIT * size[live]
        )
        live = _end(out, live, segment, stuck, Cause.UNREACHABLE)
        V, k1, rate = V[~stuck], k1[~stuck], rate[~stuck]
        if not len(live):
            break
        h = np.minimum(step / np.maximum(size[live], 1e-12), joint_step / np.maximum(rate, 1e-12))
        h = np.minimum(h, 1.0 - s[live])
        before, h1 = q[live], h[:, None]
        k2 = rates(arm(before + h1 / 2 * k1)[1], V)[0]
        k3 = rates(arm(before + h1 / 2 * k2)[1], V)[0]
        k4 = rates(arm(before + h1 * k3)[1], V)[0]
        q[live] = before + h1 / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        s[live] += h
        if chain.n == 6:
            turned = np.linalg.det(arm(before)[1]) * np.linalg.det(arm(q[live])[1])
            passes = turned < -ORIENTATION_MIN
            live, before = _end(out, live, segment, passes, Cause.UNREACHABLE), before[~passes]
        live = _limits(out, live, segment, before, q, lower, upper)
        arrived = live[1.0 - s[live] < 1e-9]
        if len(arrived):
            missed = ~_corrected(arm, q, arrived, X_WG[arrived, segment[arrived]])
            _end(out, arrived, segment, missed, Cause.UNREACHABLE)
            s[arrived], segment[arrived] = 0.0, segment[arrived] + 1
            over = (out.cause[arrived] != Cause.SUCCESS) | (segment[arrived] == count[arrived])
            live = np.setdiff1d(live, arrived[over])
    return out


def _end(out: FineOutcomes, live: Array, segment: Array, which: Array, cause: Cause) -> Array:
    """Record the failures among the plans at work; those that go on."""
    out.cause[live[which]], out.segment[live[which]] = cause, segment[live[which]]
    return live[~which]


def _limits(
    out: FineOutcomes,
    live: Array,
    segment: Array,
    before: Array,
    q: Array,
    lower: Array,
    upper: Array,
) -> Array:
    """Record the joint limits that a step has met; the plans that go on."""
    old, new = (np.minimum(x - lower, upper - x) for x in (before, q[live]))
    out.margin[live] = np.minimum(out.margin[live], new.min(axis=1))
    crossing = np.where(new <= 0.0, old / np.where(new <= 0.0, old - new, 1.0), np.inf)
    met = (new <= 0.0).any(axis=1)
    out.joint[live[met]] = np.argmin(crossing[met], axis=1)
    return _end(out, live, segment, met, Cause.JOINT_LIMIT)


def _corrected(arm: Kinematics, q: Array, arrived: Array, goal: Array) -> Array:
    """Newton's method onto the guiding poses; whether they are met within the tolerances."""
    for _ in range(3):
        X_WE, J = arm(q[arrived])
        q[arrived] += rates(J, log(goal @ inverse(X_WE)))[0]
    X_WE = arm(q[arrived])[0]
    return (translation_distance(X_WE, goal) <= POSITION_TOLERANCE) & (
        rotation_angle(X_WE, goal) <= ROTATION_TOLERANCE
    )
