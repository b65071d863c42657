"""Drawing task instances so that a draw depends on nothing but its place in the run.

Instance i of a region in a round is a function of (seed, round, region, i) alone: how many are
asked for at a time, in which order, and by how many workers makes no difference.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.tasks.regions import Regions
from drake_screw.typing import Array

CHUNK = 1024
CHANCE = 2**31 + 3


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
        (count, *width).
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


def draw(regions: Regions, region: int, *, seed: int, round: int, start: int, count: int) -> Array:
    """Instances drawn uniformly and independently in one region.

    They are the stream of `uniform` with key (round, region).

    Args:
        regions: the partition.
        region: which region.
        seed: of the run.
        round: of the run, from 0. Another round has other instances.
        start, count: which instances of the round's stream.

    Returns:
        x_y_yaw: (count, k, 3) m, m, rad.

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
    lower, upper = regions.bounds(region)
    unit = uniform(lower.shape, seed=seed, key=(round, region), start=start, count=count)
    return lower + unit * (upper - lower)


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
        x_y_yaw: (N, k, 3) m, m, rad, where N is the sum of `counts`.
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
