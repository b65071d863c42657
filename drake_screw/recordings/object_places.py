"""Where the objects were: as said, as the file has it, or as the scenario fixes it."""

from __future__ import annotations

import re

import numpy as np

from drake_screw.demonstrations import Recording
from drake_screw.errors import RecordingError, suggestion
from drake_screw.recordings.mapping import Mapping
from drake_screw.recordings.places import Given
from drake_screw.recordings.raw import Raw
from drake_screw.robot import Arm
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array


def objects_of(
    raw: Raw, mapping: Mapping, arm: Arm, area: WorkArea, draft: Recording
) -> tuple[Array, list[str], list[str]]:
    """X_WO (k, 4, 4), how each was found, and the names of those that were not.

    Args:
        raw: that may hold poses.
        mapping: that may say places.
        arm: that was led.
        area: with the k objects.
        draft: the motion.

    Raises:
        RecordingError: a place is none, or of no object.
    """
    names = [item.name for item in area.objects]
    for name in mapping.objects:
        if name not in names:
            raise RecordingError(
                f"no object '{name}' in the scenario",
                remedy=suggestion(name, names, "Objects"),
                file=raw.table.file,
            )

    t = draft.t

    def hand(time: float) -> Array:
        if not 0.0 <= time <= t[-1]:
            raise RecordingError(
                f"hand:{time:g}s: the recording lasts from 0 to {t[-1]:.2f} s",
                remedy="Give a time in s since its first sample.",
                file=raw.table.file,
            )
        return _path(draft, arm, np.array([np.argmin(np.abs(t - time))]))[0]

    X_WO, said, missing = [], [], []
    for i, item in enumerate(area.objects):
        pose, how = np.eye(4), f"not said yet; say it with --object {item.name}=x,y"
        place = mapping.objects.get(item.name)
        source = re.fullmatch(r"(topic|frame):(.+)", place) if isinstance(place, str) else None
        if source:
            pose, how = _of_bag(raw, source.group(2)), f"first pose of {place}"
            how += f", seen from '{raw.frames.get(source.group(2), '')}'"
        elif item.name in mapping.objects:
            given = Given(item.name, mapping.objects[item.name])
            pose, how = given.pose(float(area.z[i]), hand)
        elif item.name in raw.X_WO:
            pose, how = raw.X_WO[item.name], "from the file"
        elif item.lower == item.upper:
            pose, how = area.X_WO(area.lower[None])[0, i], "fixed by the scenario"
        else:
            missing.append(item.name)
        x, y, z = pose[:3, 3]
        where = f"({x:.3f}, {y:.3f}, {z:.3f}) m, " if item.name not in missing else ""
        X_WO.append(pose)
        said.append(f"{item.name} {where}{how}")
    return np.array(X_WO), said, missing


def _of_bag(raw: Raw, name: str) -> Array:
    """The pose of a topic or frame."""
    if name not in raw.X_WO:
        raise RecordingError(
            f"no topic or frame '{name}' with poses",
            remedy=suggestion(name, raw.X_WO, "Topics and frames"),
            file=raw.table.file,
        )
    return raw.X_WO[name]


def _path(recording: Recording, arm: Arm, rows: Array) -> Array:
    """X_WE of some samples."""
    X_WE = recording.X_WE
    return arm.pose(recording.q[rows]) if X_WE is None else X_WE[rows]
