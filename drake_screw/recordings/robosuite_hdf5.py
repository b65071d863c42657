"""robosuite and robomimic HDF5: a group for each episode, with joints and object poses by name.

``data/demo_0/obs/robot0_joint_pos`` is (m, n) rad, ``robot0_eef_pos`` and ``robot0_eef_quat`` are
(m, 3) m and (m, 4) with w last, and so are NAME_pos and NAME_quat of objects, all in the
simulator's world. The rate is in the environment's arguments.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.errors import RecordingError, extra
from drake_screw.recordings.mapping import Mapping
from drake_screw.recordings.raw import Raw
from drake_screw.screws import pose, rotation_from_quaternion
from drake_screw.tables.table import from_arrays
from drake_screw.tables.text import Progress

_RATE = ("env_kwargs", "control_freq")
_JOINTS = "robot0_joint_pos"
_HAND = ("robot0_eef_pos", "robot0_eef_quat")


def read_hdf5(source: Path, mapping: Mapping, progress: Progress | None = None) -> tuple[Raw, ...]:
    """A recording for each episode.

    Raises:
        RecordingError: h5py is not installed, or it is no such file.
    """
    with extra("hdf5", "HDF5 needs h5py", RecordingError, source):
        import h5py
    try:
        with h5py.File(source, "r") as file:
            if "data" not in file:
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
    except OSError as error:
        raise RecordingError(f"cannot be read as HDF5: {error}", file=source) from error
    if not found:
        raise RecordingError("no episodes in it", remedy="Record some.", file=source)
    return tuple(found)


def _episode(group: Any, name: str, source: Path, rate: float | None) -> Raw:
    if "obs" not in group:
        raise RecordingError(
            f"{group.name} has no observations",
            remedy="Convert the states to observations first, with robomimic's "
            "dataset_states_to_obs.py.",
            file=source,
        )
    obs = group["obs"]
    columns: dict[str, Any] = {}
    if _JOINTS in obs:
        for j, column in enumerate(np.asarray(obs[_JOINTS], dtype=float).T):
            columns[f"{_JOINTS}_{j}"] = column
    if all(key in obs for key in _HAND):
        for axis, column in zip("xyz", np.asarray(obs[_HAND[0]], dtype=float).T, strict=True):
            columns[f"eef.position.{axis}"] = column
        for axis, column in zip("xyzw", np.asarray(obs[_HAND[1]], dtype=float).T, strict=True):
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
    poses = {
        key.removesuffix("_pos"): _first(obs[key], obs[f"{key[:-4]}_quat"])
        for key in obs
        if key.endswith("_pos") and f"{key[:-4]}_quat" in obs and not key.startswith("robot")
    }
    return Raw(name, from_arrays(columns, source, "episodes of robosuite"), told, poses)


def _first(p: Any, q: Any) -> Any:
    """The object's pose at the start (4, 4)."""
    return pose(rotation_from_quaternion(np.roll(np.asarray(q[0], dtype=float), 1)), p[0])


def _rate(data: Any) -> float | None:
    """Hz, from the environment's arguments; None where they do not say."""
    text = data.attrs.get("env_args") or data.attrs.get("env_info")
    try:
        found = json.loads(text) if text else {}
    except (TypeError, ValueError):
        return None
    rate = found.get(_RATE[0], {}).get(_RATE[1]) or found.get(_RATE[1])
    return float(rate) if rate else None


def _number(name: str) -> tuple[int, str]:
    digits = "".join(filter(str.isdigit, name))
    return (int(digits) if digits else 0, name)
