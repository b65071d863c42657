"""Finding one's way among half a million instances: those that fail, and a few that do not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.planning import Outcomes
from drake_screw.typing import Array
from drake_screw.visualization.cells import Axes
from drake_screw.visualization.rounds import Round

SUCCESSES = 200
"""How many instances that succeed are offered, drawn at random."""


@dataclass(frozen=True, eq=False)
class Catalogue:
    """Instances of a round that are worth a look: all that fail, then a few that succeed.

    Attributes:
        event: the round.
        instance: (c,) index of each in the round's evaluation; those that fail come first, the
            earliest failing of them first.
        region: (c,) the region of each.
        segment: (c,) the segment in which the best attempt failed.
        failing: how many fail.
        axes: that maps show.
    """

    event: Round
    instance: NDArray[np.int64]
    region: NDArray[np.int64]
    segment: NDArray[np.int64]
    failing: int
    axes: Axes

    def of_region(self, region: int | None) -> NDArray[np.int64]:
        """Places (p,) in the catalogue of one region's instances, or of all."""
        if region is None:
            return np.arange(len(self.instance))
        return np.flatnonzero(self.region == region)

    def coordinates(self, place: int) -> Array:
        """(k, c) m and rad, of a place in the catalogue."""
        return self.event.evaluation.coordinates[self.instance[place]]

    def outcomes(self, place: int) -> Outcomes:
        """(D,) of a place in the catalogue."""
        return self.event.evaluation.outcomes[self.instance[place]]

    def suggested(self) -> int | None:
        """The place of the instance that the next demonstration is wanted at."""
        if self.event.suggestion is None or self.failing == 0:
            return None
        return self.nearest(self.event.suggestion.coordinates, np.arange(self.failing))

    def nearest(self, coordinates: ArrayLike, among: NDArray[np.int64]) -> int | None:
        """The place, among some, of the instance nearest to coordinates (k, c)."""
        if len(among) == 0:
            return None
        there = self.event.evaluation.coordinates[self.instance[among]]
        away = np.linalg.norm((there - np.asarray(coordinates)).reshape(len(among), -1), axis=1)
        return int(among[away.argmin()])

    def nearest_to(self, x: float, y: float) -> int | None:
        """The place of the instance nearest to a point of the map, those that fail first.

        x and y are along the map's axes, its first and its second. An instance that succeeds is
        taken only where none that fails is within 0.03 (m or rad).
        """
        (i, a), (j, b) = self.axes
        there = self.event.evaluation.coordinates[self.instance]
        p = np.stack([there[:, i, a], there[:, j, b]], axis=-1)
        if len(p) == 0:
            return None
        away = np.linalg.norm(p - np.array([x, y]), axis=1)
        failing = away[: self.failing]
        if self.failing and (failing.min() < 0.03 or failing.min() <= away.min()):
            return int(failing.argmin())
        return int(away.argmin())

    def find(self, instance: int) -> int | None:
        """The place of an instance of the evaluation, if it is in the catalogue."""
        found = np.flatnonzero(self.instance == instance)
        return int(found[0]) if len(found) else None

    def first(self) -> int | None:
        """Where to begin: the suggested instance, or the earliest failing, or any."""
        suggested = self.suggested()
        if suggested is not None:
            return suggested
        return 0 if len(self.instance) else None


def catalogue(event: Round, region: NDArray[np.int64], axes: Axes) -> Catalogue:
    """The catalogue of a round.

    Args:
        event: the round.
        region: (N,) the region of each instance.
        axes: that maps show.
    """
    outcomes = event.evaluation.outcomes
    success = outcomes.any_success
    failing = np.flatnonzero(~success)
    segment = outcomes[failing].furthest_segment
    order = np.argsort(segment, kind="stable")
    well = np.flatnonzero(success)
    if len(well) > SUCCESSES:
        well = np.sort(np.random.default_rng(0).choice(well, SUCCESSES, replace=False))
    instance = np.concatenate([failing[order], well])
    last = np.full(len(well), np.iinfo(np.int16).max, dtype=np.int64)
    segments = np.concatenate([segment[order], last])
    return Catalogue(event, instance, region[instance], segments, len(failing), axes)
