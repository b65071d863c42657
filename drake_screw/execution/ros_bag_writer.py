"""A timed plan as a ROS 2 bag, written by rosbags: joint states, and where the objects are."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.errors import PluginError, extra
from drake_screw.execution.ros_text import nanoseconds
from drake_screw.execution.setting import NOWHERE, PERIOD, Setting
from drake_screw.execution.timing import TimedPlan
from drake_screw.robot import Arm
from drake_screw.screws import quaternion_from_rotation
from drake_screw.typing import Array

TOPIC = "/joint_states"
NAME = "plan"
"""Of the file in the bag."""

_JOINTS = "sensor_msgs/msg/JointState"
_POSE = "geometry_msgs/msg/PoseStamped"


def ros2_bag(plan: TimedPlan, arm: Arm, setting: Setting = NOWHERE) -> dict[str, bytes]:
    """The files of a bag in mcap storage: joint states from time 0 on, and the objects' poses.

    Each object has a topic of its own name, with one pose at time 0, kept for those who listen
    later.

    Raises:
        PluginError: rosbags is not installed.
    """
    with extra("ros", "the export format ros2-bag needs rosbags", PluginError):
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore
    store = get_typestore(Stores.ROS2_HUMBLE)
    t, q, v = plan.sampled(PERIOD)
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / NAME
        with Writer(bag, version=8, storage_plugin=StoragePlugin.MCAP) as writer:
            for name, X in setting.X_WO.items():
                topic = writer.add_connection(
                    name, _POSE, typestore=store, offered_qos_profiles=[_kept()]
                )
                message = _pose(store.types, setting.base, X)
                writer.write(topic, 0, store.serialize_cdr(message, _POSE))
            topic = writer.add_connection(TOPIC, _JOINTS, typestore=store)
            for time, position, velocity in zip(nanoseconds(t), q, v, strict=True):
                message = _joints(store.types, time, arm.joint_names, position, velocity)
                writer.write(topic, time, store.serialize_cdr(message, _JOINTS))
        return {file.name: file.read_bytes() for file in sorted(bag.iterdir())}


def _kept() -> Any:
    """The quality of service of a topic whose last message reaches those who listen later."""
    from rosbags.interfaces import (
        Qos,
        QosDurability,
        QosHistory,
        QosLiveliness,
        QosReliability,
        QosTime,
    )

    ever = QosTime(9223372036, 854775807)
    return Qos(
        QosHistory.KEEP_LAST, 1, QosReliability.RELIABLE, QosDurability.TRANSIENT_LOCAL,
        ever, ever, QosLiveliness.AUTOMATIC, ever, False,
    )  # fmt: skip


def _header(types: Any, time: int, frame: str) -> Any:
    stamp = types["builtin_interfaces/msg/Time"](time // 10**9, time % 10**9)
    return types["std_msgs/msg/Header"](stamp, frame)


def _joints(types: Any, time: int, names: tuple[str, ...], q: Array, v: Array) -> Any:
    return types[_JOINTS](_header(types, time, ""), list(names), q, v, np.zeros(0))


def _pose(types: Any, frame: str, X: Array) -> Any:
    w, x, y, z = quaternion_from_rotation(X[:3, :3]).tolist()
    p = types["geometry_msgs/msg/Point"](*X[:3, 3].tolist())
    q = types["geometry_msgs/msg/Quaternion"](x, y, z, w)
    return types[_POSE](_header(types, 0, frame), types["geometry_msgs/msg/Pose"](p, q))
