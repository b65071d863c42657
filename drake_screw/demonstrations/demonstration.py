"""Demonstrations: guiding poses that carry over to other places of the objects."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.demonstrations.recording import Recording
from drake_screw.demonstrations.segmentation import SegmentationConfig, guiding_poses
from drake_screw.robot.arm import Arm
from drake_screw.typing import Array


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
    """

    name: str
    X_OE: Array
    objects: NDArray[np.int64]
    X_WO: Array
    path: Array
    kept: NDArray[np.int64]

    def transfer(self, X_WO: ArrayLike) -> Array:
        """Guiding poses for objects elsewhere: X_WE' = X_WO' X_OE.

        Args:
            X_WO: (..., k, 4, 4).

        Returns:
            X_WE: (..., g, 4, 4).
        """
        return np.asarray(X_WO, dtype=float)[..., self.objects, :, :] @ self.X_OE


def demonstration_from_recording(
    recording: Recording, arm: Arm, config: SegmentationConfig | None = None
) -> Demonstration:
    """Forward kinematics and segmentation of a recording (see `segmentation`).

    A region-of-interest factor of the recording's own overrides the configuration's.
    """
    config = config or SegmentationConfig()
    if recording.region_of_interest is not None:
        config = replace(config, region_of_interest=recording.region_of_interest)
    path = arm.pose(recording.q)
    X_OE, objects, kept = guiding_poses(path, recording.X_WO, config)
    return Demonstration(recording.name, X_OE, objects, recording.X_WO, path, kept)
