"""Timed plans as files that robots and people can use: functions of a plan and its arm to bytes."""

from __future__ import annotations

import io

import numpy as np

from drake_screw.demonstrations.baxter_csv import csv_text
from drake_screw.execution.ros_text import accelerations, joint_trajectory, message_text
from drake_screw.execution.setting import NOWHERE, PERIOD, Setting
from drake_screw.execution.timing import TimedPlan
from drake_screw.robot import Arm


def baxter_csv(plan: TimedPlan, arm: Arm) -> bytes:
    """The CSV of Baxter's recorder, which its trajectory playback program plays.

    It has time, both arms and both grippers; joints that the plan does not move keep their parked
    angles, the grippers stay open. An arm that is not Baxter's gets just its own columns.
    """
    t, q, _ = plan.sampled(PERIOD)
    return csv_text(t, q, arm.joint_names, resting(arm)).encode()


def ros_trajectory(plan: TimedPlan, arm: Arm) -> bytes:
    """A trajectory_msgs/JointTrajectory message in YAML: positions and velocities."""
    t, q, v = plan.sampled(PERIOD)
    return message_text(joint_trajectory(t, q, v, None, arm.joint_names))


def moveit_trajectory(plan: TimedPlan, arm: Arm, setting: Setting = NOWHERE) -> bytes:
    """A moveit_msgs/RobotTrajectory message in YAML: positions, velocities and accelerations.

    Its frame is the robot's base. No joint has more than one degree of freedom.
    """
    t, q, v = plan.sampled(PERIOD)
    joints = joint_trajectory(t, q, v, accelerations(plan, t), arm.joint_names, setting.base)
    several = {"header": joints["header"], "joint_names": [], "points": []}
    return message_text({"joint_trajectory": joints, "multi_dof_joint_trajectory": several})


def npz(plan: TimedPlan, arm: Arm) -> bytes:
    """Arrays t, s, segment (m,), q, v (m, n), X_WE (g + 1, 4, 4) and joint_names (n,).

    Where the hand's roll about an axis is free, X_WE is rolled as the arm is there.
    """
    X_WE = plan.poses
    if plan.free_axis is not None:
        q_ends = np.stack([plan.segments[0].q[0], *(piece.q[-1] for piece in plan.segments)])
        X_WE = arm.pose(q_ends)
    t, q, v = plan.sampled(PERIOD)
    points = [plan.at(float(time)) for time in t]
    file = io.BytesIO()
    np.savez_compressed(
        file,
        t=t,
        q=q,
        v=v,
        segment=np.array([p.segment for p in points]),
        s=np.array([p.s for p in points]),
        X_WE=X_WE,
        joint_names=np.array(arm.joint_names),
    )
    return file.getvalue()


def resting(arm: Arm) -> dict[str, float]:
    """Where every joint of the robot rests, by name; the arm's own at 0."""
    plant = arm.plant
    q = arm.full_positions(np.zeros(arm.n))
    joints = [plant.get_joint(index) for index in plant.GetJointIndices()]
    return {
        joint.name(): float(q[joint.position_start()])
        for joint in joints
        if joint.num_positions() == 1
    }
