from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drake_screw.acquisition import Suggestion
from drake_screw.acquisition.interactive_teacher import InteractiveTeacher
from drake_screw.demonstrations import Recording
from drake_screw.screws import pose_from_planar
from drake_screw.tasks import ObjectArea, WorkArea

JOINTS = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
AREA = WorkArea((ObjectArea("bowl", (0.7, 0.0, 0.0), (1.0, 0.5, 0.0), 0.0),))


@dataclass
class FakePrompt:
    recording: Recording | None

    def ask(self, suggestion: Suggestion, number: int) -> Recording | None:
        return self.recording


def test_the_teacher_says_how_far_off_it_was() -> None:
    X_WO = pose_from_planar(np.array([[0.8, 0.3, 0.0]]), np.zeros(1))
    recording = Recording("demo_01", JOINTS, np.arange(2.0), np.zeros((2, 7)), X_WO)
    place = Suggestion(3, np.array([[0.8, 0.34, 0.0]]))
    arguments = {"number": 0, "used": (), "rng": np.random.default_rng(0)}
    lesson = InteractiveTeacher(FakePrompt(recording), AREA).demonstrate(place, **arguments)
    assert lesson.recording is recording
    assert lesson.remark == "led by hand, 4 cm from the suggestion"
    lesson = InteractiveTeacher(FakePrompt(None), AREA).demonstrate(place, **arguments)
    assert lesson.recording is None
