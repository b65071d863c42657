"""What an execution is doing, and why it failed if it did."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Phase(StrEnum):
    """Where an execution stands."""

    IDLE = "idle"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"


@dataclass(frozen=True)
class ExecutionStatus:
    """The value of a follower's status port.

    Attributes:
        phase: idle, running, done or failed.
        segment: the current screw segment, from 0; where it failed; None if there is none.
        reason: why it failed, in words; empty otherwise.
    """

    phase: Phase = Phase.IDLE
    segment: int | None = None
    reason: str = ""

    @property
    def ended(self) -> bool:
        """Whether the plan at hand is over, well or not."""
        return self.phase in (Phase.DONE, Phase.FAILED)

    def __str__(self) -> str:
        where = "" if self.segment is None else f" in segment {self.segment + 1}"
        match self.phase:
            case Phase.FAILED:
                return f"failed{where}: {self.reason}"
            case Phase.RUNNING:
                return f"running{where}"
            case _:
                return self.phase.value
