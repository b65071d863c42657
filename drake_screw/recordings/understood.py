"""What recordings are understood with, and what comes of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from drake_screw.demonstrations import Recording
from drake_screw.recordings.mapping import Mapping
from drake_screw.robot import Arm
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array


@dataclass(frozen=True)
class Robot:
    """What a recording is understood with.

    Attributes:
        arm: that was led.
        area: the objects, and where they may be.
        base: name of the frame that poses are seen from.
        velocity_limits: (n,) rad/s or m/s.
        name: of the arm, where several may have been led.
    """

    arm: Arm
    area: WorkArea
    base: str
    velocity_limits: Array
    name: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Of the objects."""
        return tuple(item.name for item in self.area.objects)


@dataclass(frozen=True, eq=False)
class Understood:
    """A recording, and how its file was understood.

    Attributes:
        recording: ready for use; None where the objects' places are not said yet.
        name: its name.
        facts: what was understood, in pairs of words.
        mapping: that says all of it.
        travel: rad or m, how far the joint that moves most moves.
    """

    recording: Recording | None
    name: str
    facts: tuple[tuple[str, str], ...]
    mapping: Mapping
    travel: float = 0.0

    def noting(self, note: str) -> Understood:
        """The same, with a note."""
        kept = self.recording
        kept = None if kept is None else replace(kept, notes=(*kept.notes, note))
        return replace(self, recording=kept, facts=(*self.facts, ("note", note)))
