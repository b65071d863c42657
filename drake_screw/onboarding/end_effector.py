"""The end effector of an arm: a frame of its hand, its z axis turned out of the hand."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.math import RollPitchYaw, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame, FrameIndex, RigidBody

from drake_screw.onboarding.arms import FoundArm
from drake_screw.onboarding.reading import Robot
from drake_screw.typing import Array

AGREES = np.deg2rad(10.0)
"""Within which a frame's z axis points out of the hand."""

ALONG = np.deg2rad(55.0)
"""Within which the last joint's axis is what points out of the hand."""

NEAR = 0.02
"""m; a hand no longer than that tells no direction."""

_NAMES = ("tcp", "grasp", "hand", "gripper", "tool0", "end_?eff|_ee$|^ee_|eef", "tool", "flange")
"""Of frames that end effectors are known by, the preferred ones first."""

_NOT = re.compile(r"finger|camera|optical|sensor|cam_|range|(^|_)ft_|accel|light|inertia|screw|_sc$")


@dataclass(frozen=True)
class FoundEndEffector:
    """A frame of the hand.

    Attributes:
        frame: its name in the model.
        rotation: roll, pitch and yaw in rad that turn its z axis out of the hand; None where that
            points there as it is.
        axis: (3,) the direction out of the hand, in the frame.
        derived_from: what told that direction, in words.
    """

    frame: str
    rotation: tuple[float, float, float] | None
    axis: tuple[float, float, float]
    derived_from: str


def find_end_effector(robot: Robot, arm: FoundArm) -> FoundEndEffector:
    """Choose a frame that is fixed to the last link, and how it is to be turned."""
    plant = robot.plant
    context = plant.CreateDefaultContext()
    last = plant.GetJointByName(arm.joints[-1]).child_body()
    p_out_W, derived_from = out_of_the_hand(robot, arm.joints, context)
    frames = _candidates(plant, last)
    world = plant.world_frame()
    turned = {f.name(): f.CalcRotationMatrix(context, world).matrix() for f in frames}
    upright = [f for f in frames if _angle(turned[f.name()][:, 2], p_out_W) <= AGREES]
    chosen = min(upright or frames, key=_preference)
    axis = turned[chosen.name()].T @ p_out_W
    rotation = None if upright else _turning_z_to(axis)
    return FoundEndEffector(chosen.name(), rotation, _three(axis), derived_from)


def out_of_the_hand(
    robot: Robot, joints: tuple[str, ...], context: object
) -> tuple[Array, str]:
    """The direction out of the hand (3,) in the world, and what told it.

    It is that from the last joint to the fingers, or else to what is fixed to the last link, or
    else from the joint before to the last one; the last joint's axis in its stead where that
    points nearly there, as it does in almost every arm.

    Args:
        robot: the model.
        joints: of the arm, base to hand.
        context: of the plant.
    """
    plant = robot.plant
    joint = plant.GetJointByName(joints[-1])
    last = joint.child_body()
    frame = joint.frame_on_child()
    p_WL = frame.CalcPoseInWorld(context).translation()
    axis = frame.CalcRotationMatrix(context, plant.world_frame()).matrix() @ _axis(joint)
    before = plant.GetJointByName(joints[-2]).frame_on_child().CalcPoseInWorld(context)
    welded = {body.index() for body in plant.GetBodiesWeldedTo(last)}
    moved = plant.GetBodiesKinematicallyAffectedBy([joint.index()])
    fingers = [plant.get_body(i) for i in moved if i not in welded]
    hand = [plant.get_body(i) for i in welded]
    ways = (
        ("the fingers", _points(robot, fingers, context)),
        ("the shapes of the hand", _points(robot, hand, context, origins=False)),
        ("frames fixed to the last link", _points(robot, hand, context)),
    )
    for what, points in ways:
        if len(points) == 0:
            continue
        away = (points - p_WL).mean(axis=0)
        if np.linalg.norm(away) < NEAR:
            continue
        for sign in (1.0, -1.0):
            if _angle(sign * axis, away) <= ALONG:
                return sign * axis, f"the last joint's axis, towards {what}"
        if what == "the fingers":
            return _snapped(away, frame.CalcRotationMatrix(context, plant.world_frame()).matrix()), what
    sign = 1.0 if axis @ (p_WL - before.translation()) >= -1e-9 else -1.0
    return sign * axis, "the last joint's axis, away from the joint before"


