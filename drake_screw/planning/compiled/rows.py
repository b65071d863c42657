"""The layout of a block of lanes: which row holds which quantity.

A block is one flat float64 array of rows of LANES numbers, one number a lane. Row r of lane i is at
r * LANES + i. Poses are stored as three rows of [R | p], row by row.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numba import uintp

from drake_screw.planning.compiled.inner import inner

LANES = 16

TWIST = 0  # [w; v] per unit of s in B about its origin
POSE = 6  # X_BE at the end of the step
TARGET = 18  # X_BG, the guiding pose ahead
STEP = 30  # of the segment parameter s
NEXT_STEP = 31  # the step to try next
PROGRESS = 32  # s at the start of the step
HAND = 33  # square of the end effector's motion: turn^2 + (travel / CHARACTERISTIC_LENGTH)^2
ACCEPTED = 34  # 1 if the error of the step is small enough, else 0
AIM = 35  # 1 if the lane starts a segment, 2 if a correction at its end
OFF_TURN = 36  # squared Frobenius distance of the rotations of pose and target
OFF_PLACE = 37  # squared distance of their positions, m^2
EVENT = 38  # 1 if the lane needs a decision
RATE_START = 39  # |dq/ds|^2 at the start of the step
RATE_END = 40  # and at its end
MARGIN = 41  # least distance of the step to a joint limit, from below
RESIDUAL = 42  # square of the motion still ahead that the joints cannot give
ORIENTATION = 43  # det(J_start^T J_end); negative if a singularity lies between
VOLUME_START = 44  # det(J^T J) at the start of the step, of at most six joints
VOLUME_END = 45  # and at its end
_HEAD = 46


@dataclass(frozen=True)
class Rows:
    """Rows whose place depends on the number of joints n, and of directions to follow."""

    n: int
    directions: int = 6

    @property
    def q(self) -> int:
        """Joint positions at the start of the step."""
        return _HEAD

    @property
    def q_stage(self) -> int:
        """Joint positions at the stage being evaluated; the last stage is the end of the step."""
        return _HEAD + self.n

    @property
    def rate(self) -> int:
        """dq/ds at the stage last evaluated."""
        return _HEAD + 2 * self.n

    def slope(self, stage: int) -> int:
        """dq/ds at a stage, counted from 0."""
        return _HEAD + (3 + stage) * self.n

    @property
    def columns(self) -> int:
        """J's columns at the start of the step, of arms that cannot move around a singularity."""
        return self.slope(7)

    @property
    def kept(self) -> int:
        """From here on: what `arrive` keeps for `aim`."""
        return self.columns + (self.directions * self.n if self.n <= self.directions else 0)


@inner
def at(row: Any, i: Any) -> Any:
    """Index of a row and lane; unsigned, which spares the check for indices from the end."""
    return uintp(row) * uintp(LANES) + uintp(i)
