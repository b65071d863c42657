"""Lessons of which no motion would be kept are passed over, and that is said."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drake_screw.acquisition import Lesson, Suggestion, UsableLessons
from drake_screw.demonstrations import Demonstration, NoMotionKept, Recording
from tests.acquisition.conftest import learn, recording_at

PLACE = Suggestion(0, np.zeros((1, 3)))


@dataclass(frozen=True)
class Library:
    """Gives its recordings in their order."""

    names: tuple[str, ...]

    def demonstrate(
        self,
        suggestion: Suggestion,
        *,
        number: int,
        used: tuple[Recording, ...],
        rng: np.random.Generator,
    ) -> Lesson:
        left = [name for name in self.names if name not in {r.name for r in used}]
        if not left:
            return Lesson(None, "all are used")
        return Lesson(recording_at(left[0], 0.1, 0.2), f"the first of {len(left)}")


def picky(recording: Recording) -> Demonstration:
    if recording.name.startswith("still"):
        raise NoMotionKept("no motion is kept", "small region", remedy="Record again.")
    return learn(recording)


def ask(*names: str, used: tuple[Recording, ...] = ()) -> Lesson:
    teacher = UsableLessons(Library(names), picky)
    return teacher.demonstrate(PLACE, number=0, used=used, rng=np.random.default_rng(0))


def test_a_usable_lesson_is_passed_on_as_it_is() -> None:
    lesson = ask("a", "still_1")
    assert lesson.recording is not None
    assert (lesson.recording.name, lesson.remark) == ("a", "the first of 2")


def test_the_next_recording_is_taken_and_the_reason_told() -> None:
    lesson = ask("still_1", "still_2", "a")
    assert lesson.recording is not None
    assert lesson.recording.name == "a"
    assert "still_1 is not used: no motion is kept" in lesson.remark
    assert "still_2 is not used" in lesson.remark


def test_there_may_be_none() -> None:
    lesson = ask("still_1", "still_2")
    assert lesson.recording is None
    assert lesson.remark.endswith("all are used")
    assert "still_2 is not used" in lesson.remark
