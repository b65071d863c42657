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
        (k, c) coordinates of each object; NaN what is drawn at random.
    """
    match first:
        case "random":
            return np.full(area.lower.shape, np.nan)
        case "middle":
            return area.curved((area.flat(area.lower) + area.flat(area.upper)) / 2.0)
        case "farthest":
            return _farthest(area, p_WS)
        case _:
            assert_never(first)


def _farthest(area: WorkArea, p_WS: Array) -> Array:
    """Of each object the corner of its x, y farthest from p_WS; the rest, and of what stands on
    another object all, is drawn."""
    lower, upper = area.lower[:, :2], area.upper[:, :2]
    away = np.abs(upper - p_WS[:2]) >= np.abs(lower - p_WS[:2])
    place = np.full(area.lower.shape, np.nan)
    place[:, :2] = np.where(away, upper, lower)
    place[[item.on is not None for item in area.objects]] = np.nan
    return place
