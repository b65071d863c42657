"""Drawing task instances so that a draw depends on nothing but its place in the run.

Instance i of a region in a round is a function of (seed, round, region, i) alone: how many are
asked for at a time, in which order, and by how many workers makes no difference.
"""

from __future__ import annotations

import numpy as np

from drake_screw.screws.rotations import Array
from drake_screw.tasks.regions import GridRegions

CHUNK = 1024


def draw(
    regions: GridRegions, region: int, *, seed: int, round: int, start: int, count: int
) -> Array:
    """Instances drawn uniformly and independently in one region.

    Chunk c of 1,024 instances comes from ``SeedSequence(seed, spawn_key=(round, region, c))``.

    Args:
        regions: the partition.
        region: which region.
        seed: of the run.
        round: of the run, from 0. Another round has other instances.
        start, count: which instances of the round's stream.

    Returns:
        x_y_yaw: (count, k, 3) m, m, rad.
    """
    if count == 0:
        return np.empty((0, *regions.counts.shape))
    lower, upper = regions.bounds(region)
    first, last = start // CHUNK, (start + count - 1) // CHUNK
    unit = np.concatenate(
        [
            np.random.default_rng(
                np.random.SeedSequence(seed, spawn_key=(round, region, chunk))
            ).random((CHUNK, *regions.counts.shape))
            for chunk in range(first, last + 1)
        ]
    )
    offset = start - first * CHUNK
    return lower + unit[offset : offset + count] * (upper - lower)
