"""ROS 1 and ROS 2 bags through rosbags: joint states, hand poses, and where objects were."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.errors import RecordingError, suggestion
from drake_screw.recordings.mapping import Mapping
from drake_screw.recordings.raw import Raw
from drake_screw.screws import pose, rotation_from_quaternion
from drake_screw.tables import Table
from drake_screw.tables.table import from_arrays
from drake_screw.tables.text import Progress

JOINTS = "sensor_msgs/msg/JointState"
POSES = ("geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TransformStamped")
TREE = "tf2_msgs/msg/TFMessage"

_Row = tuple[float, tuple[str, ...], Any]


def read_bag(source: Path, mapping: Mapping, progress: Progress | None = None) -> tuple[Raw, ...]:
    """One recording from a bag: the joint states of a topic, or the hand's poses of one.

    Objects have the first pose of their topic or transform, by the names of topics and of child
    frames.

    Raises:
        RecordingError: rosbags is not installed, it is no bag, or it has no such topic, or several.
    """
    try:
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise RecordingError(
            "bags need rosbags", remedy="pip install 'drake-screw[ros]'", file=source
        ) from error
    bag = source.parent if source.suffix in (".db3", ".mcap") and _described(source) else source
    try:
        with AnyReader([bag], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            kinds = {c.topic: c.msgtype for c in reader.connections}
            topic = _topic(kinds, mapping.topic, source)
            wanted = [c for c in reader.connections if _is_wanted(c.topic, c.msgtype, topic)]
            rows: list[_Row] = []
            X_WO: dict[str, Any] = {}
            frames: dict[str, str] = {}
            begin, length = reader.start_time, max(reader.duration, 1)
            for count, (connection, stamp, raw) in enumerate(reader.messages(connections=wanted)):
                message = reader.deserialize(raw, connection.msgtype)
                if connection.topic == topic:
                    rows.append(_row(message, stamp, connection.msgtype))
                else:
                    for name, frame, X in _poses(message, connection.topic, connection.msgtype):
                        X_WO.setdefault(name, X)
                        frames.setdefault(name, frame)
                if progress and count % 1000 == 0:
                    progress(min((stamp - begin) / length, 1.0))
    except (AnyReaderError, OSError) as error:
        raise RecordingError(
            f"cannot be read as a bag: {error}",
            remedy="Give a .bag, or the folder of a ROS 2 bag, with its metadata.yaml.",
            file=source,
        ) from error
    table, notes = _table(rows, kinds[topic], source, topic)
    told = {"time": "time", "time_unit": "s", "topic": topic}
    return (Raw(source.stem, table, told, X_WO, notes, frames),)


def _described(source: Path) -> bool:
    return (source.parent / "metadata.yaml").is_file()


def _topic(kinds: dict[str, str], said: str | None, source: Path) -> str:
    """The topic of the motion."""
    if said is not None:
        if kinds.get(said) not in (JOINTS, *POSES):
            raise RecordingError(
                f"no topic '{said}' of joint states or poses",
                remedy=suggestion(said, kinds, "Topics"),
                file=source,
            )
        return said
    found = sorted(topic for topic, kind in kinds.items() if kind == JOINTS)
    if len(found) == 1:
        return found[0]
    some = f"{len(found)} topics" if found else "no topic"
    raise RecordingError(
        f"{some} of joint states{': ' if found else ''}{', '.join(found)}",
        remedy="Say topic: NAME in recording.yaml, of joint states or of the hand's poses. "
        f"Topics: {', '.join(f'{topic} ({kind})' for topic, kind in kinds.items())}",
        file=source,
    )


def _is_wanted(topic: str, kind: str, chosen: str) -> bool:
    return topic == chosen or kind in (*POSES, TREE)


def _row(message: Any, stamp: int, kind: str) -> _Row:
    """Seconds by the header's stamp (by the bag's if that is 0), names, and numbers."""
    at = message.header.stamp
    time = at.sec * 1_000_000_000 + at.nanosec or stamp
    if kind == JOINTS:
        return time, tuple(message.name), np.array(message.position, dtype=float)
    p, q = _parts(message)
    names = (*(f"position.{a}" for a in "xyz"), *(f"orientation.{a}" for a in "xyzw"))
    return time, names, np.array([p.x, p.y, p.z, q.x, q.y, q.z, q.w])


def _parts(message: Any) -> tuple[Any, Any]:
    """Position and quaternion of a PoseStamped or TransformStamped."""
    if hasattr(message, "pose"):
        return message.pose.position, message.pose.orientation
    return message.transform.translation, message.transform.rotation


def _poses(message: Any, topic: str, kind: str) -> Iterable[tuple[str, str, Any]]:
    """Names of topics and child frames, what they are seen from, and X (4, 4)."""
    for part in message.transforms if kind == TREE else [message]:
        p, q = _parts(part)
        X = pose(rotation_from_quaternion([q.w, q.x, q.y, q.z]), [p.x, p.y, p.z])
        name = topic if kind == POSES[0] else part.child_frame_id.lstrip("/")
        yield name, part.header.frame_id, X


def _table(rows: list[_Row], kind: str, source: Path, topic: str) -> tuple[Table, tuple[str, ...]]:
    """Columns of time and of each name; rows with the names of other joints are left out."""
    if not rows:
        raise RecordingError(f"nothing was recorded of topic '{topic}'", file=source)
    counts = Counter(names for _, names, numbers in rows if len(names) == len(numbers))
    if not counts:
        raise RecordingError(
            f"topic '{topic}' has no positions",
            remedy="Velocities and efforts alone do not say where the arm was.",
            file=source,
        )
    usual = max(counts, key=lambda names: (counts[names] * len(names), names))
    kept = [row for row in rows if row[1] == usual and len(row[2]) == len(usual)]
    first = kept[0][0]
    values = np.array([numbers for _, _, numbers in kept])
    columns = {"time": np.array([(time - first) * 1e-9 for time, _, _ in kept])}
    columns |= {name: values[:, j] for j, name in enumerate(usual)}
    left = len(rows) - len(kept)
    notes = (f"left out {left} messages with the names of other joints",) if left else ()
    what = "joint states" if kind == JOINTS else "poses"
    return from_arrays(columns, source, f"{what} of {topic}"), notes
