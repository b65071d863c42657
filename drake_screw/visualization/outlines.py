"""Solid things seen from one side: the outline of what is convex."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.patches import Patch, Polygon
from matplotlib.patheffects import withStroke
from numpy.typing import ArrayLike

from drake_screw.robot import ObstacleConfig
from drake_screw.typing import Array
from drake_screw.visualization.palette import INK, PAPER

ABOVE = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Takes a point in W to its x, y."""

BESIDE = 0.15
"""m, how far beyond a picture's own things it shows others."""

_LOOK = {
    "facecolor": to_rgba(PAPER, 0.45),
    "edgecolor": INK,
    "hatch": "////",
    "linewidth": 1.2,
    "path_effects": [withStroke(linewidth=3.0, foreground=PAPER)],
}


@dataclass(frozen=True, eq=False)
class Outline:
    """What is seen of a thing: its name, and corners (v, 2) in m, one after the other around it."""

    name: str
    corners: Array


def outlines(obstacles: Sequence[ObstacleConfig], P: ArrayLike = ABOVE) -> tuple[Outline, ...]:
    """What is seen of obstacles.

    Args:
        obstacles: any.
        P: (2, 3) takes a point in W to the plane of the picture.

    Raises:
        ModelError: a mesh cannot be read.
    """
    P = np.asarray(P, dtype=float)
    return tuple(Outline(o.name, convex_outline(o.shape.corners() @ P.T)) for o in obstacles)


def widened(
    lower: Array, upper: Array, things: Sequence[Outline], beside: float = BESIDE
) -> tuple[Array, Array]:
    """Corners (2,) of a picture from `lower` to `upper`, widened for things at most so far off."""
    for thing in things:
        low, high = thing.corners.min(axis=0), thing.corners.max(axis=0)
        if (low < upper + beside).all() and (high > lower - beside).all():
            lower = np.minimum(lower, np.maximum(low, lower - beside))
            upper = np.maximum(upper, np.minimum(high, upper + beside))
    return lower, upper


def draw_outlines(ax: Axes, things: Sequence[Outline], *, text: bool = True) -> None:
    """Draw things seen from above, hatched, into axes with y to the right and x downwards.

    Args:
        ax: with its limits set.
        things: what is outside of the limits is cut off.
        text: write their names.
    """
    lower, upper = np.sort([ax.get_ylim(), ax.get_xlim()], axis=1).T
    for thing in things:
        patch = Polygon(thing.corners[:, ::-1], zorder=4, gid=f"obstacle {thing.name}", **_LOOK)
        ax.add_patch(patch)
        seen = np.clip(thing.corners, lower, upper)
        low, high = seen.min(axis=0), seen.max(axis=0)
        if text and (high > low).all():
            halo = [withStroke(linewidth=2.5, foreground=PAPER)]
            style = {"ha": "center", "va": "center", "fontsize": 8, "color": INK, "zorder": 6.5}
            x, y = (low + high) / 2.0
            ax.text(y, x, thing.name, path_effects=halo, clip_on=True, **style)


def outline_handle() -> Patch:
    """The entry of a legend for what `draw_outlines` draws."""
    return Patch(**_LOOK, label="obstacle")


def convex_outline(points: ArrayLike) -> Array:
    """Corners (v, 2) of the convex hull of points (n, 2), anticlockwise; two if it is a line.

    Andrew's monotone chain: unlike Qhull it takes points that are all on one line.

    >>> convex_outline([[0, 0], [2, 0], [1, 0], [2, 2], [1, 1], [0, 2]]).astype(int).tolist()
    [[0, 0], [2, 0], [2, 2], [0, 2]]
    """
    points = np.unique(np.asarray(points, dtype=float), axis=0)
    if len(points) < 3:
        return points
    return np.array(_side(points)[:-1] + _side(points[::-1])[:-1])


def _side(points: Array) -> list[Array]:
    """One half of the hull, from the first of the sorted points to the last."""
    found: list[Array] = []
    for p in points:
        while len(found) > 1 and _turn(found[-2], found[-1], p) <= 0.0:
            found.pop()
        found.append(p)
    return found


def _turn(a: Array, b: Array, c: Array) -> float:
    u, v = b - a, c - b
    return float(u[0] * v[1] - u[1] * v[0])
