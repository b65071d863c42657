"""Where a camera has to stand so that all there is to see is in the picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.typing import Array

HALF_HEIGHT = np.tan(np.deg2rad(75.0 / 2.0))
"""Of a picture at distance 1: Meshcat's camera sees 75 degrees upwards and downwards together."""
NARROW = 0.85
"""Width by height of the narrowest picture that is to hold everything."""
FILLED = 0.86
"""How much of a picture's width and height may be filled."""


def camera_pose(points: ArrayLike, back: ArrayLike, pivot: ArrayLike) -> tuple[Array, Array]:
    """The nearest place of the camera from which all points are seen.

    Each point p must lie within a cone on either axis a of the picture: |a.(p - c)| <= t u.(c - p),
    where u leads back to the camera c, and t is half the picture's size at distance 1. With the
    largest of u.p + a.p / t and of u.p - a.p / t over all points that is solved in closed form.

    Args:
        points: (n, 3) m, to be seen.
        back: (3,) from what is seen to the camera; not straight up.
        pivot: (3,) m, as deep in the picture as what the camera is turned about.

    Returns:
        Where the camera is, and what it looks at; (3,) m each.

    >>> at, target = camera_pose([[0, -1, 0], [0, 1, 0]], [1, 0, 0], [0, 0, 0])
    >>> at.round(3).tolist(), target.round(3).tolist()
    ([1.783, 0.0, 0.0], [0.0, 0.0, 0.0])
    """
    p = np.asarray(points, dtype=float)
    u = np.asarray(back, dtype=float) / np.linalg.norm(back)
    right = np.cross([0.0, 0.0, 1.0], u)
    right /= np.linalg.norm(right)
    up = np.cross(u, right)
    deep = p @ u
    x, far_x = _between(p @ right, deep, HALF_HEIGHT * NARROW * FILLED)
    y, far_y = _between(p @ up, deep, HALF_HEIGHT * FILLED)
    far = max(far_x, far_y)
    at = x * right + y * up + far * u
    return at, at - (far - float(np.asarray(pivot, dtype=float) @ u)) * u


def _between(across: Array, deep: Array, t: float) -> tuple[float, float]:
    """Where the camera stands across and how far back, for one axis of the picture."""
    most, least = float((deep + across / t).max()), float((deep - across / t).max())
    return t * (most - least) / 2.0, (most + least) / 2.0
