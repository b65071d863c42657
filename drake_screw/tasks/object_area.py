"""Where one object of a task may stand."""

from __future__ import annotations

import math
from dataclasses import dataclass

Range = float | tuple[float, float]
"""A number, or the least and the greatest."""

SIX = tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class ObjectArea:
    """Where one object may stand, seen from the world or from the object it stands on.

    Turns are roll, pitch and yaw as Drake has them: R = Rz(yaw) Ry(pitch) Rx(roll).

    Attributes:
        name: of the object.
        lower, upper: x, y in m and yaw in rad; equal where the coordinate is fixed.
        z: m, height of the object's frame.
        roll, pitch: rad.
        any_orientation: whether it is uniform on SO(3), whatever ranges of angles there are.
        on: the object it stands on; in the world if None.

    >>> ball = ObjectArea("ball", (0.5, 0.0, 0.0), (0.9, 0.0, 0.0), z=0.1, any_orientation=True)
    >>> [round(angle, 3) for angle in ball.greatest]
    [0.9, 0.0, 3.142, 0.1, 3.142, 1.571]
    """

    name: str
    lower: tuple[float, float, float]
    upper: tuple[float, float, float]
    z: Range
    roll: Range = 0.0
    pitch: Range = 0.0
    any_orientation: bool = False
    on: str | None = None

    @property
    def least(self) -> SIX:
        """Least x, y, yaw, z, roll, pitch."""
        return self._ends(self.lower, 0, -1.0)

    @property
    def greatest(self) -> SIX:
        """Greatest x, y, yaw, z, roll, pitch."""
        return self._ends(self.upper, 1, 1.0)

    @property
    def varies(self) -> bool:
        """Whether it may stand in more than one pose."""
        return self.least != self.greatest

    @property
    def height(self) -> float | None:
        """m, of its frame in the world; None where it varies or is that of what it stands on."""
        fixed = self.least[3] == self.greatest[3] and self.on is None
        return self.least[3] if fixed else None

    @property
    def upright(self) -> bool:
        """Whether it is never tilted."""
        return self.least[4:] == self.greatest[4:] == (0.0, 0.0)

    @property
    def beyond_planar(self) -> bool:
        """Whether z, roll or pitch vary."""
        return self.least[3:] != self.greatest[3:]

    def _ends(self, planar: tuple[float, float, float], end: int, sign: float) -> SIX:
        x, y, yaw = planar
        z, roll, pitch = (_end(value, end) for value in (self.z, self.roll, self.pitch))
        if self.any_orientation:
            yaw = roll = sign * math.pi
            pitch = sign * math.pi / 2.0
        return x, y, yaw, z, roll, pitch


def _end(value: Range, end: int) -> float:
    return value[end] if isinstance(value, tuple) else value
