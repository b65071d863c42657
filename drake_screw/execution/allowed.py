"""What an execution may do and still count as flawless."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum


class Flaw(StrEnum):
    """In what way an execution was not as it should be."""

    PUSHED = "pushed"
    CONTACT = "contact"
    OUTSIDE_LIMITS = "outside limits"
    TOO_FAST = "too fast"
    NOT_DONE = "not done"
    OFF = "off"


@dataclass(frozen=True)
class Allowed:
    """What an execution may do.

    Attributes:
        position, rotation: m and rad, of the end effector from where it ought to be at that time.
        displacement, turn: m and rad, of an object that can be pushed, from where it had settled.
        contact_force: N, with which the robot may touch something; with 0 it must touch nothing.
    """

    position: float = 10e-3
    rotation: float = 0.1
    displacement: float = 2e-3
    turn: float = 0.05
    contact_force: float = 0.0


@dataclass(frozen=True)
class Flawed:
    """A flaw of an execution: its kind, in words, and since when in s, None if never begun."""

    kind: Flaw
    words: str
    time: float | None = None

    def __str__(self) -> str:
        return self.words


def said(flaws: Sequence[Flawed]) -> str:
    """All flaws in a line."""
    return "; ".join(map(str, flaws))
