"""From columns to a recording: what a mapping says, and what can be told where it says nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drake_screw.demonstrations import Recording
from drake_screw.demonstrations.hand_eye import check_objects
from drake_screw.demonstrations.hand_poses import checked_hand
from drake_screw.demonstrations.recording import CLAMPED_WITHIN, checked
from drake_screw.demonstrations.turns import whole_turns
from drake_screw.errors import RecordingError, suggestion
from drake_screw.recordings.ends import of_ranges
from drake_screw.recordings.episodes import coordinates, episodes, hint
from drake_screw.recordings.hand_columns import hand_columns, hand_path, reached
from drake_screw.recordings.joint_columns import Matched, match_joints
from drake_screw.recordings.mapping import FILE, Mapping
from drake_screw.recordings.object_places import hand_from_base, objects_of
from drake_screw.recordings.places import FORMS
from drake_screw.recordings.raw import Raw
from drake_screw.recordings.time_column import Time, gaps_in_words, rate_in_words, time_of
from drake_screw.recordings.understood import Robot, Understood
from drake_screw.recordings.which_arm import travel
from drake_screw.robot import Arm
from drake_screw.screws.endless import TURN
from drake_screw.tables import Table
from drake_screw.typing import Array

LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
MOST = 0.99
"""Part of the samples that have to be within the limits for a unit to be that of the angles."""


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
    table = raw.table
    if not len(table):
        raise RecordingError("no rows", remedy="Record it again.", file=table.file)
    time = time_of(table, mapping)
    motion = _motion(raw, mapping, robot, time)
    draft = Recording(
        raw.name, motion.joints, time.t, motion.q, np.tile(np.eye(4), (len(robot.names), 1, 1)),
        notes=(*raw.notes, *motion.notes), X_WE=motion.X_WE,
        source=None if table.file is None else table.file.resolve(),
    )  # fmt: skip
    placed = objects_of(raw, mapping, robot.arm, robot.area, robot.base, draft)
    name, table = raw.name, table.without_columns()
    del raw  # of a long recording the columns take most of the room
    if placed.missing and objects_needed:
        lost = placed.missing[0]
        raise RecordingError(
            f"where was the {lost}? The file does not say",
            remedy=f"Say it with --object {lost}=x,y, or in {FILE} under objects. {FORMS}",
            file=table.file,
        )
    found = _checked(draft, table, robot)
    several = hint(time.t, motion.coordinates) if mapping.episodes is None else ()
    found = replace(found, notes=(*found.notes, *placed.notes, *several))
    if not placed.missing:
        found = replace(found, X_WO=placed.X_WO)
        notes = check_objects(found, robot.arm, robot.names, robot.base, file=table.file)
        found = replace(found, notes=(*found.notes, *notes))
    said = mapping.with_(
        format=format,
        **motion.keys,
        **{k: tuple(v) if isinstance(v, list) else v for k, v in time.keys.items()},
    )
    facts = (
        ("format", f"{format}, {table.about}" if table.about else format),
        ("rows", f"{len(table):,}, {found.duration:.2f} s of motion, {rate_in_words(time.t)}"),
        ("time", time.said),
        *motion.facts,
        ("gaps", gaps_in_words(time.t)),
        *(("object", line) for line in placed.said),
        *(("note", note) for note in found.notes),
    )
    kept = None if placed.missing else found
    return Understood(kept, name, facts, said, travel(found.q))


@dataclass(frozen=True, eq=False)
class _Motion:
    """Of joints q (m, n), or of the hand X_WE (m, 4, 4); how it was found, as keys and words."""

    joints: tuple[str, ...]
    q: Array
    X_WE: Array | None
    keys: dict[str, Any]
    facts: tuple[tuple[str, str], ...]
    notes: tuple[str, ...] = ()

    @property
    def coordinates(self) -> Array:
        """What moves, as `episodes.coordinates` has it."""
        return coordinates(self.q, self.X_WE)


def episodes_of(raw: Raw, mapping: Mapping, robot: Robot) -> tuple[Raw, ...]:
    """The recordings that one file holds, where its mapping says that it is to be cut.

    Raises:
        RecordingError: something cannot be told, or there is nothing to cut it by.
    """
    if mapping.episodes is None or not len(raw.table):
        return (raw,)
    mapping = mapping.with_told(dict(raw.told))
    time = time_of(raw.table, mapping)
    motion = _motion(raw, mapping, robot, time)
    return episodes(raw, mapping, time.t, motion.coordinates)


def _motion(raw: Raw, mapping: Mapping, robot: Robot, time: Time) -> _Motion:
    """The joints' motion where there are joints, else the hand's.

    Raises:
        RecordingError: there is neither.
    """
    arm, table = robot.arm, raw.table
    matched = None if mapping.hand else _joints(table, mapping, arm, time)
    hand = hand_columns(table, mapping) if matched is None else None
    if matched is None and hand is None:
        raise RecordingError(
            f"no columns of the arm's joints: {', '.join(arm.joint_names)}",
            remedy=f"Say joints: [...], {arm.n} columns in this order, in {FILE}; or, of hand "
            "poses, hand: [...]. If another robot made the recording, describe it in the "
            f"scenario's block recorded_on. Columns found: {', '.join(table.names[:40])}",
            file=table.file,
            line=table.header,
        )
    if matched is None and hand is not None:
        X_FE, unit = hand_path(table, hand, mapping), mapping.lengths or "m"
        X_WE, notes = hand_from_base(raw, mapping, robot.base, time.t, X_FE)
        keys: dict[str, Any] = {"hand": hand.columns, "lengths": unit}
        if hand.order != "matrix":
            keys["quaternion"] = hand.order
        facts = (("hand", hand.how), ("arm", reached(arm, X_WE, time.t)))
        return _Motion((), np.zeros((len(table), 0)), X_WE, keys, facts, notes)
    assert matched is not None
    q, angles, lengths, said = _angles(table, matched, mapping, robot)
    listed = f"{matched.how}: {', '.join(matched.columns)}"
    return _Motion(
        arm.joint_names,
        q,
        None,
        {"joints": matched.columns, "angles": angles, "lengths": lengths},
        (("joints", listed), ("angles", said)),
    )


def _checked(draft: Recording, table: Table, robot: Robot) -> Recording:
    if draft.X_WE is not None:
        return checked_hand(draft, file=table.file, lines=table.lines)
    arm = robot.arm
    return checked(
        draft, arm.lower, arm.upper, file=table.file, lines=table.lines, units=arm.units,
        velocity_limits=robot.velocity_limits,
    )  # fmt: skip


def _joints(table: Table, mapping: Mapping, arm: Arm, time: Time) -> Matched | None:
    """The columns of the arm's joints, if there are any.

    Raises:
        RecordingError: there are several, or those that are said are not there.
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
    any_order = hand_columns(table, mapping) is None
    return match_joints(table, arm.joint_names, time.columns, any_order=any_order)


