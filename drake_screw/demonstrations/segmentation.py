"""From a recorded end-effector path to guiding poses: the constant screws it is made of.

The method is Mahalingam and Chakraborty's (ICRA 2023): a path is cut where a constant screw no
longer fits it, and only what happens near an object is kept.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drake_screw.screws import (
    inverse,
    nearest_on_screw,
    quaternion_from_rotation,
    rotation_vector_from_quaternion,
    sclerp_position,
    translation_distance,
)
from drake_screw.typing import Array

_TOGETHER = 24  # end poses judged at a time


@dataclass(frozen=True)
class SegmentationConfig:
    """Tolerances of segmentation.

    Attributes:
        spacing: m, poses nearer than this to the one kept before are dropped.
        position_tolerance: m, allowed distance of the path from its screw.
        rotation_tolerance: allowed distance of unit quaternions, ``|a - b|``, from the screw.
        min_progress: least change of the screw parameter from one pose to the next.
        region_of_interest: times the smallest distance of E to the object is near it.

    >>> from dataclasses import replace
    >>> replace(SegmentationConfig(), region_of_interest=2.0).spacing
    0.005
    """

    spacing: float = 0.005
    position_tolerance: float = 0.015
    rotation_tolerance: float = 0.15
    min_progress: float = 1e-3
    region_of_interest: float = 1.5


def thin(X_WE: Array, spacing: float) -> Array:
    """Indices of poses of a path (m, 4, 4), each at least `spacing` m from the one kept before."""
    positions = X_WE[:, :3, 3].tolist()
    kept = [0]
    for i, position in enumerate(positions):
        if math.dist(position, positions[kept[-1]]) >= spacing and i > 0:
            kept.append(i)
    return np.array(kept)


def fits_screw(X_WE: Array, ends: Array, config: SegmentationConfig) -> Array:
    """Whether the constant screw from the first pose to an end pose fits all poses between.

    Where the path lingers on the screw (its parameter changes by less than `min_progress` from one
    pose to the next, the last one included), it does not; where it goes back a little, it may.

    Args:
        X_WE: (m, 4, 4) a path.
        ends: (b,) indices into it, from 1: each is judged as the end pose.
        config: the tolerances.

    Returns:
        (b,) bool.
    """
    last = int(np.max(ends))
    X_WA, X_WB, p_WE = X_WE[0], X_WE[ends, None], X_WE[1:last, :3, 3]
    s = nearest_on_screw(X_WA, X_WB, p_WE)
    before_end = np.arange(1, last) < ends[:, None]
    progress = np.diff(np.where(before_end, s, 1.0), append=1.0)
    away = np.linalg.norm(sclerp_position(X_WA, X_WB, s) - p_WE, axis=-1)
    fits = (
        (np.abs(progress) >= config.min_progress)
        & (away <= config.position_tolerance)
        & (_rotation_distance(X_WE[:, :3, :3], ends, s) <= config.rotation_tolerance)
    )
    return np.all(fits | ~before_end, axis=1)


def _rotation_distance(R_WE: Array, ends: Array, s: Array) -> Array:
    """Distance (b, last - 1) of unit quaternions of the path's poses 1 to last - 1 from a screw.

    The screw leads from pose 0 to each of `ends`; the poses are held against it at s.
    """
    q = quaternion_from_rotation(R_WE[: int(np.max(ends)) + 1] @ R_WE[0].T)
    w = rotation_vector_from_quaternion(q[ends])
    angle = np.linalg.norm(w, axis=-1, keepdims=True)
    axis = w / np.where(angle > 0.0, angle, 1.0)
    between, half = q[1:-1], s * angle / 2.0
    dot = np.cos(half) * between[:, 0] + np.sin(half) * (axis @ between[:, 1:].T)
    return np.sqrt(2.0 * np.maximum(1.0 - np.abs(dot), 0.0))


def segment(X_WE: Array, config: SegmentationConfig) -> Array:
    """Indices of the poses of a path (m, 4, 4) between which it is a constant screw.

    From a start, the end moves forward pose by pose; the first end that no longer fits becomes the
    next start. The first and the last pose are among them.

    A pose every 5 mm, 0.2 m along x and then 0.2 m along y: two screws, cut one pose behind the
    corner. A quarter of a circle on which the end effector turns along: one screw.

    >>> from drake_screw.screws import exp, pose_from_planar
    >>> corner = [(0.005 * min(i, 40), 0.005 * max(i - 40, 0), 0) for i in range(81)]
    >>> segment(pose_from_planar(corner), SegmentationConfig()).tolist()
    [0, 41, 80]
    >>> turning = exp([(0, 0, 0.03 * i, 0, 0, 0) for i in range(53)])
    >>> segment(turning @ pose_from_planar([0.2, 0, 0]), SegmentationConfig()).tolist()
    [0, 52]
    """
    cuts, end = [0], 1
    while end < len(X_WE):
        ends = np.arange(end, min(end + _TOGETHER, len(X_WE)))
        fits = fits_screw(X_WE[cuts[-1] :], ends - cuts[-1], config)
        end = int(ends[-1]) + 1
        if not fits.all():
            cuts.append(int(ends[np.argmin(fits)]))
            end = cuts[-1] + 1
    if cuts[-1] != len(X_WE) - 1:
        cuts.append(len(X_WE) - 1)
    return np.array(cuts)


def guiding_poses(
    X_WE: Array, X_WO: Array, config: SegmentationConfig
) -> tuple[Array, Array, Array]:
    """Guiding poses of a recorded end-effector path, each in the frame of the object it belongs to.

    An object's region of interest is the first unbroken run of segment ends within
    `config.region_of_interest` times the smallest distance of E to the object among them. A pose in
    the regions of several objects belongs to the one it is nearest to, in proportion to that
    distance.

    Args:
        X_WE: (m, 4, 4) end-effector poses over time.
        X_WO: (k, 4, 4) object poses.

    Returns:
        X_OE (g, 4, 4); the object's index (g,); the index (g,) into the path.
    """
    kept = thin(X_WE, config.spacing)
    kept = kept[segment(X_WE[kept], config)]
    ends = X_WE[kept]
    distance = translation_distance(ends[:, None], X_WO[None])
    smallest = distance.min(axis=0)
    near = distance <= config.region_of_interest * smallest
    inside = np.stack([_first_run(flags) for flags in near.T], axis=1)
    nearness = distance / np.maximum(smallest, 1e-9)
    chosen = np.flatnonzero(inside.any(axis=1))
    owner = np.argmin(np.where(inside, nearness, np.inf)[chosen], axis=1)
    X_OE = inverse(X_WO[owner]) @ ends[chosen]
    return X_OE, owner, kept[chosen]


def _first_run(flags: Array) -> Array:
    first = int(np.argmax(flags))
    rest = flags[first:]
    length = len(rest) if rest.all() else int(np.argmin(rest))
    run = np.zeros(len(flags), dtype=bool)
    run[first : first + length] = True
    return run
