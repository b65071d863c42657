"""What a `ScrewPlanner` plans with, from a scenario."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drake_screw.assembly.planning_setup import PlanningSetup
from drake_screw.assembly.ranked_plans import ranked_plans
from drake_screw.assembly.ways import Way
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import ScenarioError
from drake_screw.execution.choosing import Choice, PlanningOutcome
from drake_screw.planning import Cause, Outcomes
from drake_screw.planning.roll import turned_apart
from drake_screw.screws import rotation_angle, translation_distance
from drake_screw.typing import Array


class PlanChooser:
    """Plans with a scenario's planner, as `Setup.plan` does; a `Chooser`.

    Args:
        setup: of the scenario.
        demonstrations: to choose from.

    Raises:
        ValueError: there are no demonstrations.
        ScenarioError: the scenario has several arms; a planner in a diagram moves one.
    """

    def __init__(self, setup: PlanningSetup, demonstrations: Sequence[Demonstration]) -> None:
        if not demonstrations:
            raise ValueError("a planner needs at least one demonstration")
        if len(setup.arms) > 1:
            raise ScenarioError(
                "robot.arms: a planner inside a diagram moves one arm, and here are several",
                remedy="Write a scenario with the joints, end effector and start of one of them.",
                file=setup.scenario.source,
            )
        self.arm = setup.workcell.arm
        self.names = tuple(o.name for o in setup.area.objects)
        self._demonstrations = tuple(demonstrations)
        self._planner = setup.careful_planner

    def choose(self, X_WO: Array, q: Array) -> Choice | PlanningOutcome:
        """The best plan, as `ranked_plans` has it, or how far the best attempt came."""
        demonstrations = self._demonstrations
        ways = [Way(self._planner, self.arm, q)]
        found = ranked_plans(ways, demonstrations, X_WO, self.names, most=1)
        if not found:
            outcomes = self._planner.all_outcomes(demonstrations, X_WO[None], q)[0]
            best = int(outcomes.best_attempt)
            return self._failed(outcomes[best], demonstrations[best])
        best_plan = found[0]
        margins = self.arm.margin_parts(best_plan.plan.q)
        return Choice(best_plan.demonstration, best_plan.plan, best_plan.turned, margins)

    def keep(self, choice: Choice, X_WO: Array, q: Array) -> Choice | PlanningOutcome:
        """The plan of the same demonstration and variant, whatever it touches."""
        planner, demonstration = self._planner.planner, choice.demonstration
        plan = planner.plan(demonstration, X_WO, q, choice.variant)
        if not plan.success:
            return self._failed(plan.outcome, demonstration)
        turned = planner.symmetries.named(demonstration, X_WO, plan.angles, self.names)
        return Choice(demonstration, plan, turned, self.arm.margin_parts(plan.q))

    def free(self, q: Array, X_WO: Array) -> bool:
        """Whether straight lines through q (m, n) keep the scenario's clearance."""
        return self._planner.checker.free(q, X_WO)

    def apart(self, X_WA: Array, X_WB: Array) -> tuple[Array, Array]:
        """(k,) m and (k,) rad that objects moved; any turn about its axis is none for a bowl."""
        turned = np.array(rotation_angle(X_WA, X_WB))
        for i, symmetry in enumerate(self._planner.planner.symmetries.objects):
            if symmetry is not None and symmetry.turns is None:
                turned[i] = turned_apart(X_WA[i], X_WB[i], symmetry.axis)
        return translation_distance(X_WA, X_WB), turned

    def _failed(self, outcome: Outcomes, demonstration: Demonstration) -> PlanningOutcome:
        cause, joint = Cause(int(outcome.cause)), int(outcome.joint)
        name = self.arm.joint_names[joint] if cause is Cause.JOINT_LIMIT else ""
        return PlanningOutcome(cause, int(outcome.segment), name, demonstration.name)
