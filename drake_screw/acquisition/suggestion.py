"""Where to give the next demonstration."""

from __future__ import annotations

import numpy as np

from drake_screw.acquisition.events import Evaluation, Suggestion
from drake_screw.tasks import Regions


def suggest(
    evaluation: Evaluation,
    region: int,
    rng: np.random.Generator,
    *,
    count: int = 1,
    regions: Regions | None = None,
) -> tuple[Suggestion, ...]:
    """Failed instances of a region, the one that failed earliest first.

    An instance counts by its best attempt: the furthest screw segment that any demonstration in
    hand got to. Those that got least far come first, in random order among equals (the paper's
    heuristic: there the demonstrations in hand help least).

    Args:
        evaluation: of the round.
        region: the weakest region.
        rng: settles ties.
        count: how many at most.
        regions: goes into the suggestions.
    """
    failed = np.flatnonzero(evaluation.failed & (evaluation.region == region))
    segment = evaluation.outcomes[failed].furthest_segment
    order = np.lexsort((rng.random(len(failed)), segment))[:count]
    return tuple(
        Suggestion(
            region,
            evaluation.x_y_yaw[failed[i]],
            int(segment[i]) if segment[i] >= 0 else None,
            regions,
        )
        for i in order
    )


def random_suggestion(regions: Regions, rng: np.random.Generator) -> Suggestion:
    """An instance drawn uniformly from the whole work area."""
    x_y_yaw = rng.uniform(regions.area.lower, regions.area.upper)
    return Suggestion(int(regions.index(x_y_yaw)), x_y_yaw)
