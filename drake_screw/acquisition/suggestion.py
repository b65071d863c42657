"""Where to give the next demonstration."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_screw.acquisition.asking import AskingRule, earliest, evenly
from drake_screw.acquisition.events import Evaluation, Suggestion
from drake_screw.errors import PluginError
from drake_screw.tasks import Regions, anywhere
from drake_screw.typing import Array

FAILING = 256
"""Failed instances that a suggestion has with it."""


def suggest(
    evaluation: Evaluation,
    region: int,
    regions: Regions,
    rng: np.random.Generator,
    *,
    rule: AskingRule = earliest,
    count: int = 1,
) -> tuple[Suggestion, ...]:
    """Failed instances at which to ask for a demonstration, the best one first.

    Args:
        evaluation: of the round.
        region: the weakest region.
        regions: what `evaluation.region` counts; goes into the suggestions.
        rng: settles ties.
        rule: chooses.
        count: how many at most.

    Raises:
        PluginError: the rule answers what are no rows of failed instances.
    """
    rows = _checked(rule, np.asarray(rule(evaluation, region, regions, rng)), evaluation)[:count]
    failing = evaluation.coordinates[evenly(evaluation, regions, rng, FAILING)]
    segment = evaluation.outcomes[rows].furthest_segment
    return tuple(
        Suggestion(
            int(evaluation.region[row]),
            evaluation.coordinates[row],
            int(segment[i]) if segment[i] >= 0 else None,
            regions,
            failing,
        )
        for i, row in enumerate(rows.tolist())
    )


def random_suggestion(regions: Regions, rng: np.random.Generator) -> Suggestion:
    """An instance drawn uniformly from the whole work area."""
    coordinates = anywhere(regions.area, rng, 1)[0]
    return Suggestion(int(regions.index(coordinates)), coordinates)


def initial_suggestions(
    regions: Regions, rng: np.random.Generator, number: int, first: Array | None = None
) -> tuple[Suggestion, ...]:
    """Where an initial demonstration is asked for. What may fail is the whole work area.

    Args:
        regions: the run's partition.
        rng: draws the place.
        number: of the demonstration, from 0.
        first: (k, c) where number 0 is asked for, NaN what is drawn; None, and for the others, at a
            random place.

    Returns:
        The place, and behind one that is settled a random one, should it be out of reach. Where
        objects would overlap there, which must not, it is the random one alone.
    """
    places = [random_suggestion(regions, rng)]
    if first is not None and number == 0 and np.isfinite(first).any():
        coordinates = np.where(np.isnan(first), places[0].coordinates, first)
        if not regions.area.overlaps(coordinates):
            places.insert(0, Suggestion(int(regions.index(coordinates)), coordinates))
    failing = anywhere(regions.area, rng, FAILING)
    return tuple(replace(place, failing=failing) for place in places)


def _checked(rule: AskingRule, rows: NDArray[Any], evaluation: Evaluation) -> NDArray[np.int64]:
    name = getattr(rule, "__qualname__", type(rule).__qualname__)
    if rows.ndim != 1 or (rows.size and not np.issubdtype(rows.dtype, np.integer)):
        found = f"an array {rows.dtype} of shape {rows.shape}"
        raise PluginError(
            f"asking rule '{name}': expected rows of the evaluation, (M,) int, found {found}",
            remedy="Answer np.flatnonzero(evaluation.failed), sorted or chosen from.",
        )
    N = len(evaluation.region)
    rows = rows.astype(np.int64)
    exists = (rows >= 0) & (rows < N)
    good = exists & evaluation.failed[np.where(exists, rows, 0)] if rows.size else exists
    if not good.all():
        wrong = int(np.argmin(good))
        raise PluginError(
            f"asking rule '{name}': instance {rows[wrong]} of {N} "
            f"{'succeeds' if exists[wrong] else 'does not exist'}",
            remedy="Ask only where evaluation.failed is true.",
        )
    return rows
