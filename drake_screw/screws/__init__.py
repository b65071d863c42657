"""Screw geometry on SE(3) with numpy, batched over leading axes. Knows no robot and no Drake."""

from drake_screw.screws.dual_quaternions import (
    dual_quaternion_conjugate,
    dual_quaternion_from_pose,
    dual_quaternion_from_screw,
    dual_quaternion_multiply,
    dual_quaternion_power,
    pose_from_dual_quaternion,
)
from drake_screw.screws.interpolation import (
    Screw,
    nearest_on_screw,
    sclerp,
    screw_between,
    screw_from_twist,
)
from drake_screw.screws.poses import (
    adjoint,
    exp,
    inverse,
    log,
    normalized,
    pose,
    pose_from_planar,
    quaternion_distance,
    rotation_angle,
    translation_distance,
)
from drake_screw.screws.rotations import (
    quaternion_conjugate,
    quaternion_from_rotation,
    quaternion_from_rotation_vector,
    quaternion_multiply,
    rotation_from_quaternion,
    rotation_vector_from_quaternion,
    skew,
)

__all__ = [
    "Screw",
    "adjoint",
    "dual_quaternion_conjugate",
    "dual_quaternion_from_pose",
    "dual_quaternion_from_screw",
    "dual_quaternion_multiply",
    "dual_quaternion_power",
    "exp",
    "inverse",
    "log",
    "nearest_on_screw",
    "normalized",
    "pose",
    "pose_from_dual_quaternion",
    "pose_from_planar",
    "quaternion_conjugate",
    "quaternion_distance",
    "quaternion_from_rotation",
    "quaternion_from_rotation_vector",
    "quaternion_multiply",
    "rotation_angle",
    "rotation_from_quaternion",
    "rotation_vector_from_quaternion",
    "sclerp",
    "screw_between",
    "screw_from_twist",
    "skew",
    "translation_distance",
]
