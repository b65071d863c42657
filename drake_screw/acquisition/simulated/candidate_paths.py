"""Joint paths of an arm that a hand leads through key poses, many candidates at a time.

An arm whose weight is compensated follows the hand that leads its end effector, and its joints
move with the minimum norm: dq = J(q)^+ V. People lead it along nearly straight screws, and that
is what the key poses are joined by. The planner moves the arm by the same law, which is why what
can be led this way can nearly always be planned, too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.roll import along_roll_free, free_frame, turned_along, turned_apart
from drake_screw.robot import ScrewChain
from drake_screw.screws import (
    inverse,
    log,
    rotation_angle,
    sclerp,
    shift,
    translation_distance,
)
from drake_screw.typing import Array

STEP = 0.06  # rad, motion of the end effector in one step
METERS_PER_RADIAN = 0.5  # travel of the end effector that takes as many steps as a turn by a radian
DAMPING = 0.01
MAX_JOINT_STEP = 0.25  # rad in one step; beyond it nobody could lead the arm
ARRIVAL_TOLERANCE = (2e-3, 1e-2)  # m, rad


@dataclass(frozen=True, eq=False)
class CandidatePaths:
    """Joint paths of c candidates.

    Attributes:
        q: (c, m, n) rad or m.
        segment: (m,) the key pose, from 0, that each point leads to.
        arrived: (c,) whether it came to every key pose without passing near a singularity.
    """

    q: Array
    segment: NDArray[np.int64]
    arrived: NDArray[np.bool_]


def follow_key_poses(
    chain: ScrewChain,
    q_start: Array,
    X_WK: Array,
    stops: tuple[Array, Array],
    free_axis: Array | None = None,
) -> CandidatePaths:
    """Lead the arm from one key pose to the next along constant screws.

    Args:
        chain: the arm.
        q_start: (n,) rad or m.
        X_WK: (c, g, 4, 4) key poses of the end effector.
        stops: (n,) and (n,) where joints stop while the others move on; infinite of joints whose
            limits are not looked at.
        free_axis: (3,) in the end effector's frame, about which it rolls as the joints have it;
            None where it is led as a whole.

    Returns:
        The joint paths. They end early if no candidate is left.
    """
    count = len(X_WK)
    q = np.tile(np.asarray(q_start, dtype=float), (count, 1))
    X_WE, J = chain.pose_and_jacobian(q)
    points, segments, arrived = [q], [0], np.ones(count, dtype=bool)
    for segment in range(X_WK.shape[1]):
        led = segment == 0 or free_axis is None
        X_WA, X_WB = X_WE if led else X_WK[:, segment - 1], X_WK[:, segment]
        size = rotation_angle(X_WA, X_WB) + translation_distance(X_WA, X_WB) / METERS_PER_RADIAN
        steps = max(4, int(np.ceil(size.max() / STEP)))
        targets = sclerp(X_WA, X_WB, np.arange(1, steps + 1)[:, None] / steps)
        for target in targets:
            motion = _motion(*_asked(J, target, X_WE, free_axis), q, stops)
            near_singular = np.linalg.norm(motion, axis=-1) > MAX_JOINT_STEP
            arrived &= ~near_singular
            q = q + np.where(near_singular[:, None], 0.0, motion)
            X_WE, J = chain.pose_and_jacobian(q)
            points.append(q)
            segments.append(segment)
            if not arrived.any():
                return CandidatePaths(np.stack(points, axis=1), np.array(segments), arrived)
        arrived &= translation_distance(X_WE, X_WB) < ARRIVAL_TOLERANCE[0]
        arrived &= turned_apart(X_WE, X_WB, free_axis) < ARRIVAL_TOLERANCE[1]
    return CandidatePaths(np.stack(points, axis=1), np.array(segments), arrived)


def _asked(J: Array, target: Array, X_WE: Array, free_axis: Array | None) -> tuple[Array, Array]:
    """Jacobians (c, d, n) and twists (c, d) in the directions that the hand is led in."""
    V = log(turned_along(X_WE, target, free_axis) @ inverse(X_WE))
    if free_axis is None:
        return J, V
    p, P = X_WE[:, :3, 3], along_roll_free(X_WE @ free_frame(free_axis))
    J_WE = np.swapaxes(shift(np.swapaxes(J, -1, -2), p[:, None]), -1, -2)
    return P @ J_WE, (P @ shift(V, p)[..., None])[..., 0]


def _motion(J: Array, V: Array, q: Array, stops: tuple[Array, Array]) -> Array:
    """Joint motion (c, n) for twists V (c, d) from q (c, n); who comes to a stop is left behind."""
    motion, held = damped_joint_motion(J, V), np.zeros(q.shape, dtype=bool)
    room = stops[0] - q, stops[1] - q
    while True:
        beyond = ~held & ((motion < room[0]) | (motion > room[1]))
        if not beyond.any():
            return motion
        held |= beyond
        fixed = np.where(held, np.clip(motion, *room), 0.0)
        rest = V - (J @ fixed[..., None])[..., 0]
        free = damped_joint_motion(np.where(held[:, None], 0.0, J), rest)
        motion = np.where(held, fixed, free)


def damped_joint_motion(J: Array, V: Array) -> Array:
    """Minimum-norm joint motion for a twist, damped near singularities.

    dq = J^T (J J^T + damping^2 I)^-1 V: damped least squares (Nakamura and Hanafusa, Journal of
    Dynamic Systems, Measurement, and Control, 1986).

    Args:
        J: (..., d, n), of d directions.
        V: (..., d).

    Returns:
        (..., n) rad or m.
    """
    Jt = np.swapaxes(J, -1, -2)
    A = J @ Jt + DAMPING**2 * np.eye(J.shape[-2])
    return (Jt @ np.linalg.solve(A, V[..., None]))[..., 0]