def _points(
    robot: Robot, bodies: list[RigidBody], context: object, *, origins: bool = True
) -> Array:
    """(m, 3) in the world: centres of the bodies' shapes, or their origins where they have none."""
    plant, inspector = robot.plant, robot.diagram.scene_graph().model_inspector()
    points = []
    for body in bodies:
        X_WB = body.EvalPoseInWorld(context)
        shapes = [
            *plant.GetCollisionGeometriesForBody(body),
            *plant.GetVisualGeometriesForBody(body),
        ]
        centres = []
        for shape in shapes:
            box = inspector.GetObbInGeometryFrame(shape)
            p_BC = inspector.GetPoseInFrame(shape)
            centres.append(X_WB @ (p_BC @ (box.pose().translation() if box else np.zeros(3))))
        if centres:
            points.append(np.mean(centres, axis=0))
        elif origins:
            points.append(X_WB.translation())
    return np.array(points).reshape(-1, 3)


def _candidates(plant: MultibodyPlant, last: RigidBody) -> list[Frame]:
    """Named frames fixed to the last link, each name one frame's alone."""
    welded = {body.index() for body in plant.GetBodiesWeldedTo(last)}
    frames = [plant.get_frame(FrameIndex(i)) for i in range(plant.num_frames())]
    names = [frame.name() for frame in frames]
    return [
        frame
        for frame in frames
        if frame.body().index() in welded
        and names.count(frame.name()) == 1
        and not frame.name().startswith("_")
        and not frame.name().endswith(("_parent", "_child"))
        and (frame.name() == last.name() or not _NOT.search(frame.name().lower()))
    ]


def _preference(frame: Frame) -> tuple[int, int]:
    name = frame.name().lower()
    rank = next((i for i, known in enumerate(_NAMES) if re.search(known, name)), len(_NAMES))
    return rank, len(name)


def _axis(joint: object) -> Array:
    kind = joint.type_name()  # type: ignore[attr-defined]
    axis = joint.revolute_axis() if kind == "revolute" else joint.translation_axis()  # type: ignore[attr-defined]
    return np.asarray(axis, dtype=float)


def _angle(a: Array, b: Array) -> float:
    return float(np.arccos(np.clip(a @ b / (np.linalg.norm(a) * np.linalg.norm(b)), -1.0, 1.0)))


def _snapped(direction: Array, R_WL: Array) -> Array:
    """A direction, or the axis of the last link's frame that is nearest to it if near."""
    axes = np.concatenate([R_WL.T, -R_WL.T])
    nearest = axes[np.argmax(axes @ direction)]
    near = _angle(nearest, direction) <= ALONG
    return np.asarray(nearest if near else direction / np.linalg.norm(direction))


def _turning_z_to(axis: Array) -> tuple[float, float, float]:
    """Roll, pitch and yaw of the least rotation that takes z to a direction (3,)."""
    snapped = np.round(axis)
    if np.linalg.norm(snapped) == 1.0 and _angle(snapped, axis) <= AGREES:
        axis = snapped
    turn = np.cross([0.0, 0.0, 1.0], axis)
    if np.linalg.norm(turn) < 1e-9:
        return (0.0, 0.0, 0.0) if axis[2] > 0.0 else (float(np.pi), 0.0, 0.0)
    angle = _angle(np.array([0.0, 0.0, 1.0]), axis)
    rpy = RollPitchYaw(RotationMatrix(AngleAxis(angle, turn / np.linalg.norm(turn))))
    return _three(np.round(rpy.vector(), 5) + 0.0)


def _three(values: Array) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return x, y, z
