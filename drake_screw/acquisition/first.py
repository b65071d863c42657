"""Where the first demonstration is asked for, before anything is known."""

from __future__ import annotations

from itertools import product
from typing import Literal, assert_never

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.tasks import WorkArea
from drake_screw.typing import Array

First = Literal["random", "middle", "farthest"]
"""Anywhere in the work area, in its middle, or at its corner farthest from the arm's shoulder."""


def first_place(first: First, area: WorkArea, p_WS: ArrayLike) -> Array:
    """What is settled about the place of the first demonstration.

    Args:
        first: how it is chosen.
        area: the work area.
        p_WS: (3,) m, the arm's shoulder in the world; (A, 3) of several arms, of which the one
            whose shoulder is nearest counts at every corner.

    Returns:
        (k, c) coordinates of each object; NaN what is drawn at random.
    """
    match first:
        case "random":
            return np.full(area.lower.shape, np.nan)
        case "middle":
            return area.middle
        case "farthest":
            return _farthest(area, np.reshape(np.asarray(p_WS, dtype=float), (-1, 3)))
        case _:
            assert_never(first)


def _farthest(area: WorkArea, p_WS: Array) -> Array:
    """Of each object the corner of its x, y farthest from the nearest of the shoulders (A, 3).

    The rest, and of what stands on another object all, is drawn.
    """
    place = np.full(area.lower.shape, np.nan)
    for i, (lower, upper) in enumerate(zip(area.lower, area.upper, strict=True)):
        if area.objects[i].on is not None:
            continue
        corners = np.array(list(product(*zip(upper[:2], lower[:2], strict=True))))
        away = np.linalg.norm(corners[:, None] - p_WS[:, :2], axis=-1).min(axis=1)
        place[i, :2] = corners[int(away.argmax())]
    return place
