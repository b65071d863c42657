"""How far recorded samples are from the screws through guiding poses, sample by sample."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from drake_screw.compile_cache import cached_njit
from drake_screw.demonstrations.faithful import FaithfulConfig
from drake_screw.demonstrations.regions import Regions
from drake_screw.screws import (
    quaternion_from_rotation,
    rotation_angle,
    sclerp,
    sclerp_position,
    translation_distance,
)
from drake_screw.typing import Array

_STEP, _TURN_STEP = 2.5e-4, 2.5e-3  # m, rad: screws are sampled so densely
_SAME = 0.2  # of the tolerances: samples nearer than this to a guiding pose may have become it


@dataclass(frozen=True, eq=False)
class Deviations:
    """The samples kept near one object, and how far each is from the screws.

    Attributes:
        object: its index.
        samples: (n,) indices into the recording, increasing.
        position: (n,) m, and
        rotation: (n,) rad, from the point of a screw that each sample is held against.
    """

    object: int
    samples: NDArray[np.int64]
    position: Array
    rotation: Array


def deviations_from_screws(
    X_WE: Array,
    X_WO: Array,
    X_OE: Array,
    objects: NDArray[np.int64],
    config: FaithfulConfig,
    *,
    regions: Regions | None = None,
) -> tuple[Deviations, ...]:
    """What is kept of a recording near each object, and how far it is from the screws.

    What was shown near an object are the samples of its visits (`regions_of_interest`). The screws
    lead between guiding poses of one object that follow on each other; from the last before another
    object's to the first of that one, the way is free. Kept are the samples near the object from
    the one at the first guiding pose of such a run to the one at its last: the first and the last
    that are as near as any, to within a fifth of the tolerances.

    The screws are sampled every 0.25 mm and 2.5 mrad, and each sample kept is given a point of
    them, in the order shown. Of all ways to do that the largest deviation, in proportion to the
    tolerances, decides, then the sum of squares.

    Args:
        X_WE: (m, 4, 4) end-effector poses as recorded.
        X_WO: (k, 4, 4) object poses.
        X_OE: (g, 4, 4) guiding poses, however they were found, each in its object's frame.
        objects: (g,) index of that object.
        config: tolerances and regions.
        regions: `config.regions(X_WE, X_WO)`, if known; needed where objects are named.

    Returns:
        One for each object of the task and for any other with guiding poses, in their order.
    """
    regions = config.regions(X_WE, X_WO) if regions is None else regions
    guides = X_WO[objects] @ X_OE
    concerned = np.union1d(np.flatnonzero(regions.task), objects)
    return tuple(
        _near(X_WE, regions, int(index), runs_of(guides, objects, index), config)
        for index in concerned
    )


def runs_of(values: Array, objects: NDArray[np.int64], index: int | np.int64) -> list[Array]:
    """What belongs to the guiding poses (g, ...) of one object, in runs without another's."""
    breaks = np.flatnonzero(np.diff(objects) != 0) + 1
    bounds = zip([0, *breaks], [*breaks, len(objects)], strict=True)
    return [values[a:b] for a, b in bounds if a < b and objects[a] == index]


def _near(
    X_WE: Array, regions: Regions, index: int, runs: list[Array], config: FaithfulConfig
) -> Deviations:
    rest = regions.samples(index)
    kept, position, rotation = [np.zeros(0, dtype=np.int64)], [np.zeros(0)], [np.zeros(0)]
    for X in runs:
        first, last = _stretch(X_WE[rest], X, config)
        samples, rest = rest[first : last + 1], rest[last + 1 :]
        if len(samples):
            away, off = deviations(X_WE[samples], on_screws(X), config)
            kept.append(samples)
            position.append(away)
            rotation.append(off)
    return Deviations(
        index, np.concatenate(kept), np.concatenate(position), np.concatenate(rotation)
    )


