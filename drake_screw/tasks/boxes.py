"""Partitions into boxes of different sizes, cut out of the unit box over the free axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.tasks.regions import ranges
from drake_screw.tasks.work_area import WorkArea
from drake_screw.typing import Array


@dataclass(frozen=True, eq=False)
class BoxRegions:
    """Boxes that together make up the work area and do not overlap.

    Attributes:
        area: the work area.
        lower, upper: (K, k, 3) corners; equal along axes that are fixed.
    """

    area: WorkArea
    lower: Array
    upper: Array

    @property
    def K(self) -> int:
        """Number of regions."""
        return len(self.lower)

    @property
    def shares(self) -> Array:
        """(K,) share of the work area that each region takes up."""
        free = free_axes(self.area)
        extent = (self.area.upper - self.area.lower)[free]
        return np.prod((self.upper - self.lower)[:, free] / extent, axis=1)

    def bounds(self, region: ArrayLike) -> tuple[Array, Array]:
        """Least and greatest x, y, yaw of regions; (...) to two arrays (..., k, 3)."""
        region = np.asarray(region)
        return self.lower[region], self.upper[region]

    def index(self, x_y_yaw: ArrayLike) -> NDArray[np.int64]:
        """The region of each instance, the nearest one if it lies outside the area.

        An instance on the border of two regions belongs to the upper one.

        Args:
            x_y_yaw: (..., k, 3).

        Returns:
            (...) int.
        """
        free = free_axes(self.area)
        place = np.clip(np.asarray(x_y_yaw, dtype=float), self.area.lower, self.area.upper)[
            ..., free
        ]
        last = self.upper[:, free] >= self.area.upper[free]
        found = np.zeros(place.shape[:-1], dtype=np.int64)
        for j, (lower, upper) in enumerate(
            zip(self.lower[:, free], self.upper[:, free], strict=True)
        ):
            inside = (place >= lower) & ((place < upper) | last[j])
            found[inside.all(axis=-1)] = j
        return found

    def name(self, region: int) -> str:
        """The human-readable name of a region: its ranges along the axes that are split."""
        lower, upper = self.bounds(region)
        split = (lower > self.area.lower) | (upper < self.area.upper)
        return ranges(self.area, lower, upper, split, digits=3)


def free_axes(area: WorkArea) -> NDArray[np.bool_]:
    """(k, 3) which coordinates may vary; a unit box over the area has an axis for each."""
    return area.upper > area.lower


def from_unit_box(area: WorkArea, unit: ArrayLike) -> Array:
    """Places in the work area from those in the unit box over its d free axes.

    Args:
        area: the work area.
        unit: (..., d), axes in the order of the objects, x before y before yaw.

    Returns:
        x_y_yaw: (..., k, 3), exactly the area's corners for 0 and 1.
    """
    unit, free = np.asarray(unit, dtype=float), free_axes(area)
    lower, upper = area.lower[free], area.upper[free]
    x_y_yaw = np.tile(area.lower, (*unit.shape[:-1], 1, 1))
    x_y_yaw[..., free] = np.where(unit == 1.0, upper, lower + unit * (upper - lower))
    return x_y_yaw


def box_regions(area: WorkArea, lower: ArrayLike, upper: ArrayLike) -> BoxRegions:
    """The regions that boxes in the unit box over an area stand for; corners (K, d)."""
    return BoxRegions(area, from_unit_box(area, lower), from_unit_box(area, upper))
