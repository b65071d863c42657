"""Where a robot stands: the link called its base sits at the world's origin, whatever holds it."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    Joint,
    ModelInstanceIndex,
    PlanarJoint,
    PrismaticJoint,
    RevoluteJoint,
    RigidBody,
    WeldJoint,
)

from drake_screw.errors import ModelError
from drake_screw.robot.names import called, find_frame, find_joint, scoped

WORLD = "world"
"""As a base: the models stay where they put themselves."""

SAME = 1e-12
"""m and of rotations: less is no move."""


@dataclass(frozen=True)
class Trees:
    """The links of a robot, before its plant is finalized, and the joint above each.

    Attributes:
        plant: with the robot alone.
        bodies: the robot's links.
        above: by a link's name with its model's, the joint that carries it, if one does.
    """

    plant: MultibodyPlant
    bodies: tuple[RigidBody, ...]
    above: Mapping[str, Joint]

    @classmethod
    def of(cls, plant: MultibodyPlant, robot: Sequence[ModelInstanceIndex]) -> Trees:
        """The trees of a robot's models.

        Raises:
            ModelError: two joints carry one link.
        """
        bodies = tuple(plant.get_body(i) for model in robot for i in plant.GetBodyIndices(model))
        above: dict[str, Joint] = {}
        for joint in (plant.get_joint(i) for i in plant.GetJointIndices()):
            child = scoped(joint.child_body())
            if child in above:
                raise ModelError(
                    f"joints '{above[child].name()}' and '{joint.name()}' both carry the link "
                    f"'{joint.child_body().name()}'",
                    remedy="A robot's links form a tree; leave one of the joints out.",
                )
            above[child] = joint
        return cls(plant, bodies, above)

    def way_up(self, body: RigidBody) -> list[Joint]:
        """The joints from a link up to the world or to a link that nothing carries."""
        found: list[Joint] = []
        while scoped(body) in self.above and len(found) <= len(self.above):
            found.append(self.above[scoped(body)])
            body = found[-1].parent_body()
        return found

    @property
    def loose(self) -> tuple[RigidBody, ...]:
        """Links that nothing carries."""
        world = self.plant.world_body().index()
        return tuple(b for b in self.bodies if b.index() != world and scoped(b) not in self.above)


def fix_base(
    plant: MultibodyPlant,
    robot: Sequence[ModelInstanceIndex],
    base: str,
    joints: Collection[str] = (),
    *,
    model: str = "robot",
) -> tuple[str, ...]:
    """Fix a robot so that one of its links, or a frame on one, is at the world's origin.

    Nothing is left that planning would not hold: joints above the base are replaced by welds, at
    their default positions, and so is every joint with more than one degree of freedom (planar,
    ball); links that nothing carries are welded where they are by default. Models that are fixed
    to the world already are moved as a whole; with `WORLD` for a base they stay.

    Args:
        plant: before it is finalized, with the robot alone, and its default positions set.
        robot: its models.
        base: name of a link or frame.
        joints: names of those that are to be planned for.
        model: what it is called in messages.

    Returns:
        Names of the joints that became welds, plain and scoped.

    Raises:
        ModelError: there is no such link; a joint of the arm is above it; a joint cannot be held;
            or something between world and robot cannot be moved.
    """
    if base == WORLD:
        B = plant.world_frame()
    else:
        B = find_frame(plant, base, robot, kind="link", where=f"model '{model}'")
    trees = Trees.of(plant, robot)
    above = {joint.index() for joint in trees.way_up(B.body())}
    held = []
    for joint in list(trees.above.values()):
        arm = any(called(joint, name) for name in joints)
        if arm and joint.index() in above:
            raise ModelError(
                f"joint '{joint.name()}' of the arm moves the base '{base}'",
                remedy="Take a link for the base that the arm does not move, or leave the joint "
                "out of the arm: then it is held.",
            )
        many = joint.num_positions() > 1 and not arm
        if joint.num_positions() > 0 and (many or joint.index() in above):
            held += [joint.name(), scoped(joint)]
            _weld(plant, joint, across(joint))
    trees = Trees.of(plant, robot)
    way = trees.way_up(B.body())
    X_RB = B.GetFixedPoseInBodyFrame()
    for joint in way:
        X_RB = between_links(joint) @ X_RB
    root = way[-1].parent_body() if way else B.body()
    if root.index() == plant.world_body().index():
        X_WS = X_RB.inverse()
        _move(trees, X_WS)
    else:
        X_WS = RigidTransform()
        plant.WeldFrames(plant.world_frame(), root.body_frame(), X_RB.inverse())
    for body in trees.loose:
        if body.index() != root.index():
            place = plant.GetDefaultFloatingBaseBodyPose(body)
            plant.WeldFrames(plant.world_frame(), body.body_frame(), X_WS @ place)
    return tuple(held)


def without_furniture(
    plant: MultibodyPlant, robot: Sequence[ModelInstanceIndex]
) -> tuple[ModelInstanceIndex, ...]:
    """The models that have a moving part or carry one; all of them where nothing moves.

    Args:
        plant: before it is finalized, with the robot alone, its base fixed.
        robot: its models.
    """
    trees = Trees.of(plant, robot)
    kept = set()
    for body in trees.bodies:
        way = trees.way_up(body)
        if any(joint.num_positions() > 0 for joint in way):
            kept.add(body.model_instance())
            kept.update(joint.parent_body().model_instance() for joint in way)
    return tuple(model for model in robot if model in kept) or tuple(robot)


def set_defaults(
    plant: MultibodyPlant, robot: Sequence[ModelInstanceIndex], parked: Mapping[str, float]
) -> None:
    """Make parked positions a plant's defaults, so that what hangs on them is in place.

    Raises:
        ModelError: no such joint, or it cannot be parked.
    """
    for name, value in parked.items():
        joint = find_joint(plant, name, robot)
        if joint.num_positions() != 1:
            raise ModelError(f"joint '{name}' cannot be parked: it does not have one position")
        joint.set_default_positions([value])


def across(joint: Joint) -> RigidTransform:
    """X_FM of a joint at its default position, from its frame on the parent to that on the child.

    Raises:
        ModelError: the joint is of a kind of which that is not known here.
    """
    q = joint.default_positions()
    if isinstance(joint, WeldJoint):
        return joint.X_FM()
    if isinstance(joint, RevoluteJoint):
        turn = AngleAxis(angle=q[0], axis=joint.revolute_axis())
        return RigidTransform(RotationMatrix(turn), np.zeros(3))
    if isinstance(joint, PrismaticJoint):
        return RigidTransform(q[0] * joint.translation_axis())
    if isinstance(joint, PlanarJoint):
        return RigidTransform(RotationMatrix.MakeZRotation(q[2]), [q[0], q[1], 0.0])
    if "floating" in joint.type_name():
        return joint.GetDefaultPose()
    if not any(q):
        return RigidTransform()
    raise ModelError(
        f"joint '{joint.name()}' is {joint.type_name()} and cannot be held at its default position",
        remedy="Let its default be 0, or make it fixed in the model.",
    )


def between_links(joint: Joint) -> RigidTransform:
    """X_PC of the links that a joint connects, at its default position."""
    X_PF = joint.frame_on_parent().GetFixedPoseInBodyFrame()
    X_CM = joint.frame_on_child().GetFixedPoseInBodyFrame()
    return X_PF @ across(joint) @ X_CM.inverse()


def _move(trees: Trees, X_WS: RigidTransform) -> None:
    """Move all that is fixed to the world; shapes of the world itself cannot be."""
    if X_WS.IsNearlyEqualTo(RigidTransform(), SAME):
        return
    plant, world = trees.plant, trees.plant.world_body()
    if plant.GetCollisionGeometriesForBody(world) or plant.GetVisualGeometriesForBody(world):
        raise ModelError(
            "the model has shapes that are fixed to the world, which cannot be moved with its base",
            remedy=f"Leave the model where it is, with base: {WORLD}, or give those shapes a body "
            "of their own.",
        )
    for joint in list(trees.above.values()):
        if joint.parent_body().index() != world.index():
            continue
        if not isinstance(joint, WeldJoint):
            raise ModelError(
                f"joint '{joint.name()}' moves '{joint.child_body().name()}' against the world, "
                "which the base cannot be brought to",
                remedy=f"Leave the model where it is, with base: {WORLD}.",
            )
        X_WC = X_WS @ between_links(joint)
        name, child = joint.name(), joint.child_body().body_frame()
        plant.RemoveJoint(joint)
        plant.AddJoint(WeldJoint(name, plant.world_frame(), child, X_WC))


def _weld(plant: MultibodyPlant, joint: Joint, X_FM: RigidTransform) -> None:
    """Put a weld of the same name in the place of a joint and of its motors."""
    for index in list(plant.GetJointActuatorIndices()):
        motor = plant.get_joint_actuator(index)
        if motor.joint().index() == joint.index():
            plant.RemoveJointActuator(motor)
    name, F, M = joint.name(), joint.frame_on_parent(), joint.frame_on_child()
    plant.RemoveJoint(joint)
    plant.AddJoint(WeldJoint(name, F, M, X_FM))
