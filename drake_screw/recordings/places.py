"""Where an object was, in as many words as that takes: ``--object`` and `Mapping.objects`."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drake_screw.errors import RecordingError
from drake_screw.screws import normalized, pose, pose_from_planar, rotation_from_quaternion
from drake_screw.typing import Array

FORMS = (
    "Give x,y or x,y,yaw in m and rad; 16 numbers of a 4 x 4 matrix, row by row; "
    "x,y,z,xyzw:0,0,0,1 (or wxyz:1,0,0,0); or hand:12.4s+0,0,0.12, where the hand was then, "
    "shifted in its own frame."
)

_HAND = re.compile(r"hand:([\d.eE+-]*?\d\.?)s(?:\+(.+))?$")
_POSE = re.compile(r"(.+),\s*(xyzw|wxyz):(.+)$")


@dataclass(frozen=True)
class Given:
    """A place that was given for an object of a recording, as text or numbers."""

    name: str
    place: object
    file: Path | None = None
    """of the recording"""

    def pose(self, z: float | None, hand: Callable[[float], Array]) -> tuple[Array, str]:
        """X_WO (4, 4), and how it was found, in words.

        Args:
            z: m, where objects of that name stand, upright; None where they may do otherwise, so
                that x, y and yaw do not say it.
            hand: X_WE (4, 4) at a time in s since the recording's first sample.

        Raises:
            RecordingError: it is no place.
        """
        if isinstance(self.place, str):
            at_hand, pose = _HAND.match(self.place.strip()), _POSE.match(self.place.strip())
            if at_hand:
                return self._at_hand(at_hand, hand)
            if pose:
                return self._of_quaternion(pose), "given as a pose"
        numbers = self._numbers(self.place)
        if len(numbers) in (2, 3) and z is None:
            raise self._error(
                "x, y and perhaps yaw, which is not all: in the scenario its height varies, or it "
                "stands on something or is tilted"
            )
        if len(numbers) in (2, 3) and z is not None:
            planar = np.array([*numbers, 0.0][:3])
            return pose_from_planar(planar, z), f"given, at the scenario's height {z:.4g} m"
        if len(numbers) == 16:
            return self._matrix(np.reshape(numbers, (4, 4))), "given as a matrix"
        raise self._error(f"{len(numbers)} numbers")

    def _at_hand(self, found: re.Match[str], hand: Callable[[float], Array]) -> tuple[Array, str]:
        (time,) = self._numbers(found.group(1))
        shift = self._numbers(found.group(2)) if found.group(2) else [0.0, 0.0, 0.0]
        if len(shift) != 3:
            raise self._error(f"a shift by {len(shift)} numbers, where three are needed")
        X = hand(time)
        X_WO = np.eye(4)
        X_WO[:3, 3] = X[:3, 3] + X[:3, :3] @ shift
        return X_WO, f"where the hand was at {time:g} s, upright"

    def _of_quaternion(self, found: re.Match[str]) -> Array:
        p, q = self._numbers(found.group(1)), np.array(self._numbers(found.group(3)))
        if len(p) != 3 or len(q) != 4:
            raise self._error(f"{len(p)} and {len(q)} numbers, where 3 and 4 are needed")
        if abs(np.linalg.norm(q) - 1.0) > 0.01:
            raise self._error(f"a quaternion of length {np.linalg.norm(q):.3g}, where 1 is needed")
        return pose(rotation_from_quaternion(np.roll(q, 1) if found.group(2) == "xyzw" else q), p)

    def _matrix(self, X: Array) -> Array:
        R = X[:3, :3]
        with np.errstate(over="ignore", invalid="ignore"):
            fits = np.abs(R.T @ R - np.eye(3)).max() < 1e-3 and np.linalg.det(R) > 0.0
        if not fits or not np.allclose(X[3], [0, 0, 0, 1], atol=1e-6):
            raise self._error("a matrix that is not a pose (its last row is 0,0,0,1)")
        return normalized(X)

    def _numbers(self, place: object) -> list[float]:
        try:
            parts = place.split(",") if isinstance(place, str) else np.ravel(np.array(place))
            numbers = [float(part) for part in parts]
        except ValueError as error:
            raise self._error(f"'{place}'") from error
        if not np.isfinite(numbers).all():
            raise self._error("a number that is not finite")
        return numbers

    def _error(self, found: str) -> RecordingError:
        message = f"object {self.name}: found {found}"
        return RecordingError(message, remedy=FORMS, file=self.file)


def parse_objects(words: list[str]) -> dict[str, str]:
    """The values of ``--object``: texts by name.

    >>> parse_objects(["bowl=0.9,0.1", "cup@hand:12.4s+0,0,0.12"])
    {'bowl': '0.9,0.1', 'cup': 'hand:12.4s+0,0,0.12'}

    Raises:
        RecordingError: a word is no such thing, or an object is there twice.
    """
    found: dict[str, str] = {}
    for word in words:
        parts = re.match(r"([^=@]+)(=|@(?=hand:))(.+)$", word)
        if not parts:
            raise RecordingError(
                f"--object {word}: expected NAME=PLACE or NAME@hand:TIMEs", remedy=FORMS
            )
        name = parts.group(1).strip()
        if name in found:
            raise RecordingError(f"--object: '{name}' is given twice", remedy="Give it once.")
        found[name] = parts.group(3)
    return found
