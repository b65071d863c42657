"""What is not known exactly when a plan is executed: where objects are, and the arm's zeros."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from drake_screw.tasks import Symmetry
from drake_screw.typing import Array

LEAST = 2.0**-54
"""In place of 0, which would be infinitely far off; numbers from [0, 1) are multiples of 2^-53."""


@dataclass(frozen=True)
class Noise:
    """Standard deviations of what is normally distributed about 0, each number by itself.

    Attributes:
        object_position: m, of x and of y at which an object is measured.
        object_yaw: rad, of the yaw at which it is.
        joint_offset: rad, of revolute joints from what their encoders say.
        slide_offset: m, of prismatic ones.
    """

    object_position: float = 0.0
    object_yaw: float = 0.0
    joint_offset: float = 0.0
    slide_offset: float = 0.0

    def width(self, objects: int, joints: int) -> int:
        """How many numbers an instance takes; none without noise."""
        return 3 * objects + joints if self != Noise() else 0

    def drawn(
        self, chance: Array, symmetries: Sequence[Symmetry | None], slides: NDArray[np.bool_]
    ) -> tuple[Array, Array]:
        """What instances are disturbed by, by the inverse of the normal distribution.

        Args:
            chance: (N, width) from [0, 1).
            symmetries: of the k objects. One that may be turned by any angle about z has no yaw.
            slides: (n,) which of the arm's joints are prismatic.

        Returns:
            (N, k, 3) of the measured x, y (m) and yaw (rad) from the true ones, and (N, n) of the
            joints (rad or m) from what their encoders say.
        """
        N, k, n = len(chance), len(symmetries), len(slides)
        if chance.shape[1] == 0:
            return np.zeros((N, k, 3)), np.zeros((N, n))
        z = scipy.special.ndtri(np.maximum(chance, LEAST))
        yaws = [0.0 if _round(symmetry) else self.object_yaw for symmetry in symmetries]
        places = [[self.object_position, self.object_position, yaw] for yaw in yaws]
        offsets = np.where(slides, self.slide_offset, self.joint_offset)
        return z[:, : 3 * k].reshape(N, k, 3) * places, z[:, 3 * k :] * offsets

    @property
    def words(self) -> tuple[str, ...]:
        """What is disturbed, and by how much."""
        return tuple(
            words.format(value)
            for value, words in (
                (self.object_position, "x and y of objects are measured to {:g} m"),
                (self.object_yaw, "the yaw of objects to {:g} rad"),
                (self.joint_offset, "revolute joints of the arm to {:g} rad"),
                (self.slide_offset, "prismatic joints to {:g} m"),
            )
            if value > 0.0
        )


def _round(symmetry: Symmetry | None) -> bool:
    return symmetry is not None and symmetry.turns is None and symmetry.axis == (0.0, 0.0, 1.0)
