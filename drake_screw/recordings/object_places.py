"""Where the objects were: as said, as the file has it, or as the scenario fixes it."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np

from drake_screw.demonstrations import Recording
from drake_screw.errors import RecordingError, suggestion
from drake_screw.recordings.mapping import Mapping
from drake_screw.recordings.places import Given
from drake_screw.recordings.raw import Raw
from drake_screw.recordings.resting import Resting, at_rest
from drake_screw.robot import Arm
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array


@dataclass(frozen=True, eq=False)
class Placed:
    """Where the objects were.

    Attributes:
        X_WO: (k, 4, 4); the identity where it is not known.
        said: how each was found, in words.
        missing: names of those that were not.
        notes: what is to be noted of them.
    """

    X_WO: Array
    said: tuple[str, ...]
    missing: tuple[str, ...]
    notes: tuple[str, ...]


def objects_of(
    raw: Raw, mapping: Mapping, arm: Arm, area: WorkArea, base: str, draft: Recording
) -> Placed:
    """Where the objects were: as said, as the file has it, or as the scenario fixes it.

    Args:
        raw: that may hold poses.
        mapping: that may say places.
        arm: that was led.
        area: with the k objects.
        base: the frame that poses are seen from.
        draft: the motion.

    Raises:
        RecordingError: a place is none, or of no object; a frame cannot be seen from the base.
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

    def watched(object_name: str, frame: str) -> Resting:
        seen = raw.frames.seen(
            frame, mapping.base_frame or base, named=bool(mapping.base_frame), file=raw.table.file
        )
        rows = np.flatnonzero(np.isfinite(t) & np.isfinite(draft.q).all(axis=1))
        p_WE = _path(draft, arm, rows)[:, :3, 3]
        found = at_rest(object_name, seen.t - raw.begin, seen.X, t[rows], p_WE)
        return replace(found, how=f"{found.how}, {seen.how}")

    X_WO, said, missing = [], [], []
    notes: list[str] = []
    for i, item in enumerate(area.objects):
        pose, how = np.eye(4), f"not said yet; say it with --object {item.name}=x,y"
        place = mapping.objects.get(item.name)
        source = re.fullmatch(r"(topic|frame):(.+)", place) if isinstance(place, str) else None
        if source or (item.name not in mapping.objects and raw.frames.has(item.name)):
            frame = source.group(2) if source else item.name
            found = watched(item.name, frame)
            pose, how = found.X, f"by {place or f'frame:{frame}'}: {found.how}"
            notes.extend(found.notes)
        elif item.name in mapping.objects:
            given = Given(item.name, mapping.objects[item.name], raw.table.file)
            pose, how = given.pose(item.height if item.upright else None, hand)
        elif item.name in raw.X_WO:
            pose, how = raw.X_WO[item.name], "from the file"
        elif area.settled(i):
            pose, how = area.X_WO(area.lower[None])[0, i], "fixed by the scenario"
        else:
            missing.append(item.name)
        x, y, z = pose[:3, 3]
        where = f"({x:.3f}, {y:.3f}, {z:.3f}) m, " if item.name not in missing else ""
        X_WO.append(pose)
        said.append(f"{item.name} {where}{how}")
    return Placed(np.array(X_WO), tuple(said), tuple(missing), tuple(notes))


def _path(recording: Recording, arm: Arm, rows: Array) -> Array:
    """X_WE of some samples."""
    X_WE = recording.X_WE
    return arm.pose(recording.q[rows]) if X_WE is None else X_WE[rows]


def hand_from_base(
    raw: Raw, mapping: Mapping, base: str, t: Array, X: Array
) -> tuple[Array, tuple[str, ...]]:
    """Hand poses X (m, 4, 4) at times t (m,) seen from the robot's base, and a note if need be.

    They are left as they are, with a note, where nothing says where their frame is.
    """
    base, frame = raw.frames.base(mapping.base_frame or base), raw.hand_frame
    if frame in ("", base):
        return X, ()
    try:
        X_BF = raw.frames.between(base, frame, t + raw.begin)
    except LookupError:
        note = f"the hand's poses are seen from '{frame}'; that is taken for the robot's base "
        return X, (note + f"'{base}', since no transforms lead from there to it",)
    return X_BF @ X, (f"the hand's poses were seen from '{frame}', and are from '{base}' now",)
