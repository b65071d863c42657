"""Trying a workcell out: a simulated demonstration, and plans with it all over the table."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drake_screw.acquisition import Suggestion
from drake_screw.acquisition.simulated import SimulatedTeacher
from drake_screw.assembly.recorder import Learning, Recorder
from drake_screw.demonstrations import Demonstration, FaithfulConfig, NoMotionKept
from drake_screw.planning import BatchPlanner, Symmetries
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.robot import Workcell
from drake_screw.tasks import ObjectArea, Symmetry, WorkArea
from drake_screw.typing import Array

ROUND = Symmetry((0.0, 0.0, 1.0), None)
"""Of a bowl: any side will do."""


class Trial:
    """A workcell with one bowl, its arm starting somewhere.

    Args:
        workcell: with the bowl as its only object, and the start to be tried.
        motion: of the simulated teacher.
        z: m, height of the bowl's bottom.
        seed: of the teacher.
        free_axis: in the end effector's frame, about which its roll is free; None where none is.
    """

    def __init__(
        self,
        workcell: Workcell,
        motion: str,
        z: float,
        seed: int = 0,
        free_axis: tuple[float, float, float] | None = None,
    ) -> None:
        self.workcell = workcell
        self.remark = ""
        arm, chain = workcell.arm, workcell.arm.screw_chain()
        self.area = WorkArea((ObjectArea("bowl", (-9.0, -9.0, 0.0), (9.0, 9.0, 0.0), z),))
        self._seed = seed
        self._teacher = SimulatedTeacher(workcell, self.area, motion, free_axis)
        self._recorder = Recorder(arm, arm, self.area)
        symmetries = Symmetries.of(chain, [ROUND])
        planner = BatchPlanner(chain, symmetries=symmetries, free_axis=free_axis)
        self._planner = CollisionFreePlanner(planner, workcell)

    def demonstration(self, x: float, y: float) -> Demonstration | None:
        """What is learned of a demonstration with the bowl at x, y; None, and a remark, if none."""
        place = Suggestion(0, np.array([[x, y, 0.0]]))
        rng = np.random.default_rng(self._seed)
        lesson = self._teacher.demonstrate(place, number=0, used=(), rng=rng)
        self.remark = lesson.remark
        if lesson.recording is None:
            return None
        try:
            return self._recorder.learn(lesson.recording, Learning(FaithfulConfig()))
        except NoMotionKept as error:
            self.remark = str(error)
            return None

    def success(self, demonstrations: list[Demonstration], xy: Array) -> NDArray[np.bool_]:
        """Whether bowls at xy (M, 2) are planned for, by any of the demonstrations: (M,)."""
        if not demonstrations or len(xy) == 0:
            return np.zeros(len(xy), dtype=bool)
        coordinates = np.concatenate([xy, np.zeros((len(xy), 1))], axis=1)[:, None]
        outcomes = self._planner.any_success(
            demonstrations, self.area.X_WO(coordinates), self.workcell.start
        )
        return np.asarray(outcomes.any_success)
