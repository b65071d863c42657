"""Drawing task instances so that a draw depends on nothing but its place in the run.

Instance i of a region in a round is a function of (seed, round, region, i) alone: how many are
asked for at a time, in which order, and by how many workers makes no difference.

Where objects must not overlap, an instance in which they do is replaced by the one at its place in
the next of an endless row of such streams, until they do not: what is left is uniform in the rest
of the region, and still such a function.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.errors import ScenarioError
from drake_screw.tasks.regions import Regions
from drake_screw.tasks.work_area import PLANAR, WorkArea
from drake_screw.typing import Array

CHUNK = 1024
CHANCE = 2**31 + 3

MORE, AGAIN = 1, 2
"""Of the keys of streams: the axes beyond x, y, yaw; what takes the place of overlapping objects.
"""

MOST = 100_000
"""Places of an instance that are tried before nothing counts as left in a region: where a part in
2,000 is left that is less likely than 1e-21."""


def uniform(
    width: tuple[int, ...], *, seed: int, key: tuple[int, ...], start: int, count: int
) -> Array:
    """Numbers from [0, 1), a stretch of an endless stream.

    Chunk c of 1,024 of its items comes from ``SeedSequence(seed, spawn_key=(*key, c))``.

    Args:
        width: shape of one item.
        seed: of the run.
        key: of the stream.
        start, count: which items.

    Returns:
        ``(count, *width)``.
    """
    if count == 0:
        return np.empty((0, *width))
    first, last = start // CHUNK, (start + count - 1) // CHUNK
    chunks = [
        np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(*key, chunk))).random(
            (CHUNK, *width)
        )
        for chunk in range(first, last + 1)
    ]
    offset = start - first * CHUNK
    return np.concatenate(chunks)[offset : offset + count]


def draw(
    regions: Regions,
    region: int,
    *,
    seed: int,
    round: int,
    start: int,
    count: int,
    most: int = MOST,
) -> Array:
    """Instances drawn uniformly and independently in one region.

    Their x, y, yaw are the stream of `uniform` with key (round, region), further axes that with key
    (round, region, MORE).

    Args:
        regions: the partition.
        region: which region.
        seed: of the run.
        round: of the run, from 0. Another round has other instances.
        start, count: which instances of the round's stream.
        most: places of an instance that are tried where objects must not overlap.

    Returns:
        coordinates: (count, k, c) m and rad.

    Raises:
        ScenarioError: objects must not overlap, and next to nothing of the region is left.

    Drawn at once or one by one, the instances are the same:

    >>> from drake_screw.tasks import ObjectArea, WorkArea, grid_regions
    >>> area = WorkArea((ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), z=0.0),))
    >>> regions = grid_regions(area, {"x": 4, "y": 4})
    >>> together = draw(regions, 5, seed=0, round=0, start=0, count=3)
    >>> together.shape, set(regions.index(together).tolist())
    ((3, 1, 3), {5})
    >>> bool((draw(regions, 5, seed=0, round=0, start=2, count=1) == together[2:]).all())
    True
    """
    area, (lower, upper) = regions.area, regions.bounds(region)
    lower, upper = area.flat(lower), area.flat(upper)

    def candidates(*again: int) -> Array:
        key, k = (round, region, *again), len(lower)
        unit = uniform((k, PLANAR), seed=seed, key=key, start=start, count=count)
        if lower.shape[1] > PLANAR:
            more = (k, lower.shape[1] - PLANAR)
            others = uniform(more, seed=seed, key=(*key, MORE), start=start, count=count)
            unit = np.concatenate([unit, others], axis=-1)
        return area.curved(lower + unit * (upper - lower))

    found = candidates()
    bad = np.flatnonzero(area.overlaps(found))
    for attempt in range(most):
        if len(bad) == 0:
            return found
        found[bad] = candidates(AGAIN, attempt)[bad]
        bad = bad[area.overlaps(found[bad])]
    raise ScenarioError(
        f"region {region} ({regions.name(region)}): objects overlap at each of {most:,} places "
        "drawn in it, so that next to nothing of it is left",
        remedy="Give the objects more room, cut them fewer cells, or leave `apart` out.",
    )


def anywhere(area: WorkArea, rng: np.random.Generator, count: int) -> Array:
    """Instances (count, k, c) drawn uniformly from the whole work area.

    Raises:
        ScenarioError: objects must not overlap, and next to nothing of the area is left.
    """
    lower, upper = area.flat(area.lower), area.flat(area.upper)
    found = area.curved(rng.uniform(lower, upper, (count, *lower.shape)))
    bad = np.flatnonzero(area.overlaps(found))
    for _ in range(MOST):
        if len(bad) == 0:
            return found
        found[bad] = area.curved(rng.uniform(lower, upper, (len(bad), *lower.shape)))
        bad = bad[area.overlaps(found[bad])]
    raise ScenarioError(
        f"objects overlap at each of {MOST:,} places drawn in the work area",
        remedy="Give the objects more room, or leave `apart` out.",
    )


def chance(width: int, *, seed: int, round: int, region: int, start: int, count: int) -> Array:
    """Further numbers from [0, 1) for instances of a region, beside those of their places.

    They are the stream of `uniform` with key (round, region, CHANCE).

    Args:
        width: numbers for each.
        seed, round, region, start, count: as of `draw`; `region` may be any number of a box.

    Returns:
        (count, width).
    """
    key = (round, region, CHANCE)
    return uniform((width,), seed=seed, key=key, start=start, count=count)


def draw_in_all(
    regions: Regions,
    counts: ArrayLike,
    *,
    seed: int,
    round: int,
    starts: ArrayLike = 0,
) -> tuple[Array, NDArray[np.int64]]:
    """Instances drawn in every region, region after region.

    Args:
        regions: the partition, K regions.
        counts: how many in each; (K,), or one number for all.
        seed: of the run.
        round: of the run, from 0.
        starts: the first of each region's stream, as `counts`.

    Returns:
        coordinates: (N, k, c) m and rad, where N is the sum of `counts`.
        region: (N,) of each.

    >>> from drake_screw.tasks import ObjectArea, WorkArea, grid_regions
    >>> area = WorkArea((ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), z=0.0),))
    >>> places, region = draw_in_all(grid_regions(area, {"x": 3}), [2, 0, 1], seed=0, round=0)
    >>> places.shape, region.tolist()
    ((3, 1, 3), [0, 0, 2])
    """
    count = np.broadcast_to(np.asarray(counts, dtype=np.int64), regions.K)
    start = np.broadcast_to(np.asarray(starts, dtype=np.int64), regions.K)
    chosen = np.flatnonzero(count).tolist() or [0]  # none of region 0 where there are none at all
    places = [
        draw(regions, j, seed=seed, round=round, start=int(start[j]), count=int(count[j]))
        for j in chosen
    ]
    return np.concatenate(places), np.repeat(np.arange(regions.K), count)
