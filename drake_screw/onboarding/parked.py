"""Where the joints rest that do not belong to the arm."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint
from pydrake.systems.framework import Context

from drake_screw.onboarding.arms import FoundArm
from drake_screw.onboarding.reading import Robot
from drake_screw.robot.names import find_joint, scoped

WIDE_OPEN = 0.8
"""Part of the way from its default to its end that a finger is opened."""

DRIVES = 3
"""Fingers of a gripper at most that are opened; hands with more stay as they are."""

TUCKED = 400
"""Configurations among which that of another arm is chosen."""

DIGITS = 3
"""Of rad or m, to which values are rounded."""


def parked(robot: Robot, arm: FoundArm, others: Sequence[FoundArm]) -> dict[str, float]:
    """Values in rad or m of all joints outside the arm, by name.

    Fingers are opened, other arms hang or point to the back where that touches nothing, and all
    other joints have the model's default, moved into their limits.
    """
    plant = robot.plant
    rest: dict[str, float] = {}
    names = [plant.get_joint(i).name() for i in plant.GetJointIndices()]
    for index in plant.GetJointIndices():
        joint = plant.get_joint(index)
        name = joint.name() if names.count(joint.name()) == 1 else scoped(joint)
        if joint.num_positions() == 1 and name not in arm.joints and name not in robot.mimics:
            rest[name] = _within(joint, float(joint.default_positions()[0]))
    drives = [name for name in arm.fingers if name not in robot.mimics]
    if len(drives) <= DRIVES:
        rest |= _opened(robot, arm, rest)
    for other in others:
        rest |= _tucked(robot, arm, other, rest)
    return {name: round(value, DIGITS) + 0.0 for name, value in rest.items()}


def _within(joint: Joint, value: float) -> float:
    lower, upper = joint.position_lower_limits()[0], joint.position_upper_limits()[0]
    return float(np.clip(value, lower, upper))


def _opened(robot: Robot, arm: FoundArm, rest: dict[str, float]) -> dict[str, float]:
    """Fingers, each moved to where what it carries is farthest from the hand's axis."""
    plant, opened = robot.plant, {}
    last = find_joint(plant, arm.joints[-1])
    for name in (name for name in arm.fingers if name not in robot.mimics):
        joint = find_joint(plant, name)
        lower, upper = joint.position_lower_limits()[0], joint.position_upper_limits()[0]
        if not np.isfinite([lower, upper]).all():
            continue
        carried = plant.GetBodiesKinematicallyAffectedBy([joint.index()])

        def spread(value: float) -> float:
            context = plant.CreateDefaultContext()
            _put(plant, context, {**rest, name: value})  # noqa: B023
            frame = last.frame_on_child()
            inspector = robot.diagram.scene_graph().model_inspector()
            away = []
            for index in carried:  # noqa: B023
                body = plant.get_body(index)
                X_LB = body.body_frame().CalcPose(context, frame)
                shapes = plant.GetCollisionGeometriesForBody(body) or (
                    plant.GetVisualGeometriesForBody(body)
                )
                points = [X_LB @ inspector.GetPoseInFrame(s).translation() for s in shapes]
                away += [np.linalg.norm(_across(last, p)) for p in points or [X_LB.translation()]]
            return float(np.mean(away))

        now = rest[name]
        end = max((lower, upper), key=spread)
        if spread(end) > spread(now) + 1e-4:
            opened[name] = now + WIDE_OPEN * (end - now)
    return opened


def _put(plant: MultibodyPlant, context: Context, values: Mapping[str, float]) -> None:
    """Set joints by name, rad or m."""
    q = plant.GetPositions(context)
    for name, value in values.items():
        q[find_joint(plant, name).position_start()] = value
    plant.SetPositions(context, q)


def _across(joint: Joint, p: np.ndarray) -> np.ndarray:
    axis = joint.revolute_axis() if joint.type_name() == "revolute" else joint.translation_axis()
    return np.asarray(p - axis * (axis @ p))


def _tucked(
    robot: Robot, arm: FoundArm, other: FoundArm, rest: dict[str, float]
) -> dict[str, float]:
    """Another arm where it is in no way: its links far back and to its own side, touching nothing.

    The arm itself is looked at in the middle of its ranges.
    """
    plant, graph = robot.plant, robot.diagram.scene_graph()
    root = robot.diagram.CreateDefaultContext()
    context = plant.GetMyMutableContextFromRoot(root)
    query = graph.get_query_output_port()
    _put(plant, context, rest)
    joints = [find_joint(plant, name) for name in other.joints]
    lower = np.array([max(j.position_lower_limits()[0], -np.pi) for j in joints])
    upper = np.array([min(j.position_upper_limits()[0], np.pi) for j in joints])
    shoulder = find_joint(plant, arm.joints[0]).frame_on_child().CalcPoseInWorld(context)
    links = [plant.get_body(i) for i in plant.GetBodiesKinematicallyAffectedBy([joints[0].index()])]
    side = np.sign(joints[0].frame_on_child().CalcPoseInWorld(context).translation()[1]
                   - shoulder.translation()[1])  # fmt: skip

    def touching() -> set[tuple[int, int]]:
        found = query.Eval(graph.GetMyContextFromRoot(root)).ComputePointPairPenetration()
        return {(int(p.id_A.get_value()), int(p.id_B.get_value())) for p in found}

    usual = touching() if graph.model_inspector().num_geometries() else set()
    rng = np.random.default_rng(0)
    best: tuple[float, dict[str, float]] | None = None
    for u in rng.uniform(0.1, 0.9, (TUCKED, len(joints))):
        q = lower + u * (upper - lower)
        _put(plant, context, dict(zip(other.joints, map(float, q), strict=True)))
        p = np.array([link.EvalPoseInWorld(context).translation() for link in links])
        cost = float(p[:, 0].max() - 0.5 * (side * p[:, 1]).min() + 0.3 * p[:, 2].max())
        if best is not None and cost >= best[0]:
            continue
        if touching() <= usual:
            best = cost, dict(zip(other.joints, map(float, q), strict=True))
    return {} if best is None else best[1]
