"""Demonstrations: guiding poses that carry over to other places of the objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.demonstrations.deviations import Deviations, deviations_from_screws
from drake_screw.demonstrations.faithful import FaithfulConfig, faithful_guiding_poses
from drake_screw.demonstrations.fidelity import Fidelity, fidelity
from drake_screw.demonstrations.recording import Recording
from drake_screw.demonstrations.refusal import require_motion
from drake_screw.demonstrations.regions import Regions
from drake_screw.demonstrations.segmentation import SegmentationConfig, guiding_poses
from drake_screw.demonstrations.shown import Shown, what_is_shown
from drake_screw.typing import Array

if TYPE_CHECKING:
    from drake_screw.robot.arm import Arm


@dataclass(frozen=True)
class Demonstration:
    """A recording turned into guiding poses relative to the objects they belong to.

    Attributes:
        name: of the recording.
        X_OE: (g, 4, 4) guiding poses, each in its object's frame.
        objects: (g,) index of that object.
        X_WO: (k, 4, 4) where the objects were.
        path: (m, 4, 4) X_WE, the end effector as recorded.
        kept: (g,) indices of the guiding poses in `path`.
        fidelity: how faithfully they keep what was shown, for each object of the task.
        notes: what else should be known, in words: which objects are bystanders.
        deviations: the samples that are kept near each of these objects, and how far each is from
            the screws.
    """

    name: str
    X_OE: Array
    objects: NDArray[np.int64]
    X_WO: Array
    path: Array
    kept: NDArray[np.int64]
    fidelity: tuple[Fidelity, ...] = ()
    notes: tuple[str, ...] = ()
    deviations: tuple[Deviations, ...] = ()

    def transfer(self, X_WO: ArrayLike) -> Array:
        """Guiding poses for objects elsewhere: X_WE' = X_WO' X_OE.

        Args:
            X_WO: (..., k, 4, 4).

        Returns:
            X_WE: (..., g, 4, 4).
        """
        return np.asarray(X_WO, dtype=float)[..., self.objects, :, :] @ self.X_OE


def demonstration_from_recording(
    recording: Recording,
    arm: Arm,
    config: SegmentationConfig | FaithfulConfig | None = None,
    *,
    names: Sequence[str] | None = None,
    task_objects: Sequence[str] = (),
) -> Demonstration:
    """Forward kinematics and segmentation of a recording.

    Args:
        recording: to learn from. A region-of-interest factor of its own overrides the
            configuration's, and objects of the task that it names override `task_objects`.
        arm: that was led.
        config: how the path is cut: faithfully (see `faithful`; the default), or as published (see
            `segmentation`).
        names: of the k objects; "object 1" and so on if None.
        task_objects: names of the objects that the end effector works on; found by distance where
            empty.

    Raises:
        NoMotionKept: faithful segmentation keeps no motion of it, and says why.
        RecordingError: an object of the task has a name that no object has.
    """
    config = config or FaithfulConfig()
    return demonstration_of(
        what_is_shown(recording, arm, config, names=names, task_objects=task_objects)
    )


def demonstration_of(shown: Shown) -> Demonstration:
    """Segmentation of what a recording shows.

    Raises:
        NoMotionKept: faithful segmentation keeps no motion of it, and says why.
    """
    recording, config, measure = shown.recording, shown.config, shown.measure
    X_WE, X_WO, t, names = shown.X_WE, recording.X_WO, recording.t, shown.names
    regions = shown.regions
    notes: tuple[str, ...] = ()
    if isinstance(config, FaithfulConfig):
        found = faithful_guiding_poses(X_WE, X_WO, config, t=t, regions=regions)
        _, owners, kept = found
        file = recording.source
        require_motion(X_WE, t, X_WO, owners, kept, regions, names, config, file=file)
        notes = _bystanders(regions, names)
    else:
        found = guiding_poses(X_WE, X_WO, config)
    X_OE, owners, kept = found
    away = deviations_from_screws(X_WE, X_WO, X_OE, owners, measure, regions=regions)
    kept_well = fidelity(
        X_WE, t, X_WO, X_OE, owners, names, measure, regions=regions, deviations=away
    )
    return Demonstration(recording.name, X_OE, owners, X_WO, X_WE, kept, kept_well, notes, away)


def _bystanders(regions: Regions, names: Sequence[str]) -> tuple[str, ...]:
    return tuple(
        f"the {names[i]}, {regions.smallest[i]:.2f} m from the end effector at the nearest, "
        "is a bystander"
        for i in np.flatnonzero(~regions.task).tolist()
    )