def _stretch(samples: Array, guides: Array, config: FaithfulConfig) -> tuple[int, int]:
    """The first sample at the first guiding pose, and the last sample at the last one."""
    if not len(samples):
        return 0, -1
    first, last = (
        np.maximum(
            translation_distance(samples, X) / config.position_tolerance,
            rotation_angle(samples, X) / config.rotation_tolerance,
        )
        for X in (guides[0], guides[-1])
    )
    start = int(np.argmax(first <= first.min() + _SAME))
    last = last[start:]
    return start, start + int(np.flatnonzero(last <= last.min() + _SAME)[-1])


def on_screws(X_WE: Array) -> Array:
    """Poses densely on the constant screws from pose to pose; (g, 4, 4) to (M, 4, 4)."""
    parts = [X_WE[:1]]
    for A, B in pairwise(X_WE):
        chords = np.diff(sclerp_position(A, B, np.linspace(0.0, 1.0, 17)), axis=0)
        arc = 1.01 * float(np.linalg.norm(chords, axis=1).sum())
        steps = math.ceil(max(arc / _STEP, float(rotation_angle(A, B)) / _TURN_STEP, 1.0))
        parts.append(sclerp(A, B, np.arange(1, steps + 1) / steps))
    return np.concatenate(parts)


def deviations(samples: Array, track: Array, config: FaithfulConfig) -> tuple[Array, Array]:
    """How far samples are from a dense track, each held against one pose of it, in order.

    Args:
        samples: (n, 4, 4).
        track: (M, 4, 4).
        config: the tolerances, in proportion to which positions and rotations are weighed.

    Returns:
        (n,) m and (n,) rad.
    """
    at = _in_order(
        np.ascontiguousarray(samples[:, :3, 3]),
        quaternion_from_rotation(samples[:, :3, :3]),
        np.ascontiguousarray(track[:, :3, 3]),
        quaternion_from_rotation(track[:, :3, :3]),
        config.position_tolerance,
        config.rotation_tolerance,
    )
    return translation_distance(samples, track[at]), rotation_angle(samples, track[at])


@cached_njit()
def _in_order(
    p: Array, q: Array, P: Array, Q: Array, position_tolerance: float, rotation_tolerance: float
) -> NDArray[np.int64]:
    """For each sample (p, q) the pose of a track (P, Q): first the bottleneck, then the squares."""
    n, M = len(p), len(P)
    cost = np.empty((n, M))
    for k in range(n):
        for m in range(M):
            d0, d1, d2 = p[k, 0] - P[m, 0], p[k, 1] - P[m, 1], p[k, 2] - P[m, 2]
            away = np.sqrt(d0 * d0 + d1 * d1 + d2 * d2) / position_tolerance
            c = abs(q[k, 0] * Q[m, 0] + q[k, 1] * Q[m, 1] + q[k, 2] * Q[m, 2] + q[k, 3] * Q[m, 3])
            off = 2.0 * np.arccos(min(1.0, c)) / rotation_tolerance
            cost[k, m] = max(away, off)
    worst = np.zeros(M)
    for k in range(n):
        least = np.inf
        for m in range(M):
            least = min(least, worst[m])
            worst[m] = max(least, cost[k, m])
    bottleneck = np.inf
    for m in range(M):
        bottleneck = min(bottleneck, worst[m])
    total = np.zeros(M)
    origin = np.empty((n, M), dtype=np.int32)
    for k in range(n):
        least, where = np.inf, 0
        for m in range(M):
            if total[m] < least:
                least, where = total[m], m
            origin[k, m] = where
            total[m] = least + cost[k, m] ** 2 if cost[k, m] <= bottleneck else np.inf
    chosen = np.empty(n, dtype=np.int64)
    at = 0
    for m in range(M):
        if total[m] < total[at]:
            at = m
    for k in range(n - 1, -1, -1):
        chosen[k] = at
        at = origin[k, at]
    return chosen
