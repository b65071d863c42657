"""Demonstrations that keep no motion are not used, and say what was lost and why."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from drake_screw.demonstrations.faithful import FaithfulConfig, thin
from drake_screw.demonstrations.fidelity import turn
from drake_screw.demonstrations.regions import Regions
from drake_screw.errors import RecordingError
from drake_screw.screws import rotation_angle, translation_distance
from drake_screw.typing import Array

LEAST_SHARE = 0.05
"""Of the end effector's travel and turn within reach of the objects; less of both is next to
nothing."""

Reason = Literal["far", "at the end effector", "small region"]


class NoMotionKept(RecordingError):
    """A recording of which no motion near an object of the task is kept.

    Attributes:
        reason: no object of the task within reach; an object at the very place of the end effector;
            or a region of interest in which the end effector does not move.
    """

    def __init__(
        self, message: str, reason: Reason, *, remedy: str, file: str | Path | None = None
    ) -> None:
        super().__init__(message, remedy=remedy, file=file)
        self.reason = reason


def require_motion(
    X_WE: Array,
    t: Array,
    X_WO: Array,
    objects: NDArray[np.int64],
    kept: NDArray[np.int64],
    regions: Regions,
    names: Sequence[str],
    config: FaithfulConfig,
    *,
    file: str | Path | None = None,
) -> None:
    """Refuse a demonstration that keeps no motion.

    It keeps some if the guiding poses of one visit differ by more than one of the tolerances, and
    if between them the end effector travels or turns by more than that, and by more than
    `LEAST_SHARE` of its travel or turn within `config.reach` of the objects of the task.

    Args:
        X_WE: (m, 4, 4) end-effector poses as recorded.
        t: (m,) s.
        X_WO: (k, 4, 4) object poses.
        objects, kept: (g,) object of each guiding pose, and its index into X_WE.
        regions: `config.regions` of the recording.
        names: k names of objects.
        config: tolerances.
        file: named in the error.

    Raises:
        NoMotionKept: otherwise.
    """
    if not regions.task.any():
        index = int(np.argmin(regions.smallest))
        raise NoMotionKept(
            "no motion is kept: the end effector comes no nearer than "
            f"{regions.smallest[index]:.2f} m to "
            f"an object ({names[index]}), and what is farther than {config.reach:g} m is a "
            "bystander",
            "far",
            remedy="Check the object poses, record nearer to the object, or name the objects of "
            "the task.",
            file=file,
        )
    stretches = [X_WE[a : b + 1] for a, b in _stretches(objects, kept)]
    moves = any(_differ(X, config) for X in stretches)
    travel, turned = _motion(stretches, config)
    distance = translation_distance(X_WE[:, None], X_WO[None, regions.task]).min(axis=1)
    near = np.flatnonzero(distance <= max(config.reach, config.region_of_interest * distance.min()))
    shown_travel, shown_turn = _motion(np.split(X_WE[near], _gaps(near)), config)
    travels = travel > max(LEAST_SHARE * shown_travel, config.position_tolerance)
    turns = turned > max(LEAST_SHARE * shown_turn, config.rotation_tolerance)
    if moves and (travels or turns):
        return
    index = int(np.argmin(np.where(regions.task, regions.smallest, np.inf)))
    smallest = regions.smallest[index]
    seconds = sum(float(t[v.stop - 1] - t[v.start]) for v in regions.visits)
    samples = sum(v.stop - v.start for v in regions.visits)
    lost = (
        f"the region of interest, {config.region_of_interest:g} times the smallest distance of "
        f"{smallest * 1e3:.0f} mm to the {names[index]}, holds {samples} of {len(t)} samples "
        f"({seconds:.2f} s), in which the end effector moves by {travel * 1e3:.0f} mm and turns by "
        f"{turned:.2f} rad; of {shown_travel * 1e3:.0f} mm and {shown_turn:.2f} rad near it"
    )
    if smallest <= config.position_tolerance:
        raise NoMotionKept(
            f"no motion is kept: the {names[index]} is at the end effector's very place; {lost}",
            "at the end effector",
            remedy="Check the object's pose: its frame must not be where the end effector comes.",
            file=file,
        )
    raise NoMotionKept(
        f"no motion is kept: {lost}",
        "small region",
        remedy="Raise region_of_interest, check the object's pose, or record again.",
        file=file,
    )


def _stretches(objects: NDArray[np.int64], kept: NDArray[np.int64]) -> list[tuple[int, int]]:
    """First and last sample of each run of guiding poses of one object."""
    breaks = np.flatnonzero(np.diff(objects) != 0) + 1
    return [(int(run[0]), int(run[-1])) for run in np.split(kept, breaks) if len(run)]


def _gaps(indices: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.flatnonzero(np.diff(indices) > 1) + 1


def _differ(X_WE: Array, config: FaithfulConfig) -> bool:
    place, angle = translation_distance(X_WE, X_WE[:1]), rotation_angle(X_WE, X_WE[:1])
    return bool(
        (place > config.position_tolerance).any() or (angle > config.rotation_tolerance).any()
    )


def _motion(paths: Sequence[Array], config: FaithfulConfig) -> tuple[float, float]:
    """Travel in m and turn in rad along some paths, trembling apart."""
    travel = turned = 0.0
    for X in paths:
        if len(X):
            steps = X[thin(X, config.position_tolerance, np.inf)]
            travel += float(translation_distance(steps[1:], steps[:-1]).sum())
            turned += turn(X, 2.0 * config.rotation_tolerance)
    return travel, turned
