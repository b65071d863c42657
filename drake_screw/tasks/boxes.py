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
        lower, upper: (K, k, c) corners; equal along axes that are fixed.
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
        area = self.area
        extent = (area.flat(area.upper) - area.flat(area.lower))[area.free]
        sides = (area.flat(self.upper) - area.flat(self.lower))[:, area.free]
        return np.prod(sides / extent, axis=1)

    def bounds(self, region: ArrayLike) -> tuple[Array, Array]:
        """Least and greatest coordinates of regions; (...) to two arrays (..., k, c)."""
        region = np.asarray(region)
        return self.lower[region], self.upper[region]

    def index(self, coordinates: ArrayLike) -> NDArray[np.int64]:
        """The region of each instance, the nearest one if it lies outside the area.

        An instance on the border of two regions belongs to the upper one.

        Args:
            coordinates: (..., k, c).

        Returns:
            (...) int.
        """
        free, given = self.area.free, np.asarray(coordinates, dtype=float)
        place = np.clip(given, self.area.lower, self.area.upper)[..., free]
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


def from_unit_box(area: WorkArea, unit: ArrayLike) -> Array:
    """Places in the work area from those in the unit box over its d free axes.

    What is uniform in the unit box is uniform in the work area: axes are those of `WorkArea.flat`.

    Args:
        area: the work area.
        unit: (..., d), axes in the order of the objects, and of each in the order of the area's.

    Returns:
        coordinates: (..., k, c), exactly the area's corners for 0 and 1.
    """
    unit, free = np.asarray(unit, dtype=float), area.free
    lower, upper = area.flat(area.lower), area.flat(area.upper)
    flat = np.tile(lower, (*unit.shape[:-1], 1, 1))
    inside = lower[free] + unit * (upper[free] - lower[free])
    flat[..., free] = np.where(unit == 1.0, upper[free], inside)
    return area.curved(flat)


def box_regions(area: WorkArea, lower: ArrayLike, upper: ArrayLike) -> BoxRegions:
    """The regions that boxes in the unit box over an area stand for; corners (K, d)."""
    return BoxRegions(area, from_unit_box(area, lower), from_unit_box(area, upper))
