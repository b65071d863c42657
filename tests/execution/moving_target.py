"""A small task for planners in diagrams: two short screws, kept to one object."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drake_screw.demonstrations import Demonstration
from drake_screw.execution import Choice, PlanningOutcome
from drake_screw.planning import Cause, Plan, ReferencePlanner
from drake_screw.robot import Arm
from drake_screw.screws import inverse, pose, rotation_angle, translation_distance

X_WO = np.stack([pose(np.eye(3), [0.9, 0.3, 0.0]), pose(np.eye(3), [0.5, -0.4, 0.0])])


class SmallSteps:
    """A `Chooser` with one demonstration at the first of two objects, a bowl and a cup.

    Args:
        arm: that is planned for.
        guides: (g, 4, 4) X_WE while the objects are at X_WO.
    """

    names = ("bowl", "cup")

    def __init__(self, arm: Arm, guides: np.ndarray) -> None:
        self.arm = arm
        owners, kept = np.zeros(len(guides), dtype=np.int64), np.arange(len(guides))
        X_OE = inverse(X_WO[0]) @ guides
        self.demonstration = Demonstration("shown", X_OE, owners, X_WO, guides, kept)
        self.blocked = False
        self.asked: list[str] = []

    def choose(self, X_WO: np.ndarray, q: np.ndarray) -> Choice | PlanningOutcome:
        self.asked.append("choose")
        return self._planned(X_WO, q)

    def keep(self, choice: Choice, X_WO: np.ndarray, q: np.ndarray) -> Choice | PlanningOutcome:
        self.asked.append("keep")
        return self._planned(X_WO, q)

    def free(self, q: np.ndarray, X_WO: np.ndarray) -> bool:
        return not self.blocked

    def apart(self, X_WA: np.ndarray, X_WB: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return translation_distance(X_WA, X_WB), rotation_angle(X_WA, X_WB)

    def _planned(self, X_WO: np.ndarray, q: np.ndarray) -> Choice | PlanningOutcome:
        guides = self.demonstration.transfer(X_WO)
        plan: Plan = ReferencePlanner(self.arm, step=0.04).plan(q, guides)
        if not plan.success:
            found = plan.outcome
            cause, segment = Cause(int(found.cause)), int(found.segment)
            return PlanningOutcome(cause, segment, demonstration=self.demonstration.name)
        plan = replace(plan, guides=guides)
        return Choice(self.demonstration, plan, (), self.arm.margin_parts(plan.q))


def moved(x: float = 0.0, y: float = 0.0, *, cup: float = 0.0) -> np.ndarray:
    """X_WO with the bowl moved by so much, and the cup along y."""
    found = X_WO.copy()
    found[0, :2, 3] += x, y
    found[1, 1, 3] += cup
    return found
