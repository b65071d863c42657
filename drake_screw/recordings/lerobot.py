"""LeRobot datasets, versions 2 and 3: parquet files of frames, described by meta/info.json."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.errors import RecordingError, extra
from drake_screw.json_values import decode_json, within
from drake_screw.recordings.mapping import Mapping
from drake_screw.recordings.others import read_by_others
from drake_screw.recordings.raw import Raw
from drake_screw.tables.table import from_arrays
from drake_screw.tables.text import Progress

INFO = Path("meta") / "info.json"
STATE = "observation.state"
_COLUMNS = ("episode_index", "timestamp", STATE)


def read_lerobot(
    source: Path, mapping: Mapping, progress: Progress | None = None
) -> tuple[Raw, ...]:
    """A recording for each episode of a dataset.

    The unit of joint angles is nowhere in a dataset (radians, degrees and parts of a range are all
    in use), so it has to be said.

    Raises:
        RecordingError: pyarrow is not installed, it is no such dataset, or `angles` is not said.
    """
    with extra("lerobot", "LeRobot's datasets need pyarrow", RecordingError, source):
        import pyarrow.parquet as pq
    info = _info(source)
    if mapping.angles is None and mapping.hand is None:
        raise RecordingError(
            "the unit of the joint angles is not said, and a dataset does not state it",
            remedy="Say angles: rad, angles: deg or angles: percent (-100 to 100 of each joint's "
            "range) in recording.yaml in the dataset's folder.",
            file=source / INFO,
        )
    files = sorted(source.glob("data/**/*.parquet"))
    if not files:
        raise RecordingError("no data/**/*.parquet in it", file=source)
    found: dict[int, list[tuple[Any, Any]]] = {}
    for i, file in enumerate(files):
        with read_by_others(file, "frames", f"Expected columns {', '.join(_COLUMNS)}."):
            frames = pq.read_table(file, columns=list(_COLUMNS))
            episode = np.array(frames["episode_index"].to_pylist(), dtype=np.int64)
            time = np.array(frames["timestamp"].to_pylist(), dtype=float)
            state = np.array(frames[STATE].to_pylist(), dtype=float)
        for name, values, dimensions in (
            (STATE, state, 2),
            ("timestamp", time, 1),
            ("episode_index", episode, 1),
        ):
            if len(values) and values.ndim != dimensions:
                what = "a number" if dimensions == 1 else "a list of numbers"
                raise RecordingError(
                    f"{name} is not {what} in each row",
                    remedy="Expected frames as LeRobot writes them, a row for each.",
                    file=file,
                )
        for number in np.unique(episode).tolist():
            rows = episode == number
            found.setdefault(number, []).append((time[rows], state[rows]))
        if progress:
            progress((i + 1) / len(files))
    return tuple(_episode(source, n, parts, info) for n, parts in sorted(found.items()))


def _episode(source: Path, number: int, parts: list[tuple[Any, Any]], info: Any) -> Raw:
    widths = sorted({state.shape[1] for _, state in parts})
    if len(widths) > 1:
        raise RecordingError(
            f"{STATE} has {widths[0]} numbers in some rows of episode {number} and {widths[-1]} in "
            "others",
            remedy="Expected a number for each joint.",
            file=source,
        )
    t, q = (np.concatenate(each) for each in zip(*parts, strict=True))
    names = _names(info, q.shape[1])
    columns = {"timestamp": t, **{name: q[:, j] for j, name in enumerate(names)}}
    told = {"time": "timestamp", "time_unit": "s"}
    name = f"{source.resolve().name}_{number:06d}"
    return Raw(name, from_arrays(columns, source, "frames of LeRobot"), told)


def _names(info: Any, width: int) -> list[str]:
    """Of the state's entries, without ".pos" behind them; numbered where there are none."""
    names = within(info, "features", STATE, "names")
    if isinstance(names, dict):
        names = next(iter(names.values()), None)
    if not isinstance(names, list) or len(names) != width:
        return [f"state_{i}" for i in range(width)]
    return [str(name).removesuffix(".pos") for name in names]


def _info(source: Path) -> Any:
    try:
        return decode_json((source / INFO).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise RecordingError(
            f"not a dataset of LeRobot: {INFO} cannot be read",
            remedy="Give the dataset's folder, with data and meta in it.",
            file=source,
        ) from error
