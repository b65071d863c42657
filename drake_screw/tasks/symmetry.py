"""Bodies that look the same after a turn about their axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Symmetry:
    """A body that is the same to the task after some turns about an axis of its frame.

    Attributes:
        axis: unit vector in the body's frame; the axis leads through its origin.
        turns: how many there are in a full turn; None for a body of revolution, which is the same
            after any turn.

    >>> Symmetry(turns=4).tried(24), Symmetry().tried(24)
    (4, 24)
    """

    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    turns: int | None = None

    def __post_init__(self) -> None:
        if self.turns is not None and self.turns < 1:
            raise ValueError(f"turns must be at least 1, it is {self.turns}")
        if abs(np.linalg.norm(self.axis) - 1.0) > 1e-9:
            raise ValueError(f"axis must be a unit vector, it is {self.axis}")

    def tried(self, any_angle: int) -> int:
        """How many turns are tried, where so many are of a body of revolution."""
        return any_angle if self.turns is None else self.turns
