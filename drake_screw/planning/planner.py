"""What all batch planners have in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from numpy.typing import ArrayLike

from drake_screw.demonstrations import Demonstration
from drake_screw.planning.outcomes import Outcomes


class Planner(Protocol):
    """Answers for N instances and D demonstrations at once; see `BatchPlanner`."""

    def all_outcomes(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance with every demonstration."""
        ...

    def any_success(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance until one demonstration succeeds."""
        ...
