"""ROS 1 and ROS 2 bags through rosbags: joint states, hand poses, and where objects were.

What is read of them besides the motion is handed on as it was told, over time: `Frames` of poses
and transforms, and `Labels` by which a bag is cut.
"""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.errors import RecordingError, extra, suggestion
from drake_screw.recordings.episodes import PAUSES
from drake_screw.recordings.frames import Frames, Track, plain_frame
from drake_screw.recordings.mapping import Mapping
from drake_screw.recordings.others import read_by_others
from drake_screw.recordings.raw import Labels, Raw
from drake_screw.tables import Table
from drake_screw.tables.table import from_arrays
from drake_screw.tables.text import Progress

JOINTS = "sensor_msgs/msg/JointState"
POSES = ("geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TransformStamped")
TREES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
STATIC = "tf_static"
LABELS = tuple(
    f"std_msgs/msg/{kind}"
    for kind in ("Bool", "String", *(f"{u}Int{n}" for u in ("", "U") for n in (8, 16, 32, 64)))
)
"""Types of topics that may cut a bag."""

_Row = tuple[int, tuple[str, ...], Any]


def read_bag(source: Path, mapping: Mapping, progress: Progress | None = None) -> tuple[Raw, ...]:
    """One recording from a bag: the joint states of a topic, or the hand's poses of one.

    Raises:
        RecordingError: rosbags is not installed, it is no bag, or it has no such topic, or several.
    """
    with extra("ros", "bags need rosbags", RecordingError, source):
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    bag = source.parent if source.suffix in (".db3", ".mcap") and _described(source) else source
    remedy = "Give a .bag, or the folder of a ROS 2 bag, with its metadata.yaml."
    with (
        read_by_others(source, "a bag", remedy),
        AnyReader([bag], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader,
    ):
        kinds = {c.topic: c.msgtype for c in reader.connections}
        topic = _topic(kinds, mapping.topic, source)
        cuts = _cutting(kinds, mapping.episodes, source)
        wanted = [c for c in reader.connections if _is_wanted(c.topic, c.msgtype, topic, cuts)]
        rows: list[_Row] = []
        labels: list[tuple[int, Any]] = []
        ahead = array("q")
        poses = _Poses()
        hand_frame = ""
        begin, length = reader.start_time, max(reader.duration, 1)
        for count, (connection, stamp, raw) in enumerate(reader.messages(connections=wanted)):
            message = reader.deserialize(raw, connection.msgtype)
            if connection.topic == topic:
                rows.append(_row(message, stamp, connection.msgtype))
                ahead.append(rows[-1][0] - stamp)
                hand_frame = hand_frame or plain_frame(message.header.frame_id)
            elif connection.topic == cuts:
                labels.append((stamp, message.data))
            else:
                poses.add(message, stamp, connection.topic, connection.msgtype)
            if progress and count % 1000 == 0:
                progress(min((stamp - begin) / length, 1.0))
    table, first, notes = _table(rows, kinds[topic], source, topic)
    told = {"time": "time", "time_unit": "s", "topic": topic}
    said: dict[str, Labels] = {}
    if cuts:
        # These have no header: on the clock of the motion's by what that is ahead of the bag's.
        shift = int(np.median(ahead)) - first
        t = np.array([(stamp + shift) * 1e-9 for stamp, _ in labels])
        said[cuts] = Labels(t, tuple(value for _, value in labels))
    return (
        Raw(
            source.stem, table, told, notes=notes, frames=poses.frames(first), labels=said,
            hand_frame="" if kinds[topic] == JOINTS else hand_frame,
        ),
    )  # fmt: skip


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


def _cutting(kinds: dict[str, str], said: str | None, source: Path) -> str | None:
    """The topic that a bag is cut by, if it is cut by one."""
    if said is None or said == PAUSES or not said.startswith("/"):
        return None
    if kinds.get(said) in LABELS:
        return said
    which = [topic for topic, kind in kinds.items() if kind in LABELS]
    found = f"topic '{said}' has {kinds[said]}" if said in kinds else f"no topic '{said}'"
    raise RecordingError(
        f"episodes: {found}",
        remedy="Expected one of Bool, String or a whole number of std_msgs. "
        + suggestion(said, which, "Such topics"),
        file=source,
    )


def _is_wanted(topic: str, kind: str, chosen: str, cuts: str | None) -> bool:
    return topic in (chosen, cuts) or kind in (*POSES, *TREES)


def _stamp(message: Any, stamp: int) -> int:
    """ns by the header's stamp, by the bag's if that is 0."""
    at = message.header.stamp
    return at.sec * 1_000_000_000 + at.nanosec or stamp


def _row(message: Any, stamp: int, kind: str) -> _Row:
    """Time in ns, names, and numbers."""
    time = _stamp(message, stamp)
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


class _Poses:
    """Poses and transforms, gathered message by message."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, str], tuple[array[int], array[float]]] = {}
        self._moving: set[tuple[str, str]] = set()
        self._topics: dict[str, str] = {}

    def add(self, message: Any, stamp: int, topic: str, kind: str) -> None:
        """Add what a message tells; a PoseStamped tells of a frame called like its topic."""
        for part in message.transforms if kind in TREES else [message]:
            child = topic if kind == POSES[0] else plain_frame(part.child_frame_id)
            if kind == POSES[1]:
                self._topics.setdefault(topic, child)
            pair = (plain_frame(part.header.frame_id), child)
            if not topic.endswith(STATIC):
                self._moving.add(pair)
            times, numbers = self._found.setdefault(pair, (array("q"), array("d")))
            p, q = _parts(part)
            times.append(_stamp(part, stamp))
            numbers.extend((p.x, p.y, p.z, q.w, q.x, q.y, q.z))

    def frames(self, first: int) -> Frames:
        """All of them, with times in s since `first` ns."""
        return Frames(dict(self._tracks(first)), self._topics)

    def _tracks(self, first: int) -> Iterator[tuple[tuple[str, str], Track]]:
        for pair, (times, numbers) in self._found.items():
            t = (np.array(times, dtype=np.int64) - first) * 1e-9
            values = np.array(numbers).reshape(-1, 7)
            static = pair not in self._moving
            track = Track.of(t, values[:, :3], values[:, 3:], static=static)
            if track is not None:
                yield pair, track


def _table(
    rows: list[_Row], kind: str, source: Path, topic: str
) -> tuple[Table, int, tuple[str, ...]]:
    """Columns of time and of each name, from when on (ns), and notes.

    Rows with the names of other joints are left out.
    """
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
    return from_arrays(columns, source, f"{what} of {topic}"), first, notes
