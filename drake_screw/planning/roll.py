"""What is left of following a pose where the roll about an axis of the hand is free.

The end effector's origin and that axis follow the recorded screw; how far the hand is turned about
the axis, its roll, is whatever the joints make of it. Of two poses that agree in origin and axis
one is the other one rolled, so that the recorded motion, rolled by where the hand is, is again one
screw, and carries origin and axis along just the same.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.screws import inverse, pose, rotation_angle
from drake_screw.typing import Array


def free_frame(axis: ArrayLike) -> Array:
    """X_EF (4, 4): a frame at the end effector's origin whose z axis is the free one.

    Args:
        axis: (3,) in E, of any length but 0.
    """
    z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    x = np.cross(np.eye(3)[2 - np.abs(z)[::-1].argmin()], z)
    x /= np.linalg.norm(x)
    return pose(np.stack([x, np.cross(z, x), z], axis=-1), np.zeros(3))


def along_roll_free(X_WF: Array) -> Array:
    """(..., 5, 6) the directions that count, of twists [w; v] in W about F's origin.

    They are the turns about F's x and y axis, and the shifts along those of W.
    """
    P = np.zeros((*X_WF.shape[:-2], 5, 6))
    P[..., :2, :3] = np.swapaxes(X_WF[..., :3, :2], -1, -2)
    P[..., 2:, 3:] = np.eye(3)
    return P


def rolled(X_WF: Array, X_WS: Array, X_WG: Array) -> Array:
    """Poses X_WG (..., 4, 4), rolled about their z axes as F is with respect to S.

    That roll is the one which takes S nearest to F.
    """
    c, s = _roll(X_WS, X_WF)
    found = np.array(X_WG)
    x, y = X_WG[..., :3, 0], X_WG[..., :3, 1]
    found[..., :3, 0], found[..., :3, 1] = c * x + s * y, c * y - s * x
    return found


def turned_along(X_WE: Array, X_WS: Array, free_axis: ArrayLike | None) -> Array:
    """Set points X_WS (..., 4, 4) of the end effector, rolled as it is at X_WE (..., 4, 4).

    Args:
        X_WE, X_WS: the poses.
        free_axis: (3,) in E, about which the roll does not count; None where all of it does.
    """
    if free_axis is None:
        return X_WS
    X_EF = free_frame(free_axis)
    return rolled(X_WE @ X_EF, X_WS @ X_EF, X_WS @ X_EF) @ inverse(X_EF)


def axes_apart(X_WA: Array, X_WB: Array) -> Array:
    """Angles (...) in rad between the z axes of poses (..., 4, 4)."""
    a, b = X_WA[..., :3, 2], X_WB[..., :3, 2]
    return np.asarray(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.vecdot(a, b)))


def turned_apart(X_WA: Array, X_WB: Array, free_axis: ArrayLike | None) -> Array:
    """Angles (...) in rad between poses (..., 4, 4) of the end effector, as far as they count.

    Args:
        X_WA, X_WB: the poses.
        free_axis: (3,) in E, about which the roll does not count; None where all of it does.
    """
    if free_axis is None:
        return np.asarray(rotation_angle(X_WA, X_WB))
    X_EF = free_frame(free_axis)
    return axes_apart(X_WA @ X_EF, X_WB @ X_EF)


def _roll(X_WS: Array, X_WF: Array) -> tuple[Array, Array]:
    """cos and sin (..., 1) of the turn about z that takes poses S nearest to F."""
    R = np.swapaxes(X_WS[..., :3, :3], -1, -2) @ X_WF[..., :3, :3]
    angle = np.arctan2(R[..., 1, 0] - R[..., 0, 1], R[..., 0, 0] + R[..., 1, 1])[..., None]
    return np.cos(angle), np.sin(angle)
