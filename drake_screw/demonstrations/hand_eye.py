"""Whether objects can have stood where a recording says, by where the hand was."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from drake_screw.demonstrations.recording import Recording
from drake_screw.errors import RecordingError
from drake_screw.typing import Array

if TYPE_CHECKING:
    from drake_screw.robot.arm import Arm

NEAR = 0.5
"""m. The end effector never is farther than this from an object that it works on."""
FAR = 1.0
"""m. Where it comes no nearer to any object, the poses are wrong."""
LOOKED_AT = 300
"""Samples of a recording."""
NOWHERE = 5.0
"""m from the end effector; no object of a table is there, whatever the others."""


def check_object_poses(
    X_WE: Array,
    X_WO: Array,
    names: Sequence[str],
    world: str,
    *,
    file: Path | None = None,
) -> tuple[str, ...]:
    """Refuse object poses that cannot be, and say which are doubtful.

    Args:
        X_WE: (m, 4, 4) the end effector's path, or some of it.
        X_WO: (k, 4, 4).
        names: of the k objects.
        world: the frame that both are seen from.
        file: named in errors.

    Returns:
        A note where the end effector stays farther than `NEAR` from every object.

    Raises:
        RecordingError: an object is nowhere near, for its unit or frame probably.
    """
    p = X_WE[:, :3, 3]
    with np.errstate(over="ignore"):
        away = np.linalg.norm(p[:, None] - X_WO[None, :, :3, 3], axis=-1).min(axis=0)
    nearest = int(np.argmin(away))
    wrong = int(np.argmax(away)) if away.max() > NOWHERE else nearest
    if away[wrong] > FAR and (away[wrong] > NOWHERE or wrong == nearest):
        x, y, z = X_WO[wrong, :3, 3]
        raise RecordingError(
            f"the {names[wrong]} at ({x:.4g}, {y:.4g}, {z:.4g}) m is {away[wrong]:.2f} m from "
            "where the hand comes nearest to it",
            remedy=_why(X_WO[wrong, :3, 3], p, world),
            file=file,
        )
    if away[nearest] <= NEAR:
        return ()
    return (
        f"the hand never comes within {NEAR:g} m of any object: {away[nearest]:.2f} m from the "
        f"{names[nearest]} at the nearest",
    )


def check_objects(
    recording: Recording, arm: Arm, names: Sequence[str], world: str, *, file: Path | None = None
) -> tuple[str, ...]:
    """`check_object_poses` of a recording, on some of its samples.

    Args:
        recording: with its objects.
        arm: that was led.
        names, world, file: see there.

    Raises:
        RecordingError: see there.
    """
    some = np.unique(np.linspace(0, len(recording.t) - 1, LOOKED_AT).astype(int))
    X_WE = recording.X_WE
    path = arm.pose(recording.q[some]) if X_WE is None else X_WE[some]
    return check_object_poses(path, recording.X_WO, names, world, file=file)


def _why(p_WO: Array, p_WE: Array, world: str) -> str:
    """The likely reason, by what would bring the object near the hand."""

    def near(place: Array) -> bool:
        with np.errstate(over="ignore"):
            return bool(np.linalg.norm(p_WE - place, axis=1).min() <= NEAR)

    if near(p_WO / 1000.0) or np.abs(p_WO).max() > 50.0:
        return "It looks like millimetres: object poses are in metres."
    turned = {
        "turned by half a turn about z": np.array([-p_WO[0], -p_WO[1], p_WO[2]]),
        "turned by a quarter turn about z": np.array([-p_WO[1], p_WO[0], p_WO[2]]),
        "turned by a quarter turn back about z": np.array([p_WO[1], -p_WO[0], p_WO[2]]),
    }
    for how, place in turned.items():
        if near(place):
            return (
                f"It looks like another frame, {how}: object poses are seen from '{world}', the "
                "scenario's robot.base."
            )
    x, y, z = p_WE.mean(axis=0)
    return (
        f"Another frame? Object poses are in metres, seen from '{world}', the scenario's "
        f"robot.base; the hand is about ({x:.2f}, {y:.2f}, {z:.2f}) there."
    )
