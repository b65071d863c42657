"""Which way is out of an arm's hand, as its shapes, its fingers or its last joint tell."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydrake.geometry import SceneGraphInspector
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint, RigidBody
from pydrake.systems.framework import Context

from drake_screw.typing import Array

ALONG = np.deg2rad(55.0)
"""Within which the last joint's axis is what points out of the hand."""

NEAR = 0.02
"""m; a hand no longer than that tells no direction."""


def out_of_the_hand(
    plant: MultibodyPlant,
    inspector: SceneGraphInspector,
    joints: Sequence[Joint],
    context: Context,
) -> tuple[Array, str]:
    """The direction out of the hand (3,) in the world, and what told it, in words.

    It is that from the last joint to the fingers, or else to the shapes or frames of what is fixed
    to the last link, or else from the joint before to the last one; the last joint's axis in its
    stead where that points nearly there, as it does in almost every arm.

    Args:
        plant: finalized.
        inspector: of its shapes.
        joints: of the arm, base to hand; at least one.
        context: of the plant.
    """
    joint = joints[-1]
    last, frame, world = joint.child_body(), joint.frame_on_child(), plant.world_frame()
    p_WL = frame.CalcPoseInWorld(context).translation()
    R_WL = frame.CalcRotationMatrix(context, world).matrix()
    axis = R_WL @ axis_of(joint)
    welded = {body.index() for body in plant.GetBodiesWeldedTo(last)}
    moved = plant.GetBodiesKinematicallyAffectedBy([joint.index()])
    fingers = [plant.get_body(i) for i in moved if i not in welded]
    hand = [plant.get_body(i) for i in welded]
    ways = (
        ("the fingers", _points(plant, inspector, fingers, context, origins=True)),
        ("the shapes of the hand", _points(plant, inspector, hand, context, origins=False)),
        ("frames fixed to the last link", np.array([_origin(body, context) for body in hand])),
    )
    for what, points in ways:
        if len(points) == 0:
            continue
        away = (points - p_WL).mean(axis=0)
        if np.linalg.norm(away) < NEAR:
            continue
        for sign in (1.0, -1.0):
            if angle_between(sign * axis, away) <= ALONG:
                return sign * axis, f"the last joint's axis, towards {what}"
        if what == "the fingers":
            return _snapped(away, R_WL), f"towards {what}"
    sign = 1.0
    if len(joints) > 1:
        before = joints[-2].frame_on_child().CalcPoseInWorld(context).translation()
        sign = 1.0 if axis @ (p_WL - before) >= -1e-9 else -1.0
    return sign * axis, "the last joint's axis, away from the joint before"


def axis_of(joint: Joint) -> Array:
    """(3,) the axis of a revolute or prismatic joint, in its own frames."""
    revolute = joint.type_name() == "revolute"
    return np.asarray(joint.revolute_axis() if revolute else joint.translation_axis(), dtype=float)


def angle_between(a: Array, b: Array) -> float:
    """rad, between two directions (3,)."""
    return float(np.arccos(np.clip(a @ b / (np.linalg.norm(a) * np.linalg.norm(b)), -1.0, 1.0)))


def _points(
    plant: MultibodyPlant,
    inspector: SceneGraphInspector,
    bodies: Sequence[RigidBody],
    context: Context,
    *,
    origins: bool,
) -> Array:
    """(m, 3) in the world: where the bodies' shapes are; their origins where they have none."""
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
            p_SC = np.zeros(3) if box is None else box.pose().translation()
            centres.append(X_WB @ (inspector.GetPoseInFrame(shape) @ p_SC))
        if centres:
            points.append(np.mean(centres, axis=0))
        elif origins:
            points.append(X_WB.translation())
    return np.array(points).reshape(-1, 3)


def _origin(body: RigidBody, context: Context) -> Array:
    return np.asarray(body.EvalPoseInWorld(context).translation())


def _snapped(direction: Array, R_WL: Array) -> Array:
    """A direction, or the axis of the last link's frame that is nearest to it if near."""
    axes = np.concatenate([R_WL.T, -R_WL.T])
    nearest = axes[np.argmax(axes @ direction)]
    near = angle_between(nearest, direction) <= ALONG
    return np.asarray(nearest if near else direction / np.linalg.norm(direction))
