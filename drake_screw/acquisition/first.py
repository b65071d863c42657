"""Where the first demonstration is asked for, before anything is known."""

from __future__ import annotations

from typing import Literal, assert_never

import numpy as np

from drake_screw.tasks import WorkArea
from drake_screw.typing import Array

First = Literal["random", "middle", "farthest"]
"""Anywhere in the work area, in its middle, or at its corner farthest from the arm's shoulder."""


def first_place(first: First, area: WorkArea, p_WS: Array) -> Array:
    """What is settled about the place of the first demonstration.

    Args:
        first: how it is chosen.
        area: the work area.
        p_WS: (3,) m, the arm's shoulder in the world.

    Returns:
        (k, 3) x, y in m and yaw in rad of each object; NaN what is drawn at random.
    """
    match first:
        case "random":
            return np.full(area.lower.shape, np.nan)
        case "middle":
            return (area.lower + area.upper) / 2.0
        case "farthest":
            return _farthest(area, p_WS)
        case _:
            assert_never(first)


def _farthest(area: WorkArea, p_WS: Array) -> Array:
    """Of each object the corner of its x, y farthest from p_WS; its height is the same in all."""
    away = np.abs(area.upper - p_WS[[0, 1, 0]]) >= np.abs(area.lower - p_WS[[0, 1, 0]])
    place = np.where(away, area.upper, area.lower)
    place[:, 2] = np.nan
    return place
