"""What chooses plans for a `ScrewPlanner`, and what it answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Cause, Plan, Turned
from drake_screw.robot import Arm
from drake_screw.typing import Array


@dataclass(frozen=True)
class PlanningOutcome:
    """What became of planning: success, or how far the best attempt came.

    Attributes:
        cause: success, or why it failed; NOT_TRIED before anything was planned.
        segment: in which screw segment, from 0; None of a success.
        joint: the name of the joint that is at its limit; empty otherwise.
        demonstration: the name of the one that was planned with.
    """

    cause: Cause = Cause.NOT_TRIED
    segment: int | None = None
    joint: str = ""
    demonstration: str = ""

    @property
    def success(self) -> bool:
        """Whether there is a plan."""
        return self.cause is Cause.SUCCESS

    def __str__(self) -> str:
        where = "" if self.segment is None else f" in segment {self.segment + 1}"
        by = f" with {self.demonstration}" if self.demonstration else ""
        match self.cause:
            case Cause.SUCCESS:
                return f"planned{by}"
            case Cause.JOINT_LIMIT:
                return f"no plan: {self.joint} meets its limit{where}{by}"
            case Cause.UNREACHABLE:
                return f"no plan: out of reach{where}{by}"
            case Cause.COLLISION:
                return f"no plan: the arm touches something{where}{by}"
            case _:
                return "not planned yet"


@dataclass(frozen=True, eq=False)
class Choice:
    """A plan, and what it was chosen from.

    Attributes:
        demonstration: that is carried over.
        plan: its joint path.
        turned: how symmetric bodies are turned.
        margins: (n,) how near each joint comes to a limit, in parts of its range: 0 at it, 0.5 at
            most.
    """

    demonstration: Demonstration
    plan: Plan
    turned: tuple[Turned, ...]
    margins: Array

    @property
    def variant(self) -> int:
        """The number of the demonstration's turn (and way to come), as outcomes have it."""
        return int(self.plan.outcome.variant)


class Chooser(Protocol):
    """Plans with all demonstrations at hand. It is asked, and remembers nothing.

    Attributes:
        arm: that is planned for.
        names: of the k objects.
    """

    arm: Arm
    names: tuple[str, ...]

    def choose(self, X_WO: Array, q: Array) -> Choice | PlanningOutcome:
        """The best of all plans that touch nothing, or how planning failed.

        Args:
            X_WO: (k, 4, 4) the objects.
            q: (n,) rad or m, where the arm rests.
        """
        ...

    def keep(self, choice: Choice, X_WO: Array, q: Array) -> Choice | PlanningOutcome:
        """The plan of the same demonstration and turn for other poses of the objects.

        Whether it touches anything is not looked at. Takes what `choose` does.
        """
        ...

    def free(self, q: Array, X_WO: Array) -> bool:
        """Whether straight lines through joint positions q (m, n) touch nothing at X_WO."""
        ...

    def apart(self, X_WA: Array, X_WB: Array) -> tuple[Array, Array]:
        """How far objects moved from poses (k, 4, 4) to others, as far as the task can tell.

        Returns:
            (k,) m and (k,) rad; turns about an axis of symmetry do not count.
        """
        ...