def _angles(
    table: Table, matched: Matched, mapping: Mapping, robot: Robot
) -> tuple[Array, str, str | None, str]:
    """Joint positions (m, n) in rad and m, their units, and how these were recognised."""
    arm = robot.arm
    raw = np.empty((len(table), arm.n))
    for j, name in enumerate(matched.columns):
        raw[:, j] = table.numbers(name)
    turns = np.array([unit == "rad" for unit in arm.units])
    if mapping.angles == "percent":
        q, said = of_ranges(raw, arm, mapping.ends, table.file)
        return q, "percent", None, said
    if mapping.ends:
        raise RecordingError(
            "ends: said of joints that are not in per cent of them",
            remedy=f"Say angles: percent as well in {FILE}, or leave ends out.",
            file=table.file,
        )
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

    rows = np.isfinite(raw).all(axis=1)
    finite = raw if rows.all() else raw[rows]
    if not len(finite) or within(finite):
        return "rad", "within the arm's limits"
    off = whole_turns(finite, arm.lower, arm.upper, arm.units, CLAMPED_WITHIN)
    if within(finite - off * TURN):
        return "rad", "within the arm's limits but for whole turns"
    degrees = np.where(turns, np.deg2rad(finite), finite)
    if np.abs(finite[:, turns]).max() > TURN and within(degrees):
        return "deg", "beyond a whole turn as radians, within the arm's limits as degrees"
    return "rad", "taken for granted"
