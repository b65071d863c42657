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
from drake_screw.robot.hand import angle_between, out_of_the_hand
from drake_screw.robot.names import find_joint
from drake_screw.typing import Array

AGREES = np.deg2rad(10.0)
"""Within which a frame's z axis points out of the hand."""

_NAMES = ("tcp", "grasp", "hand", "gripper", "tool0", "end_?eff|_ee$|^ee_|eef", "tool", "flange")
"""Of frames that end effectors are known by, the preferred ones first."""

_NOT = re.compile(
    r"finger|camera|optical|sensor|cam_|range|(^|_)ft_|accel|light|inertia|screw|_sc$"
)


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
    joints = [find_joint(plant, name) for name in arm.joints]
    inspector = robot.diagram.scene_graph().model_inspector()
    p_out_W, derived_from = out_of_the_hand(plant, inspector, joints, context)
    frames = _candidates(plant, joints[-1].child_body())
    world = plant.world_frame()
    turned = {f.name(): f.CalcRotationMatrix(context, world).matrix() for f in frames}
    upright = [f for f in frames if angle_between(turned[f.name()][:, 2], p_out_W) <= AGREES]
    chosen = min(upright or frames, key=_preference)
    axis = turned[chosen.name()].T @ p_out_W
    rotation = None if upright else _turning_z_to(axis)
    return FoundEndEffector(chosen.name(), rotation, _three(axis), derived_from)


def _candidates(plant: MultibodyPlant, last: RigidBody) -> list[Frame]:
    """Named frames fixed to the last link, each name one frame's alone."""
    welded = {body.index() for body in plant.GetBodiesWeldedTo(last)}
    frames = [plant.get_frame(FrameIndex(i)) for i in range(plant.num_frames())]
    names = [frame.name() for frame in frames]
    joints = tuple(f"{plant.get_joint(i).name()}_" for i in plant.GetJointIndices())
    return [
        frame
        for frame in frames
        if frame.body().index() in welded
        and names.count(frame.name()) == 1
        and (frame.is_body_frame() or not _made_by_drake(frame.name(), joints))
        and (frame.name() == last.name() or not _NOT.search(frame.name().lower()))
    ]


def _made_by_drake(name: str, joints: tuple[str, ...]) -> bool:
    """Whether a frame is one that Drake makes at an end of a joint; `joints` are names and "_"."""
    ends = ("_parent", "_child", "_F", "_M")
    return name.startswith("_") or (name.startswith(joints) and name.endswith(ends))


def _preference(frame: Frame) -> tuple[int, int]:
    name = frame.name().lower()
    rank = next((i for i, known in enumerate(_NAMES) if re.search(known, name)), len(_NAMES))
    return rank, len(name)


def _turning_z_to(axis: Array) -> tuple[float, float, float]:
    """Roll, pitch and yaw of the least rotation that takes z to a direction (3,)."""
    snapped = np.round(axis)
    if np.linalg.norm(snapped) == 1.0 and angle_between(snapped, axis) <= AGREES:
        axis = snapped
    turn = np.cross([0.0, 0.0, 1.0], axis)
    if np.linalg.norm(turn) < 1e-9:
        return (0.0, 0.0, 0.0) if axis[2] > 0.0 else (float(np.pi), 0.0, 0.0)
    angle = angle_between(np.array([0.0, 0.0, 1.0]), axis)
    rpy = RollPitchYaw(RotationMatrix(AngleAxis(angle, turn / np.linalg.norm(turn))))
    return _three(np.round(rpy.vector(), 5) + 0.0)


def _three(values: Array) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return x, y, z
