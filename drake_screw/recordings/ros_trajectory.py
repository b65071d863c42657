"""Trajectories of joints in YAML, as ROS and MoveIt print and keep them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import yaml

from drake_screw.errors import RecordingError
from drake_screw.recordings.mapping import Mapping
from drake_screw.recordings.raw import Raw
from drake_screw.tables.table import from_arrays
from drake_screw.tables.text import Progress

_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_TIME = "time_from_start"


def read_trajectory(
    source: Path, mapping: Mapping, progress: Progress | None = None
) -> tuple[Raw, ...]:
    """A recording for each message of a file: what ``ros2 topic echo`` prints, or an export.

    It may be a moveit_msgs/RobotTrajectory or a trajectory_msgs/JointTrajectory, of ROS 2 or
    ROS 1 (`secs` and `nsecs`), several with lines of dashes between.

    Raises:
        RecordingError: it is not YAML, or no such message; a point has no time, or not a position
            for each joint.
    """
    try:
        with source.open("rb") as stream:
            messages = [each for each in yaml.load_all(stream, _Loader) if each is not None]
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        raise RecordingError(
            f"not YAML: {getattr(error, 'problem', None) or error}",
            remedy="Expected a message as ros2 topic echo prints it.",
            file=source,
            line=None if mark is None else mark.line + 1,
        ) from error
    except (OSError, ValueError, RecursionError) as error:  # ValueError: of dates and numbers
        raise RecordingError(f"cannot be read: {error}", file=source) from error
    found = [_trajectory(message, source) for message in messages] or [_trajectory(None, source)]
    names = [source.stem] if len(found) == 1 else _numbered(source.stem, len(found))
    return tuple(_raw(name, each, source) for name, each in zip(names, found, strict=True))


def _numbered(stem: str, count: int) -> list[str]:
    return [f"{stem}_{i:06d}" for i in range(count)]


def _trajectory(message: Any, source: Path) -> dict[str, Any]:
    """The JointTrajectory of a message."""
    inner = message.get("joint_trajectory", message) if isinstance(message, dict) else None
    if not isinstance(inner, dict) or not {"joint_names", "points"} <= inner.keys():
        raise RecordingError(
            "no trajectory of joints: there are no joint_names and points",
            remedy="Expected a moveit_msgs/RobotTrajectory or trajectory_msgs/JointTrajectory.",
            file=source,
        )
    if not inner["joint_names"] or not inner["points"]:
        raise RecordingError("the trajectory has no joints, or no points", file=source)
    return inner


def _raw(name: str, trajectory: dict[str, Any], source: Path) -> Raw:
    joints = [str(joint) for joint in trajectory["joint_names"]]
    rows = []
    for i, point in enumerate(trajectory["points"]):
        try:
            time = _seconds(point[_TIME])
            rows.append([time, *map(float, point["positions"])])
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise RecordingError(
                f"point {i + 1} of the trajectory has no {_TIME} and positions that are numbers",
                remedy="Expected time_from_start: {sec, nanosec} and positions: [...].",
                file=source,
            ) from error
        if len(rows[-1]) != 1 + len(joints):
            raise RecordingError(
                f"point {i + 1} of the trajectory has {len(rows[-1]) - 1} positions for "
                f"{len(joints)} joints",
                remedy="Expected a position for each of joint_names, in their order.",
                file=source,
            )
    values = np.array(rows)
    columns = {"time": values[:, 0], **{joint: values[:, j + 1] for j, joint in enumerate(joints)}}
    told = {"time": "time", "time_unit": "s"}
    return Raw(name, from_arrays(columns, source, "points of a trajectory"), told)


def _seconds(time: dict[str, Any]) -> float:
    """A duration of ROS 2 or ROS 1 in s."""
    if "secs" in time:
        return float(time["secs"]) + 1e-9 * float(time["nsecs"])
    return float(time["sec"]) + 1e-9 * float(time["nanosec"])
