"""A timed plan as a LeRobot dataset of one episode, version 2.1, written by pyarrow."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np

from drake_screw.errors import PluginError, extra
from drake_screw.execution.setting import NOWHERE, PERIOD, Setting
from drake_screw.execution.timing import TimedPlan
from drake_screw.recordings.mapping import FILE, Mapping
from drake_screw.robot import Arm
from drake_screw.typing import Array

VERSION = "v2.1"
STATE, ACTION = "observation.state", "action"
DATA = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
_CHUNK = 1000  # episodes


def lerobot(plan: TimedPlan, arm: Arm, setting: Setting = NOWHERE) -> dict[str, bytes]:
    """The files of a dataset: its description, one episode, and how `import` reads it.

    A frame's state is where the joints are, its action where they are to be at the next one. Frames
    are evenly spaced, so the last one may be after the plan's end, where the arm rests.

    Raises:
        PluginError: pyarrow is not installed.
    """
    with extra("lerobot", "the export format lerobot needs pyarrow", PluginError):
        import pyarrow as pa
        import pyarrow.parquet as pq
    frames = _frames(plan)
    columns = {
        name: pa.FixedSizeListArray.from_arrays(values.ravel(), arm.n)
        if values.ndim == 2
        else pa.array(values)
        for name, values in frames.items()
    }
    file = io.BytesIO()
    pq.write_table(pa.table(columns), file)
    m = len(frames["timestamp"])
    task = setting.task or "follow the plan"
    return {
        "meta/info.json": (json.dumps(_info(frames, arm, setting), indent=4) + "\n").encode(),
        "meta/tasks.jsonl": _line({"task_index": 0, "task": task}),
        "meta/episodes.jsonl": _line({"episode_index": 0, "tasks": [task], "length": m}),
        "meta/episodes_stats.jsonl": _line(
            {"episode_index": 0, "stats": {name: _stats(x) for name, x in frames.items()}}
        ),
        DATA.format(episode_chunk=0, episode_index=0): file.getvalue(),
        FILE: _said(arm, setting).text().encode(),
    }


def _frames(plan: TimedPlan) -> dict[str, Array]:
    """Columns of the episode's m frames: joints (m, n) float32, all others (m,)."""
    m = int(np.ceil(plan.duration / PERIOD - 1e-9)) + 1
    index = np.arange(m)
    q, _ = plan.path(PERIOD * index)
    q = q.astype(np.float32)
    return {
        STATE: q,
        ACTION: np.concatenate([q[1:], q[-1:]]),
        "timestamp": (PERIOD * index).astype(np.float32),
        "frame_index": index,
        "episode_index": np.zeros_like(index),
        "index": index,
        "task_index": np.zeros_like(index),
    }


def _info(frames: dict[str, Array], arm: Arm, setting: Setting) -> dict[str, Any]:
    features = {}
    for name, values in frames.items():
        width = values.shape[1] if values.ndim == 2 else 1
        feature = {"dtype": str(values.dtype), "shape": [width], "names": None}
        if values.ndim == 2:
            feature |= {"names": list(arm.joint_names), "units": list(arm.units)}
        features[name] = feature
    return {
        "codebase_version": VERSION,
        "robot_type": setting.robot or "unknown",
        "total_episodes": 1,
        "total_frames": len(frames["timestamp"]),
        "total_tasks": 1,
        "total_videos": 0,
        "total_chunks": 1,
        "chunks_size": _CHUNK,
        "fps": round(1.0 / PERIOD),
        "splits": {"train": "0:1"},
        "data_path": DATA,
        "video_path": None,
        "features": features,
    }


def _stats(values: Array) -> dict[str, list[Any]]:
    columns = values.reshape(len(values), -1).astype(float)
    numbers = {name: getattr(np, name)(columns, axis=0) for name in ("min", "max", "mean", "std")}
    return {**{name: x.tolist() for name, x in numbers.items()}, "count": [len(values)]}


def _said(arm: Arm, setting: Setting) -> Mapping:
    """What a dataset does not say itself: the unit of angles, and where the objects were."""
    objects: dict[str, Any] = {
        name: tuple(tuple(row) for row in (np.asarray(X) + 0.0).tolist())
        for name, X in setting.X_WO.items()
    }
    lengths = "m" if "m" in arm.units else None
    return Mapping(angles="rad", objects=objects).with_(lengths=lengths)


def _line(item: dict[str, Any]) -> bytes:
    return (json.dumps(item) + "\n").encode()
