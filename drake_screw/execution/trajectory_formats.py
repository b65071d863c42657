"""Timed plans as files that robots and people can use: functions of a plan and its arm to bytes."""

from __future__ import annotations

import io

import numpy as np
import yaml

from drake_screw.demonstrations.baxter_csv import csv_text
from drake_screw.execution.timing import TimedPlan
from drake_screw.robot import Arm

PERIOD = 0.01
"""s, between samples of an exported trajectory; the recorder's own."""


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
    nanoseconds = np.rint(1e9 * t).astype(np.int64)
    message = {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": list(arm.joint_names),
        "points": [
            {
                "positions": positions,
                "velocities": velocities,
                "accelerations": [],
                "effort": [],
                "time_from_start": {"sec": time // 10**9, "nanosec": time % 10**9},
            }
            for time, positions, velocities in zip(
                nanoseconds.tolist(),
                (np.round(q, 9) + 0.0).tolist(),
                (np.round(v, 9) + 0.0).tolist(),
                strict=True,
            )
        ],
    }
    return yaml.safe_dump(message, sort_keys=False, default_flow_style=None, width=1000).encode()


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
