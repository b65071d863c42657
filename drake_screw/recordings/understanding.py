"""From columns to a recording: what a mapping says, and what can be told where it says nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from drake_screw.demonstrations import Recording
from drake_screw.demonstrations.hand_eye import check_object_poses
from drake_screw.demonstrations.recording import CLAMPED_WITHIN, GAP, checked
from drake_screw.demonstrations.turns import whole_turns
from drake_screw.errors import RecordingError, suggestion
from drake_screw.recordings.joint_columns import Matched, match_joints
from drake_screw.recordings.mapping import FILE, Mapping
from drake_screw.recordings.places import FORMS, Given
from drake_screw.recordings.raw import Raw
from drake_screw.recordings.time_column import Time, time_of
from drake_screw.robot import Arm
from drake_screw.screws.endless import TURN
from drake_screw.tables import Table
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array

LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
MOST = 0.99
"""Part of the samples that have to be within the limits for a unit to be that of the angles."""
LOOKED_AT = 300
"""Samples that object poses are held against."""


@dataclass(frozen=True)
class Robot:
    """What a recording is understood with.

    Attributes:
        arm: that was led.
        area: the objects, and where they may be.
        base: name of the frame that poses are seen from.
        velocity_limits: (n,) rad/s or m/s.
    """

    arm: Arm
    area: WorkArea
    base: str
    velocity_limits: Array

    @property
    def names(self) -> tuple[str, ...]:
        """Of the objects."""
        return tuple(item.name for item in self.area.objects)


@dataclass(frozen=True, eq=False)
class Understood:
    """A recording, and how its file was understood.

    Attributes:
        recording: ready for use; None where the objects' places are not said yet.
        name: its name.
        facts: what was understood, in pairs of words.
        mapping: that says all of it.
    """

    recording: Recording | None
    name: str
    facts: tuple[tuple[str, str], ...]
    mapping: Mapping


def understand(
    raw: Raw, mapping: Mapping, robot: Robot, *, format: str, objects_needed: bool = True
) -> Understood:
    """Make a recording of columns.

    Args:
        raw: the columns.
        mapping: what is said of them.
        robot: that made it.
        format: in which it was read, for the facts.
        objects_needed: whether it is an error if it is not said where an object was.

    Raises:
        RecordingError: something cannot be told, or cannot be true.
    """
    mapping = mapping.with_told(dict(raw.told))
    table, arm = raw.table, robot.arm
    if not len(table):
        raise RecordingError("no rows", remedy="Record it again.", file=table.file)
    time = time_of(table, mapping)
    matched = _joints(table, mapping, arm, time)
    q, angles, slides, unit_said = _angles(table, matched, mapping, robot)
    draft = Recording(
        raw.name, arm.joint_names, time.t, q, np.tile(np.eye(4), (len(robot.names), 1, 1)),
        notes=raw.notes, source=None if table.file is None else table.file.resolve(),
    )  # fmt: skip
    X_WO, places, missing = _objects(raw, mapping, robot, time.t, q)
    if missing and objects_needed:
        raise RecordingError(
            f"where was the {missing[0]}? The file does not say",
            remedy=f"Say it with --object {missing[0]}=x,y, or in {FILE} under objects. {FORMS}",
            file=table.file,
        )
    found = checked(
        draft, arm.lower, arm.upper, file=table.file, lines=table.lines, units=arm.units,
        velocity_limits=robot.velocity_limits,
    )  # fmt: skip
    if not missing:
        notes = _seen(found.q, X_WO, robot, table.file)
        found = replace(found, X_WO=X_WO, notes=(*found.notes, *notes))
    said = mapping.with_(
        format=format,
        joints=matched.columns,
        angles=angles,
        lengths=slides,
        **{k: tuple(v) if isinstance(v, list) else v for k, v in time.keys.items()},
    )
    facts = (
        ("format", f"{format}, {table.about}" if table.about else format),
        ("rows", f"{len(table):,}, {found.duration:.2f} s of motion, {_rate(time.t)}"),
        ("time", time.said),
        ("joints", f"{matched.how}: {', '.join(matched.columns)}"),
        ("angles", unit_said),
        ("gaps", _gaps(time.t)),
        *(("object", line) for line in places),
        *(("note", note) for note in found.notes),
    )
    return Understood(None if missing else found, raw.name, facts, said)


def _joints(table: Table, mapping: Mapping, arm: Arm, time: Time) -> Matched:
    """The columns of the arm's joints.

    Raises:
        RecordingError: there are none, or several.
    """
    said = mapping.joints
    if isinstance(said, dict):
        for name in said:
            if name not in arm.joint_names:
                raise RecordingError(
                    f"joints: '{name}' is no joint of the arm",
                    remedy=suggestion(name, arm.joint_names, "Joints"),
                    file=table.file,
                )
        said = tuple(said.get(name, name) for name in arm.joint_names)
    if said is not None:
        if len(said) != arm.n:
            raise RecordingError(
                f"joints: {len(said)} columns for the {arm.n} joints of the arm",
                remedy=f"Name a column for each of {', '.join(arm.joint_names)}, in this order.",
                file=table.file,
            )
        table.require(said)
        return Matched(tuple(said), "as said")
    found = match_joints(table, arm.joint_names, time.columns)
    if found is None:
        raise RecordingError(
            f"no columns of the arm's joints: {', '.join(arm.joint_names)}",
            remedy=f"Say joints: [...], {arm.n} columns in this order, in {FILE}. If another robot "
            "made the recording, describe it in the scenario's block recorded_on. Columns found: "
            + ", ".join(table.names[:40]),
            file=table.file,
            line=table.header,
        )
    return found


def _angles(
    table: Table, matched: Matched, mapping: Mapping, robot: Robot
) -> tuple[Array, str, str | None, str]:
    """Joint positions (m, n) in rad and m, their units, and how these were recognised."""
    arm = robot.arm
    raw = np.stack([table.numbers(name) for name in matched.columns], axis=1)
    turns = np.array([unit == "rad" for unit in arm.units])
    lengths = mapping.lengths if (~turns).any() else None
    if lengths is None and (~turns).any():
        lengths = "m"
    raw[:, ~turns] *= LENGTHS[lengths or "m"]
    if mapping.angles is not None:
        unit, why = str(mapping.angles), "as said"
    else:
        unit, why = _told(raw, turns, [*matched.columns], arm)
    if unit == "deg":
        raw[:, turns] = np.deg2rad(raw[:, turns])
    return raw, unit, lengths, f"{'degrees' if unit == 'deg' else 'radians'}, {why}"


def _told(raw: Array, turns: Array, columns: Sequence[str], arm: Arm) -> tuple[str, str]:
    if all("deg" in name.lower() for name in columns):
        return "deg", "by the columns' names"

    def within(q: Array) -> bool:
        inside = (q >= arm.lower - CLAMPED_WITHIN) & (q <= arm.upper + CLAMPED_WITHIN)
        return bool(inside.all(axis=1).mean() >= MOST)

    finite = raw[np.isfinite(raw).all(axis=1)]
    if not len(finite) or within(finite):
        return "rad", "within the arm's limits"
    off = whole_turns(finite, arm.lower, arm.upper, arm.units, CLAMPED_WITHIN)
    if within(finite - off * TURN):
        return "rad", "within the arm's limits but for whole turns"
    degrees = np.where(turns, np.deg2rad(finite), finite)
    if np.abs(finite[:, turns]).max() > TURN and within(degrees):
        return "deg", "beyond a whole turn as radians, within the arm's limits as degrees"
    return "rad", "taken for granted"


def _objects(
    raw: Raw, mapping: Mapping, robot: Robot, t: Array, q: Array
) -> tuple[Array, list[str], list[str]]:
    """X_WO (k, 4, 4), how each was found, and the names of those that were not."""
    for name in mapping.objects:
        if name not in robot.names:
            raise RecordingError(
                f"no object '{name}' in the scenario",
                remedy=suggestion(name, robot.names, "Objects"),
                file=raw.table.file,
            )

    def hand(time: float) -> Array:
        if not 0.0 <= time <= t[-1]:
            raise RecordingError(
                f"hand:{time:g}s: the recording lasts from 0 to {t[-1]:.2f} s",
                remedy="Give a time in s since its first sample.",
                file=raw.table.file,
            )
        return robot.arm.pose(q[int(np.argmin(np.abs(t - time)))])

    X_WO, said, missing = [], [], []
    for i, item in enumerate(robot.area.objects):
        pose, how = np.eye(4), "not said yet"
        if item.name in mapping.objects:
            given = Given(item.name, mapping.objects[item.name])
            pose, how = given.pose(float(robot.area.z[i]), hand)
        elif item.name in raw.X_WO:
            pose, how = raw.X_WO[item.name], "from the file"
        elif item.lower == item.upper:
            pose, how = robot.area.X_WO(robot.area.lower[None])[0, i], "fixed by the scenario"
        else:
            missing.append(item.name)
        x, y, z = pose[:3, 3]
        place = f"({x:.3f}, {y:.3f}, {z:.3f}) m, " if item.name not in missing else ""
        X_WO.append(pose)
        said.append(f"{item.name} {place}{how}")
    return np.array(X_WO), said, missing


def _seen(q: Array, X_WO: Array, robot: Robot, file: Path | None) -> tuple[str, ...]:
    some = np.unique(np.linspace(0, len(q) - 1, LOOKED_AT).astype(int))
    X_WE = robot.arm.pose(q[some])
    return check_object_poses(X_WE, X_WO, robot.names, robot.base, file=file)


def _rate(t: Array) -> str:
    moving = np.diff(t)[np.diff(t) > 0.0]
    return f"about {1.0 / np.median(moving):.4g} Hz" if len(moving) else "of unknown rate"


def _gaps(t: Array) -> str:
    steps = np.diff(t)
    long = np.flatnonzero(steps > GAP)
    if not len(long):
        return f"none; the longest step is {steps.max(initial=0.0):.3f} s"
    return f"{len(long)} of more than {GAP:g} s, the first at {t[long[0]]:.2f} s"
