"""Who gives demonstrations: the common shape of all teachers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from drake_screw.acquisition.events import Suggestion
from drake_screw.demonstrations import Recording


@dataclass(frozen=True, eq=False)
class Lesson:
    """A teacher's answer.

    Attributes:
        recording: None where no demonstration is to be had.
        remark: human-readable, "nearest recording of region 3, 4 cm away", or why
            there is none.
    """

    recording: Recording | None
    remark: str


class Teacher(Protocol):
    """Answers requests for demonstrations.

    A teacher keeps no secrets between requests: what it answers depends only on the request, the
    recordings already used and the random numbers it is handed, so that a resumed run goes on as
    if it had never stopped.
    """

    def demonstrate(
        self,
        suggestion: Suggestion,
        *,
        number: int,
        used: tuple[Recording, ...],
        rng: np.random.Generator,
    ) -> Lesson:
        """Give demonstration `number` (from 0) at the suggested instance, or say why not."""
        ...
