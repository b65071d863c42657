"""Bags for tests, written by rosbags."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.screws import quaternion_from_rotation
from drake_screw.typing import Array

LEFT = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
START = 1_700_000_000.0
"""s, of the first sample."""

TREES = {"tree": "tf2_msgs/msg/TFMessage", "old tree": "tf/msg/tfMessage"}

Link = tuple[str, str, Array]
"""Parent frame, child frame and pose (4, 4)."""


@contextmanager
def bag(path: Path, kind: str, ahead: int = 0) -> Iterator[Callable[..., None]]:
    """Gives a function that writes a message to a topic at a time in s.

    What is written is said by a word: "joints" with names and positions, "pose" with position and
    quaternion x, y, z, w and perhaps a frame, "transform" with a `Link`, "tree" (or
    "old tree", of ROS 1's tf) with a list of them, or a type of std_msgs with its data. Headers
    are `ahead` s of the bag's own clock.
    """
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if kind == "bag" else Stores.ROS2_HUMBLE)
    for name in TREES.values():
        if name not in store.types:
            text = "geometry_msgs/TransformStamped[] transforms"
            store.register(get_types_from_msg(text, name))
    plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
    writer = Writer1(path) if kind == "bag" else Writer2(path, version=9, storage_plugin=plugin)
    connections: dict[str, Any] = {}
    T = store.types

    def header(t: float, frame: str = "base") -> Any:
        stamp = T["builtin_interfaces/msg/Time"](int(t) + ahead, round(t % 1 * 1e9))
        extra = {"seq": 0} if kind == "bag" else {}
        return T["std_msgs/msg/Header"](stamp=stamp, frame_id=frame, **extra)

    def quaternion(q: Sequence[float]) -> Any:
        return T["geometry_msgs/msg/Quaternion"](*map(float, q))

    def transform(t: float, link: Link) -> Any:
        parent, child, X = link
        w, x, y, z = quaternion_from_rotation(X[:3, :3])
        p = T["geometry_msgs/msg/Vector3"](*X[:3, 3].tolist())
        made = T["geometry_msgs/msg/Transform"](p, quaternion((x, y, z, w)))
        return T["geometry_msgs/msg/TransformStamped"](header(t, parent), child, made)

    def message(t: float, what: str, values: Sequence[Any]) -> tuple[str, Any]:
        if what == "joints":
            name, empty = "sensor_msgs/msg/JointState", np.zeros(0)
            return name, T[name](header(t), list(values[0]), np.array(values[1]), empty, empty)
        if what == "pose":
            name = "geometry_msgs/msg/PoseStamped"
            p = T["geometry_msgs/msg/Point"](*map(float, values[0]))
            X = T["geometry_msgs/msg/Pose"](p, quaternion(values[1]))
            return name, T[name](header(t, *values[2:]), X)
        if what == "transform":
            return "geometry_msgs/msg/TransformStamped", transform(t, values[0])
        if what in TREES:
            name = TREES[what]
            return name, T[name]([transform(t, link) for link in values[0]])
        name = f"std_msgs/msg/{what}"
        return name, T[name](values[0])

    with writer:

        def write(topic: str, t: float, what: str, *values: Any) -> None:
            name, made = message(t, what, values)
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, name, typestore=store)
            raw = store.serialize_ros1 if kind == "bag" else store.serialize_cdr
            writer.write(connections[topic], round(t * 1e9), raw(made, name))

        yield write


def motion() -> tuple[Array, Array]:
    """50 samples of Baxter's left arm, 0.05 s apart."""
    q = np.tile([0.5, -0.2, -0.7, 1.5, 1.8, -0.9, -0.5], (50, 1))
    q[:, 0] += 0.01 * np.arange(50)
    return START + 0.05 * np.arange(50), q
