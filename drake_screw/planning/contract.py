"""Numbers that define what a successful plan is, shared by all planners."""

from __future__ import annotations

from typing import Literal

import numpy as np

from drake_screw.typing import Array

POSITION_TOLERANCE = 1e-4
"""m. A segment ends at most this far from its guiding pose."""

ROTATION_TOLERANCE = 1e-3
"""rad. A segment ends at most this far turned from its guiding pose."""

CHARACTERISTIC_LENGTH = 1.0
"""m. What counts as much as a radian when an end effector's twist is given a size."""

RATE_LIMIT = 100.0
"""Joint motion for a unit of end-effector motion at which a pose is called unreachable.

Both are Euclidean norms: of joint velocities, and `motion_size`. It bounds the inverse of the
Jacobian's least singular value along the motion's twist.
"""

RESIDUAL_LIMIT = 1e-2
"""Part of a segment's end-effector motion that the joints cannot give at which a pose is
unreachable.

It is what J dq/ds lacks of the twist, times what is left of the segment, in RATE_LIMIT's measure of
end-effector motion: at a singularity, or wherever an arm of fewer than six joints is asked for a
motion that it does not have. Towards the segment's end, where next to nothing is left to move, it
is the tolerances that count.
"""

ORIENTATION_MIN = 1e-14
"""det(J^T J') at two points of a path is negative if it is below minus this, and not by rounding.

With six joints or fewer that means that the path leads through a singularity in between.
"""

Task = Literal["pose", "position_and_axis"]
"""What is followed: the end effector's pose, or its origin and one of its axes, about which its
roll is free then (see `roll`)."""

STILL = 1e-6
"""rad. Size that a segment has at least in which the roll is free: one that only rolls has none."""

Redundancy = Literal["least_norm", "away_from_limits"]
"""What more joints than six, or than five where the roll is free, do with the motion that the end
effector leaves free: none of it, or away from the joint limits (`away_from_limits`)."""

CENTRING = 1.0
"""Joint motion away from limits, for a unit of the joint motion that the end effector needs."""

FREE_PART = 1.0 / 3.0
"""Part of a joint's range, about its middle, in which nothing draws it."""

SOFTNESS = 0.05
"""How far behind a joint limit the pull away from it would be infinite, about: 1 - x^2 there."""


def motion_size(V_WE: Array) -> Array:
    """Size of spatial velocities: sqrt(turn^2 + (travel / CHARACTERISTIC_LENGTH)^2).

    Args:
        V_WE: (..., 6) as [w; v], rad and m.

    Returns:
        (...) rad.
    """
    turn, travel = np.linalg.norm(V_WE[..., :3], axis=-1), np.linalg.norm(V_WE[..., 3:], axis=-1)
    return np.hypot(turn, travel / CHARACTERISTIC_LENGTH)


def middle_and_half(lower: Array, upper: Array) -> tuple[Array, Array]:
    """The middle and half the extent of joint ranges (n,); 0 and inf for a joint without limits."""
    limited = np.isfinite(lower) & np.isfinite(upper) & (lower < upper)
    below, above = np.where(limited, lower, 0.0), np.where(limited, upper, 0.0)
    return (below + above) / 2.0, np.where(limited, (above - below) / 2.0, np.inf)


def away_from_limits(velocities: Array, q: Array, lower: Array, upper: Array) -> Array:
    """The joint motion z (n,) that is wanted where the end effector needs `velocities` J^+ V (n,).

    With x in [-1, 1] the place of a joint in its range,
    z = -CENTRING |J^+ V| sign(x) max(|x| - FREE_PART, 0) / max(1 + SOFTNESS - x^2, SOFTNESS):
    nothing in the middle third, and steeper the nearer the limit. It ends where the motion ends.
    """
    middle, half = middle_and_half(lower, upper)
    x = (q - middle) / half
    beyond = np.maximum(np.abs(x) - FREE_PART, 0.0) * np.sign(x)
    pull = beyond / np.maximum(1.0 + SOFTNESS - x * x, SOFTNESS)
    return -CENTRING * np.linalg.norm(velocities) * pull
