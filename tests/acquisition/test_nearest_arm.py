"""Of several arms the one nearest to the object shows the task, or else the next nearest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drake_screw.acquisition import Lesson, Suggestion
from drake_screw.acquisition.nearest_arm import NearestArm, nearest_first
from drake_screw.demonstrations import Recording
from drake_screw.tasks import ObjectArea, WorkArea

AREA = WorkArea((ObjectArea("bowl", (0.7, -0.3, 0.0), (0.9, 0.3, 0.0), 0.0),))
SHOULDERS = np.array([[0.0, 0.3, 0.4], [0.0, -0.3, 0.4]])
LEFT, RIGHT = ([0.8, y, 0.0] for y in (0.2, -0.2))
RECORDING = Recording("demo", (), np.zeros(2), np.zeros((2, 0)), np.eye(4)[None])


@dataclass
class Shows:
    """A teacher of one arm, who can or cannot."""

    can: bool
    asked: int = 0

    def demonstrate(self, suggestion: Suggestion, **_: object) -> Lesson:
        self.asked += 1
        return Lesson(RECORDING if self.can else None, "shown" if self.can else "out of reach")


def asked(place: Sequence[float], left: Shows, right: Shows) -> Lesson:
    teacher = NearestArm(("left", "right"), (left, right), SHOULDERS, AREA)
    where = Suggestion(0, np.array([place]))
    return teacher.demonstrate(where, number=0, used=(), rng=np.random.default_rng(0))


def test_the_nearest_arm_shows_it() -> None:
    left, right = Shows(True), Shows(True)
    assert asked(RIGHT, left, right).remark == "shown, with arm right"
    assert (left.asked, right.asked) == (0, 1)
    assert asked(LEFT, left, right).remark == "shown, with arm left"


def test_the_next_nearest_does_where_it_cannot() -> None:
    lesson = asked(RIGHT, Shows(True), Shows(False))
    assert lesson.recording is RECORDING
    assert lesson.remark == "shown, with arm left"


def test_where_none_can_each_says_why() -> None:
    lesson = asked(LEFT, Shows(False), Shows(False))
    assert lesson.recording is None
    assert lesson.remark == "left: out of reach; right: out of reach"


def test_of_arms_alike_the_first_is_first() -> None:
    assert nearest_first(SHOULDERS, AREA.X_WO(np.array([[0.8, 0.0, 0.0]]))).tolist() == [0, 1]
