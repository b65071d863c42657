"""What a recording shows: the end effector's path, and where it is near which object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from drake_screw.demonstrations.faithful import FaithfulConfig
from drake_screw.demonstrations.recording import Recording
from drake_screw.demonstrations.regions import Regions
from drake_screw.demonstrations.segmentation import SegmentationConfig
from drake_screw.errors import RecordingError, suggestion
from drake_screw.typing import Array

if TYPE_CHECKING:
    from drake_screw.robot.arm import Arm


@dataclass(frozen=True, eq=False)
class Shown:
    """A recording as seen from its objects, before anything is cut.

    Attributes:
        recording: it.
        names: of its k objects.
        X_WE: (m, 4, 4) the end effector's path.
        config: how it is to be cut, with the recording's own region of interest if it has one.
        measure: tolerances and regions that its guiding poses are measured by: the configuration
            itself where it is faithful, otherwise the defaults with its region of interest.
        regions: where the end effector is near which object.
    """

    recording: Recording
    names: tuple[str, ...]
    X_WE: Array
    config: SegmentationConfig | FaithfulConfig
    measure: FaithfulConfig
    regions: Regions


def what_is_shown(
    recording: Recording,
    arm: Arm,
    config: SegmentationConfig | FaithfulConfig,
    *,
    names: Sequence[str] | None = None,
    task_objects: Sequence[str] = (),
) -> Shown:
    """Forward kinematics of a recording, and the end effector's visits to the objects.

    Args:
        recording: a region-of-interest factor of its own overrides the configuration's, and objects
            of the task that it names override `task_objects`.
        arm: that was led.
        config: how the path is to be cut.
        names: of the k objects; "object 1" and so on if None.
        task_objects: names of the objects that the end effector works on; found by distance where
            empty.

    Raises:
        RecordingError: an object of the task has a name that no object has.
    """
    if recording.region_of_interest is not None:
        config = replace(config, region_of_interest=recording.region_of_interest)
    count = len(recording.X_WO)
    known = tuple(f"object {i + 1}" for i in range(count)) if names is None else tuple(names)
    named = _indices(recording, known, recording.task_objects or task_objects)
    if isinstance(config, FaithfulConfig):
        measure = config
    else:
        measure = FaithfulConfig(region_of_interest=max(config.region_of_interest, 1.0))
    X_WE = recording.path(arm)
    regions = measure.regions(X_WE, recording.X_WO, named)
    return Shown(recording, known, X_WE, config, measure, regions)


def _indices(
    recording: Recording, names: Sequence[str], wanted: Sequence[str]
) -> tuple[int, ...] | None:
    if not wanted:
        return None
    for name in wanted:
        if name not in names:
            raise RecordingError(
                f"no object '{name}' to work on",
                remedy=suggestion(name, names, "Objects"),
                file=recording.source,
            )
    return tuple(names.index(name) for name in wanted)
