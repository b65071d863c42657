"""A teacher who is a person at the screen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from drake_screw.acquisition.events import Suggestion
from drake_screw.acquisition.teacher import Lesson
from drake_screw.demonstrations import Recording
from drake_screw.tasks import WorkArea


class DemonstrationPrompt(Protocol):
    """Where a person is asked for a demonstration, and gives it: a teaching page, say."""

    def ask(self, suggestion: Suggestion, number: int) -> Recording | None:
        """The accepted recording of demonstration `number` (from 0); None if there will be none."""
        ...


@dataclass(frozen=True)
class InteractiveTeacher:
    """Asks a person.

    Attributes:
        prompt: where they are asked.
        area: where objects may stand.
    """

    prompt: DemonstrationPrompt
    area: WorkArea

    def demonstrate(
        self,
        suggestion: Suggestion,
        *,
        number: int,
        used: tuple[Recording, ...],
        rng: np.random.Generator,
    ) -> Lesson:
        """See `Teacher.demonstrate`; what a person does depends on them alone."""
        recording = self.prompt.ask(suggestion, number)
        if recording is None:
            return Lesson(None, "the teacher has no demonstration for this place")
        away = self.area.away(self.area.coordinates(recording.X_WO), suggestion.coordinates)
        source = "dropped into the folder" if recording.source is not None else "led by hand"
        return Lesson(recording, f"{source}, {away * 100:.0f} cm from the suggestion")
