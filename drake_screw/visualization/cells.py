"""The regions of a work area seen along two of its axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.tasks import ANGLES, Regions, WorkArea
from drake_screw.typing import Array

Axis = tuple[int, int]
"""An object and one of its axes, by number."""

Axes = tuple[Axis, Axis]
"""Those of a picture: up or down it, and sideways."""


@dataclass(frozen=True, eq=False)
class Cells:
    """The regions as cells in a plane of two axes, usually x and y of one object.

    Where several regions lie above one another (other yaws, other places of other objects) a cell
    stands for the one with the largest estimate. It is as small as the smallest of them.

    Attributes:
        area: the work area.
        axes: of the plane.
        lower, upper: (c, 2) corners of the cells, m or rad.
        region: (c,) the region that each cell stands for.
        mean: (c,) estimates of all regions above one another, each by its share of the work area;
            NaN where there is none.
        outlines: (K, 2, 2) lower and upper corner of each region in the plane.
        stack: how many regions lie above one another, at most.
    """

    area: WorkArea
    axes: Axes
    lower: Array
    upper: Array
    region: NDArray[np.int64]
    mean: Array
    outlines: Array
    stack: int

    @property
    def object(self) -> int:
        """Index of the object whose axis is drawn up or down."""
        return self.axes[0][0]

    @property
    def from_above(self) -> bool:
        """Whether the plane is x, y of one object."""
        (i, x), (j, y) = self.axes
        return i == j and (x, y) == (0, 1)

    @property
    def in_world(self) -> bool:
        """Whether it is, besides, the world's plane, where robot and obstacles are."""
        return self.from_above and self.area.objects[self.object].on is None

    def place(self, coordinates: ArrayLike) -> Array:
        """Where instances are in the plane; (..., k, c) to (..., 2)."""
        (i, a), (j, b) = self.axes
        given = np.asarray(coordinates, dtype=float)
        return np.stack([given[..., i, a], given[..., j, b]], axis=-1)

    def place_of(self, X_WO: ArrayLike) -> Array:
        """Where object poses (..., k, 4, 4) are in the plane; (..., 2)."""
        return self.place(self.area.coordinates(X_WO))

    def label(self, which: int) -> str:
        """An axis of the plane in words, with its unit."""
        _, axis = self.axes[which]
        unit = "rad" if self.area.axes[axis] in ANGLES else "m"
        return f"{axis_name(self.area, self.axes[which])} in {unit}"

    @property
    def others(self) -> tuple[str, ...]:
        """Names of the axes along which the work area extends beyond the plane."""
        free = [(int(i), int(j)) for i, j in np.argwhere(self.area.free)]
        return tuple(axis_name(self.area, axis) for axis in free if axis not in self.axes)


def axis_name(area: WorkArea, axis: Axis) -> str:
    """In words: with the object's name where there are several."""
    i, j = axis
    return f"{area.objects[i].name} {area.axes[j]}" if len(area.objects) > 1 else area.axes[j]


def table_axes(area: WorkArea) -> Axes:
    """x, y of the first object that may move in both, one that stands in the world if there is."""
    moves = area.free[:, :2].all(axis=1)
    stands = np.array([item.on is None for item in area.objects])
    drawn = int((2 * moves + stands).argmax()) if moves.any() else 0
    return (drawn, 0), (drawn, 1)


def usual_axes(area: WorkArea) -> Axes:
    """The axes of a picture, unless others are chosen: `table_axes`, or the first two that vary."""
    free = [(int(i), int(j)) for i, j in np.argwhere(area.free)]
    if area.free[:, :2].all(axis=1).any() or len(free) < 2:
        return table_axes(area)
    metric = sorted(free, key=lambda axis: area.axes[axis[1]] in ANGLES)
    return metric[0], metric[1]


def cells(regions: Regions, estimates: NDArray[np.float64], axes: Axes | None = None) -> Cells:
    """Project regions onto a plane.

    The outlines of two regions must be the same, or apart, or one within the other, and none may
    be covered but for a part by others within it; those of a grid and of a dyadic tree are so.

    Args:
        regions: of the work area.
        estimates: (K,) failure probability, NaN where unknown.
        axes: of the plane; `usual_axes` if None.
    """
    area = regions.area
    axes = usual_axes(area) if axes is None else axes
    objects, columns = np.array(axes).T
    outlines = np.stack(regions.bounds(np.arange(regions.K)), axis=1)[:, :, objects, columns]
    _, first = np.unique(outlines, axis=0, return_index=True)
    tiles = outlines[np.sort(first)]
    tiles = tiles[[np.count_nonzero(_covers(tile, tiles)) == 1 for tile in tiles]]
    above = np.array([_covers(outlines, tile) for tile in tiles])
    worst = np.where(above, np.nan_to_num(estimates, nan=-1.0), -2.0).argmax(axis=1)
    stack = int(above.sum(axis=1).max())
    mean = _mean(above, np.asarray(estimates, dtype=float), regions.shares / _extent(outlines))
    return Cells(area, axes, tiles[:, 0], tiles[:, 1], worst, mean, outlines, stack)


def _mean(above: NDArray[np.bool_], estimates: Array, density: Array) -> Array:
    """(c,) estimates of the regions above each cell (c, K), by their share over their outline."""
    weight = above * np.where(np.isnan(estimates), 0.0, density)
    total = weight.sum(axis=1)
    sums = weight @ np.nan_to_num(estimates, nan=0.0)
    return np.where(total > 0.0, sums / np.where(total > 0.0, total, 1.0), np.nan)


def _extent(outlines: Array) -> Array:
    """(K,) how large outlines are; along an axis that is fixed, as if it were 1 wide."""
    sides = outlines[:, 1] - outlines[:, 0]
    return np.asarray(np.where(sides > 0.0, sides, 1.0).prod(axis=1))


def _covers(outer: Array, inner: Array) -> NDArray[np.bool_]:
    """Whether rectangles (..., 2, 2) of lower and upper corner cover others (..., 2, 2)."""
    slack = 1e-9
    lower = outer[..., 0, :] <= inner[..., 0, :] + slack
    return np.all(lower & (outer[..., 1, :] >= inner[..., 1, :] - slack), axis=-1)
