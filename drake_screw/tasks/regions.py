"""Partitions of the work area into regions, the arms of the bandit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.tasks.work_area import WorkArea
from drake_screw.typing import Array


class Regions(Protocol):
    """A partition of the work area into boxes, numbered from 0."""

    @property
    def area(self) -> WorkArea:
        """The work area."""

    @property
    def K(self) -> int:
        """Number of regions."""

    @property
    def shares(self) -> Array:
        """(K,) share of the work area that each region takes up, as `WorkArea.flat` measures it."""

    def bounds(self, region: ArrayLike) -> tuple[Array, Array]:
        """Least and greatest coordinates of regions; (...) to two arrays (..., k, c)."""

    def index(self, coordinates: ArrayLike) -> NDArray[np.int64]:
        """The region of each instance, the nearest one if it lies outside; (..., k, c) to (...)."""

    def name(self, region: int) -> str:
        """The human-readable name of a region."""


@dataclass(frozen=True)
class GridRegions:
    """A grid of equal cells over the axes of the work area.

    Equal are their shares: along a pitch that belongs to any orientation cuts are equally far apart
    in its sine.

    Regions are numbered with the first axis running fastest: in a 4 x 4 grid over x and y,
    region 5 is the second cell in x and the second in y.

    Attributes:
        area: the work area.
        counts: (k, c) cells along the area's axes of each object.
    """

    area: WorkArea
    counts: NDArray[np.int64]

    @property
    def K(self) -> int:
        """Number of regions."""
        return int(np.prod(self.counts))

    @property
    def shares(self) -> Array:
        """(K,) share of the work area that each region takes up: 1 / K."""
        return np.full(self.K, 1.0 / self.K)

    def cell(self, region: ArrayLike) -> NDArray[np.int64]:
        """Integer coordinates of regions; (...) to (..., k, c)."""
        flat = np.unravel_index(np.asarray(region), self.counts.ravel(), order="F")
        return np.stack(flat, axis=-1).reshape(*np.shape(region), *self.counts.shape)

    def bounds(self, region: ArrayLike) -> tuple[Array, Array]:
        """Least and greatest coordinates of regions; (...) to two arrays (..., k, c)."""
        cell, (lower, upper) = self.cell(region), self._ends
        width = (upper - lower) / self.counts
        curved = self.area.curved
        return curved(lower + cell * width), curved(lower + (cell + 1) * width)

    @property
    def _ends(self) -> tuple[Array, Array]:
        return self.area.flat(self.area.lower), self.area.flat(self.area.upper)

    def index(self, coordinates: ArrayLike) -> NDArray[np.int64]:
        """The region of each instance, the nearest one if it lies outside the area.

        Args:
            coordinates: (..., k, c).

        Returns:
            (...) int.
        """
        flat, (lower, upper) = self.area.flat(coordinates), self._ends
        width = np.where(self.counts > 1, (upper - lower) / self.counts, 1.0)
        cell = np.floor((flat - lower) / width).astype(np.int64)
        cell = np.clip(cell, 0, self.counts - 1).reshape(*flat.shape[:-2], -1)
        return np.ravel_multi_index(
            tuple(np.moveaxis(cell, -1, 0)), tuple(self.counts.ravel()), order="F"
        )

    def name(self, region: int) -> str:
        """The human-readable name of a region: its ranges along the axes that are split."""
        return ranges(self.area, *self.bounds(region), self.counts > 1)


def ranges(
    area: WorkArea, lower: Array, upper: Array, split: NDArray[np.bool_], *, digits: int = 2
) -> str:
    """A box in words: its ranges along the axes that are split.

    Args:
        area: names the objects.
        lower, upper: (k, c) corners.
        split: (k, c) the axes to name.
        digits: behind the point.
    """
    several = len(area.objects) > 1
    parts = [
        f"{area.objects[i].name + ' ' if several else ''}{area.axes[j]} "
        f"{lower[i, j]:.{digits}f}..{upper[i, j]:.{digits}f}"
        for i, j in zip(*np.nonzero(split), strict=True)
    ]
    return ", ".join(parts) or "the whole work area"


def grid_regions(area: WorkArea, counts: Mapping[str, int]) -> GridRegions:
    """A grid from cells per axis, named "x", "bowl.y", ...; axes not named are not split.

    >>> from drake_screw.tasks import ObjectArea
    >>> area = WorkArea((ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), z=0.0),))
    >>> regions = grid_regions(area, {"x": 4, "y": 4})
    >>> regions.K, regions.name(5)
    (16, 'x 0.80..0.90, y 0.05..0.30')
    >>> int(regions.index([[0.85, 0.1, 0.0]]))
    5
    """
    table = np.ones((len(area.objects), len(area.axes)), dtype=np.int64)
    for key, count in counts.items():
        name, _, axis = key.rpartition(".")
        names = [o.name for o in area.objects]
        table[names.index(name) if name else 0, area.axes.index(axis)] = count
    return GridRegions(area, table)
