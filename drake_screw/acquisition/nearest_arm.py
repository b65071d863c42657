"""A teacher of several arms: the one nearest to the object shows the task."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drake_screw.acquisition.events import Suggestion
from drake_screw.acquisition.teacher import Lesson, Teacher
from drake_screw.demonstrations import Recording
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array


def nearest_first(p_WS: Array, X_WO: Array) -> NDArray[np.int64]:
    """Arms by how far their shoulders p_WS (A, 3) are from the first of X_WO (k, 4, 4), from above.

    Of several alike the first is first.
    """
    away = np.linalg.norm(p_WS[:, :2] - X_WO[0, :2, 3], axis=1)
    return np.argsort(np.round(away, 9), kind="stable")


@dataclass(frozen=True, eq=False)
class NearestArm:
    """Has the arm that is nearest to the first object show it, or else the next nearest.

    Attributes:
        names: of the arms.
        teachers: of each arm.
        p_WS: (A, 3) m, their shoulders.
        area: the work area.
    """

    names: tuple[str, ...]
    teachers: Sequence[Teacher]
    p_WS: Array
    area: WorkArea

    def demonstrate(
        self,
        suggestion: Suggestion,
        *,
        number: int,
        used: tuple[Recording, ...],
        rng: np.random.Generator,
    ) -> Lesson:
        """See `Teacher.demonstrate`; a remark says which arm it is of, or why none shows it."""
        remarks = []
        X_WO = self.area.X_WO(suggestion.coordinates)
        for arm in nearest_first(self.p_WS, X_WO).tolist():
            teacher, name = self.teachers[arm], self.names[arm]
            lesson = teacher.demonstrate(suggestion, number=number, used=used, rng=rng)
            if lesson.recording is not None:
                return replace(lesson, remark=f"{lesson.remark}, with arm {name}")
            remarks.append(f"{name}: {lesson.remark}")
        return Lesson(None, "; ".join(remarks))
