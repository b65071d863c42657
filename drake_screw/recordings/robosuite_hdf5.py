"""robosuite and robomimic HDF5: a group for each episode, with joints and object poses by name.

``data/demo_0/obs/robot0_joint_pos`` is (m, n) rad, ``robot0_eef_pos`` and ``robot0_eef_quat`` are
(m, 3) m and (m, 4) with w last, and so are NAME_pos and NAME_quat of objects, all in the
simulator's world. The rate is in the environment's arguments.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.errors import RecordingError, extra
from drake_screw.json_values import decode_json, within
from drake_screw.recordings.mapping import Mapping
from drake_screw.recordings.others import read_by_others
from drake_screw.recordings.raw import Raw
from drake_screw.screws import pose, rotation_from_quaternion
from drake_screw.tables.table import from_arrays
from drake_screw.tables.text import Progress
from drake_screw.typing import Array

_RATE = ("env_kwargs", "control_freq")
_JOINTS = "robot0_joint_pos"
FARTHEST = 1000.0
"""m, of an object from the simulator's origin."""
_HAND = ("robot0_eef_pos", "robot0_eef_quat")


def read_hdf5(source: Path, mapping: Mapping, progress: Progress | None = None) -> tuple[Raw, ...]:
    """A recording for each episode.

    Raises:
        RecordingError: h5py is not installed, or it is no such file.
    """
    with extra("hdf5", "HDF5 needs h5py", RecordingError, source):
        import h5py
    with read_by_others(source, "HDF5"), h5py.File(source, "r") as file:
        if not _is_group(file, "data"):
            raise RecordingError(
                "not of robosuite or robomimic: there is no group 'data'",
                remedy=f"Groups found: {', '.join(file) or 'none'}. Write the columns as a "
                "table, or plug in a reader.",
                file=source,
            )
        data = file["data"]
        rate = _rate(data)
        names = sorted(data, key=_number)
        found = []
        for i, name in enumerate(names):
            found.append(_episode(data[name], f"{source.stem}_{name}", source, rate))
            if progress:
                progress((i + 1) / len(names))
    if not found:
        raise RecordingError("no episodes in it", remedy="Record some.", file=source)
    return tuple(found)


def _episode(group: Any, name: str, source: Path, rate: float | None) -> Raw:
    if not _is_group(group, "obs"):
        raise RecordingError(
            f"{group.name} has no observations",
            remedy="Convert the states to observations first, with robomimic's "
            "dataset_states_to_obs.py.",
            file=source,
        )
    obs = group["obs"]
    columns: dict[str, Any] = {}
    if _JOINTS in obs:
        for j, column in enumerate(_numbers(obs, _JOINTS, source).T):
            columns[f"{_JOINTS}_{j}"] = column
    if all(key in obs for key in _HAND):
        for axis, column in zip("xyz", _numbers(obs, _HAND[0], source, 3).T, strict=True):
            columns[f"eef.position.{axis}"] = column
        for axis, column in zip("xyzw", _numbers(obs, _HAND[1], source, 4).T, strict=True):
            columns[f"eef.orientation.{axis}"] = column
    if not columns:
        raise RecordingError(
            f"{obs.name} has neither {_JOINTS} nor {' and '.join(_HAND)}",
            remedy=f"Observations found: {', '.join(obs)}",
            file=source,
        )
    told: dict[str, Any] = {"angles": "rad"}
    if rate is not None:
        told["rate"] = rate
    names = [key[:-4] for key in obs if key.endswith("_pos") and not key.startswith("robot")]
    poses = {each: _first(obs, each, source) for each in names if f"{each}_quat" in obs}
    return Raw(name, from_arrays(columns, source, "episodes of robosuite"), told, poses)


def _is_group(parent: Any, name: str) -> bool:
    """Whether there is a group of this name in what may be one."""
    return hasattr(parent, "keys") and name in parent and hasattr(parent[name], "keys")


def _numbers(group: Any, name: str, source: Path, width: int | None = None) -> Array:
    """A dataset's rows (m, n) as numbers."""
    data = group[name]
    shape, kind = getattr(data, "shape", None), getattr(getattr(data, "dtype", None), "kind", "")
    if kind not in tuple("fiub") or shape is None or len(shape) != 2 or not all(shape):
        found = "a group" if shape is None else f"{shape} of {data.dtype}"
        raise RecordingError(
            f"{group.name}/{name} is not a table of numbers",
            remedy=f"Expected (samples, {width or 'joints'}); found {found}.",
            file=source,
        )
    if width is not None and shape[1] != width:
        raise RecordingError(
            f"{group.name}/{name} has {shape[1]} columns",
            remedy=f"Expected (samples, {width}).",
            file=source,
        )
    return np.asarray(data, dtype=float)


def _first(obs: Any, name: str, source: Path) -> Array:
    """An object's pose at the start (4, 4)."""
    p, q = _numbers(obs, f"{name}_pos", source, 3), _numbers(obs, f"{name}_quat", source, 4)
    length = np.linalg.norm(q[0])
    if not (abs(length - 1.0) < 0.1 and (np.abs(p[0]) < FARTHEST).all()):
        raise RecordingError(
            f"{obs.name}/{name}_pos and {name}_quat are no pose: {p[0]} m, x, y, z, w {q[0]}",
            remedy="Expected a place in m and a unit quaternion, at the episode's start.",
            file=source,
        )
    return pose(rotation_from_quaternion(np.roll(q[0], 1)), p[0])


def _rate(data: Any) -> float | None:
    """Hz, from the environment's arguments; None where they do not say."""
    texts = [data.attrs[key] for key in ("env_args", "env_info") if key in data.attrs]
    for text in texts:
        try:
            found = decode_json(text) if isinstance(text, str | bytes) else None
        except ValueError:
            continue
        rate = within(found, *_RATE) or within(found, _RATE[1])
        if type(rate) in (int, float) and 0.0 < rate < np.inf:
            return float(rate)
    return None


def _number(name: str) -> tuple[int, str]:
    digits = "".join(filter(str.isdigit, name))
    return (int(digits) if digits else 0, name)
