"""From a recorded hand path to guiding poses: the constant screws it is made of.

The method is Mahalingam and Chakraborty's (ICRA 2023): a path is cut where a constant screw no
longer fits it, and only what happens near an object is kept.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drake_screw.screws import (
    nearest_on_screw,
    quaternion_distance,
    sclerp,
    translation_distance,
)
from drake_screw.screws.rotations import Array


@dataclass(frozen=True)
class SegmentationConfig:
    """Tolerances of segmentation.

    Attributes:
        spacing: m, hand poses nearer than this to the one kept before are dropped.
        position_tolerance: m, allowed distance of the path from its screw.
        rotation_tolerance: allowed distance of unit quaternions, |a - b|, from the screw.
        min_progress: least change of the screw parameter from one pose to the next.
        region_of_interest: times the smallest hand-object distance is near the object.
    """

    spacing: float = 0.005
    position_tolerance: float = 0.015
    rotation_tolerance: float = 0.15
    min_progress: float = 1e-3
    region_of_interest: float = 1.5


def thin(X_WE: Array, spacing: float) -> Array:
    """Indices of poses of a path (m, 4, 4), each at least `spacing` m from the one kept before."""
    positions = X_WE[:, :3, 3]
    kept = [0]
    while True:
        away = np.linalg.norm(positions[kept[-1] + 1 :] - positions[kept[-1]], axis=1) >= spacing
        if not away.any():
            return np.array(kept)
        kept.append(kept[-1] + 1 + int(np.argmax(away)))


def fits_screw(X_WE: Array, config: SegmentationConfig) -> bool:
    """Whether one constant screw from the first to the last pose of (m, 4, 4) fits all between.

    Where the path lingers on the screw (its parameter changes by less than `min_progress` from one
    pose to the next, the last one included), it does not; where it goes back a little, it may.
    """
    if len(X_WE) < 3:
        return True
    between = X_WE[1:-1]
    s = nearest_on_screw(X_WE[0], X_WE[-1], between[:, :3, 3])
    if (np.abs(np.diff(s, append=1.0)) < config.min_progress).any():
        return False
    on_screw = sclerp(X_WE[0], X_WE[-1], s)
    return bool(
        (translation_distance(on_screw, between) <= config.position_tolerance).all()
        and (quaternion_distance(on_screw, between) <= config.rotation_tolerance).all()
    )


def segment(X_WE: Array, config: SegmentationConfig) -> Array:
    """Indices of the poses of a path (m, 4, 4) between which it is a constant screw.

    From a start, the end moves forward pose by pose; the first end that no longer fits becomes the
    next start. The first and the last pose are among them.
    """
    cuts, end = [0], 1
    while end < len(X_WE):
        if not fits_screw(X_WE[cuts[-1] : end + 1], config):
            cuts.append(end)
        end += 1
    if cuts[-1] != len(X_WE) - 1:
        cuts.append(len(X_WE) - 1)
    return np.array(cuts)


def guiding_poses(
    X_WE: Array, X_WO: Array, config: SegmentationConfig
) -> tuple[Array, Array, Array]:
    """Guiding poses of a recorded hand path, each in the frame of the object it belongs to.

    An object's region of interest is the first unbroken run of segment ends within
    `config.region_of_interest` times the smallest hand-object distance among them. A pose in the
    regions of several objects belongs to the one it is nearest to, in proportion to that distance.

    Args:
        X_WE: (m, 4, 4) hand poses over time.
        X_WO: (k, 4, 4) object poses.

    Returns:
        X_OE (g, 4, 4); the object's index (g,); the index (g,) into the path.
    """
    kept = thin(X_WE, config.spacing)
    kept = kept[segment(X_WE[kept], config)]
    ends = X_WE[kept]
    distance = translation_distance(ends[:, None], X_WO[None])
    nearness = distance / distance.min(axis=0)
    inside = np.stack([_first_run(d <= config.region_of_interest) for d in nearness.T], axis=1)
    chosen = np.flatnonzero(inside.any(axis=1))
    owner = np.argmin(np.where(inside, nearness, np.inf)[chosen], axis=1)
    X_OE = np.linalg.inv(X_WO[owner]) @ ends[chosen]
    return X_OE, owner, kept[chosen]


def _first_run(flags: Array) -> Array:
    first = int(np.argmax(flags))
    rest = flags[first:]
    length = len(rest) if rest.all() else int(np.argmin(rest))
    run = np.zeros(len(flags), dtype=bool)
    run[first : first + length] = True
    return run
