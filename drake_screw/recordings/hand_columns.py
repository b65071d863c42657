"""Which columns are the hand's poses, if there are no joints; whether the arm reaches them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drake_screw.demonstrations.hand_poses import poses
from drake_screw.errors import RecordingError
from drake_screw.recordings.mapping import Mapping
from drake_screw.robot import Arm
from drake_screw.screws import inverse, log, normalized
from drake_screw.tables import Table
from drake_screw.typing import Array

LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
LOOKED_AT = 12
"""Hand poses that are tried with the arm."""
_ARRIVED = (2e-3, 2e-2)  # m, rad
_ENDS = (
    ("position.x", "position.y", "position.z"),
    ("translation.x", "translation.y", "translation.z"),
    ("pos_x", "pos_y", "pos_z"),
    ("tx", "ty", "tz"),
    ("px", "py", "pz"),
    ("x", "y", "z"),
)
_TURNS = (
    ("orientation.x", "orientation.y", "orientation.z", "orientation.w"),
    ("rotation.x", "rotation.y", "rotation.z", "rotation.w"),
    ("rot_x", "rot_y", "rot_z", "rot_w"),
    ("quat_x", "quat_y", "quat_z", "quat_w"),
    ("qx", "qy", "qz", "qw"),
    ("q_x", "q_y", "q_z", "q_w"),
)
_MATRIX = r"O_T_EE[_\[.]?(\d+)\]?$"


@dataclass(frozen=True)
class HandColumns:
    """Seven columns, or sixteen of a matrix column by column; the quaternion's order."""

    columns: tuple[str, ...]
    order: str
    how: str


def hand_columns(table: Table, mapping: Mapping) -> HandColumns | None:
    """The columns of hand poses, as said or by their names; None where there are none.

    Raises:
        RecordingError: the mapping's are not seven or sixteen, or the quaternion's order is not
            said and not in the names.
    """
    if mapping.hand is None:
        return _by_name(table)
    columns = mapping.hand
    table.require(columns)
    if len(columns) == 16:
        return HandColumns(columns, "matrix", "as said, a matrix column by column")
    if len(columns) != 7:
        raise RecordingError(
            f"hand: {len(columns)} columns, where 7 (x, y, z and a quaternion) or 16 are needed",
            remedy="Say hand: [x, y, z, qx, qy, qz, qw] with your columns, and quaternion: xyzw.",
            file=table.file,
        )
    order = mapping.quaternion
    if order is None and columns[6].lower().endswith("w"):
        order = "xyzw"
    if order is None and columns[3].lower().endswith("w"):
        order = "wxyz"
    if order is None:
        raise RecordingError(
            "hand: the order of the quaternion's columns is not said",
            remedy="Say quaternion: xyzw or quaternion: wxyz in recording.yaml; it is never "
            "guessed from numbers.",
            file=table.file,
        )
    return HandColumns(columns, order, f"as said, quaternion {order}")


def _by_name(table: Table) -> HandColumns | None:
    numbered = {int(m.group(1)): n for n in table.numeric if (m := re.search(_MATRIX, n))}
    if sorted(numbered) == list(range(16)):
        columns = tuple(numbered[i] for i in range(16))
        return HandColumns(columns, "matrix", "by name, O_T_EE column by column")
    known = {name.lower(): name for name in table.numeric}
    places = [names for ends in _ENDS if (names := _ending(known, ends))]
    turns = [names for ends in _TURNS if (names := _ending(known, ends))]
    if not places or not turns:
        return None
    columns = (*places[0], *turns[0])
    return HandColumns(columns, "xyzw", f"by name: {', '.join(columns)}")


def _ending(known: dict[str, str], ends: Sequence[str]) -> tuple[str, ...] | None:
    """The columns of one beginning with each of these ends."""
    for name in known:
        if name.endswith(ends[0]):
            before = name[: -len(ends[0])]
            if before and before[-1].isalnum():
                continue
            if all(f"{before}{end}" in known for end in ends):
                return tuple(known[f"{before}{end}"] for end in ends)
    return None


def hand_path(table: Table, hand: HandColumns, mapping: Mapping) -> Array:
    """X_WE (m, 4, 4).

    Raises:
        RecordingError: a row is no pose.
    """
    values = np.stack([table.numbers(name) for name in hand.columns], axis=1)
    scale = LENGTHS[mapping.lengths or "m"]
    if hand.order == "matrix":
        X = np.swapaxes(values.reshape(-1, 4, 4), 1, 2).copy()
        R = X[:, :3, :3]
        wrong = np.abs(np.swapaxes(R, 1, 2) @ R - np.eye(3)).max(axis=(1, 2)) > 1e-2
        if wrong.any() or not np.isfinite(X).all():
            row = int(np.argmax(wrong | ~np.isfinite(X).all(axis=(1, 2))))
            raise RecordingError(
                "not a pose: its 3 x 3 part is no rotation",
                remedy="The 16 columns are taken column by column, as Franka's O_T_EE.",
                file=table.file,
                line=int(table.lines[row]),
            )
        X = normalized(X)
    else:
        q = values[:, 3:]
        X = poses(
            values[:, :3], np.roll(q, 1, axis=1) if hand.order == "xyzw" else q, table.file,
            table.lines,
        )  # fmt: skip
    X[:, :3, 3] *= scale
    return X


def reached(arm: Arm, X_WE: Array, t: Array) -> str:
    """A remark on how many of some hand poses the arm gets to, by inverse kinematics.

    Args:
        arm: that is to do it.
        X_WE: (m, 4, 4).
        t: (m,) s.
    """
    some = np.unique(np.linspace(0, len(t) - 1, LOOKED_AT).astype(int))
    rng = np.random.default_rng(0)
    lower, upper = np.maximum(arm.lower, -np.pi), np.minimum(arm.upper, np.pi)
    seeds = [arm.middle, *rng.uniform(lower, upper, (8, arm.n))]
    missed = []
    for i in some.tolist():
        found = next((q for q in (_solve(arm, X_WE[i], s) for s in seeds) if q is not None), None)
        if found is None:
            missed.append(i)
        else:
            seeds[0] = found
    if not missed:
        return f"the arm reaches all {len(some)} of the hand poses looked at"
    return (
        f"the arm does not reach {len(missed)} of the {len(some)} hand poses looked at, the first "
        f"at {t[missed[0]]:.2f} s: check that they are of '{arm.end_effector}'"
    )


def _solve(arm: Arm, X_WE: Array, q: Array) -> Array | None:
    """A configuration (n,) within the limits; damped least squares from another."""
    for _ in range(60):
        X, J = arm.pose_and_jacobian(q)
        V = log(X_WE @ inverse(X))
        V = np.concatenate([V[:3], X_WE[:3, 3] - X[:3, 3]])
        if np.linalg.norm(V[3:]) < _ARRIVED[0] and np.linalg.norm(V[:3]) < _ARRIVED[1]:
            return q
        dq = J.T @ np.linalg.solve(J @ J.T + 1e-3 * np.eye(6), V)
        dq *= min(1.0, 0.4 / max(float(np.abs(dq).max()), 1e-12))
        q = np.clip(q + dq, arm.lower, arm.upper)
    return None
