"""A teacher's lessons without those of which no motion would be kept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drake_screw.acquisition.events import Suggestion
from drake_screw.acquisition.teacher import Lesson, Teacher
from drake_screw.demonstrations import Demonstration, NoMotionKept, Recording

MOST_REFUSED = 32
"""Recordings that are refused at one request before it goes unanswered."""


@dataclass(frozen=True)
class UsableLessons:
    """Asks a teacher again where next to nothing would be kept of a recording.

    The remark on a lesson, or on there being none, says which recordings were passed over and why.

    Attributes:
        teacher: that is asked.
        learn: turns a recording into a demonstration, or raises `NoMotionKept`.
    """

    teacher: Teacher
    learn: Callable[[Recording], Demonstration]

    def demonstrate(
        self,
        suggestion: Suggestion,
        *,
        number: int,
        used: tuple[Recording, ...],
        rng: np.random.Generator,
    ) -> Lesson:
        """See `Teacher.demonstrate`."""
        refused: list[Recording] = []
        reasons: list[str] = []
        while len(refused) < MOST_REFUSED:
            lesson = self.teacher.demonstrate(
                suggestion, number=number, used=(*used, *refused), rng=rng
            )
            if lesson.recording is None:
                return Lesson(None, "; ".join([*reasons, lesson.remark]))
            try:
                self.learn(lesson.recording)
            except NoMotionKept as error:
                refused.append(lesson.recording)
                reasons.append(f"{lesson.recording.name} is not used: {error.message}")
            else:
                return Lesson(lesson.recording, "; ".join([lesson.remark, *reasons]))
        return Lesson(None, "; ".join(reasons))
