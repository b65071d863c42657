"""Trajectory messages of ROS as plain data, and as the YAML that ROS prints and reads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import yaml

from drake_screw.execution.timing import TimedPlan
from drake_screw.typing import Array

_STEP = 1e-3  # s, to both sides, over which velocities are compared


def joint_trajectory(
    t: Array, q: Array, v: Array, a: Array | None, joint_names: Sequence[str], frame: str = ""
) -> dict[str, Any]:
    """A trajectory_msgs/JointTrajectory message.

    Args:
        t: (m,) s.
        q, v, a: (m, n) joint positions, velocities and perhaps accelerations.
        joint_names: n names.
        frame: of the header.
    """
    times = nanoseconds(t)
    bends: list[Any] = [[]] * len(t) if a is None else _rounded(a)
    return {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": frame},
        "joint_names": list(joint_names),
        "points": [
            {
                "positions": position,
                "velocities": velocity,
                "accelerations": [*bend],
                "effort": [],
                "time_from_start": {"sec": time // 10**9, "nanosec": time % 10**9},
            }
            for time, position, velocity, bend in zip(
                times, _rounded(q), _rounded(v), bends, strict=True
            )
        ],
    }


def message_text(message: dict[str, Any]) -> bytes:
    """A message in YAML, as ``ros2 topic echo`` prints it and ``ros2 topic pub`` takes it."""
    return yaml.dump(
        message, Dumper=_Dumper, sort_keys=False, default_flow_style=None, width=1000
    ).encode()


def nanoseconds(t: Array) -> list[int]:
    """Whole ns of times (m,) in s."""
    times: list[int] = np.rint(1e9 * np.asarray(t)).astype(np.int64).tolist()
    return times


def accelerations(plan: TimedPlan, t: Array) -> Array:
    """Joint accelerations (m, n) at ascending times t (m,) of a plan, rad/s^2 or m/s^2.

    A time law bends without jumps, and begins and ends at rest.
    """
    before, after = (plan.path(t + step)[1] for step in (-_STEP, _STEP))
    a = (after - before) / (2.0 * _STEP)
    a[(t <= 0.0) | (t >= plan.duration)] = 0.0
    return a


def _rounded(values: Array) -> list[list[float]]:
    rows: list[list[float]] = (np.round(values, 9) + 0.0).tolist()
    return rows


class _Dumper(yaml.SafeDumper):
    """Writes everything out, also what stands there twice."""

    def ignore_aliases(self, data: Any) -> bool:
        return True
