"""What would be kept of the recordings that a scenario names, recording by recording."""

from __future__ import annotations

from collections.abc import Sequence

from drake_screw.acquisition import RecordedTeacher
from drake_screw.assembly.setup import Setup
from drake_screw.assembly.ways import why_failed
from drake_screw.demonstrations import Look, Recording
from drake_screw.errors import counted


def named_recordings(setup: Setup) -> tuple[Recording, ...]:
    """The recordings of a recorded teacher, and those to start from."""
    initial = () if isinstance(setup.initial, int) else setup.initial
    return (*initial, *(teacher_recordings(setup) or ()))


def teacher_recordings(setup: Setup) -> tuple[Recording, ...] | None:
    """The recordings that the teacher chooses from; None if it is not a recorded one."""
    if setup.scenario.teacher.kind == "interactive":
        return None
    teacher = setup.teacher
    return tuple(teacher.recordings) if isinstance(teacher, RecordedTeacher) else None


def kept(setup: Setup, recordings: Sequence[Recording]) -> tuple[str, ...]:
    """A line for each recording: how faithfully it is kept, or why it is not used.

    For example ``demo_07: 7 guiding poses of the bowl; kept to 6 mm and 0.08 rad; turn 1.36 of 1.38
    rad``. Where the arm cannot do from its start what was shown, objects standing as they did, the
    line ends with the first segment that it cannot follow.
    """
    looks = map(setup.look, recordings)
    return tuple(f"{look}{_cannot_follow(setup, look)}" for look in looks)


def _cannot_follow(setup: Setup, look: Look) -> str:
    """What the arm cannot follow of a recording where it was shown, as the end of a sentence."""
    demonstration = look.demonstration
    if demonstration is None:
        return ""
    outcomes = setup.planner.all_outcomes([demonstration], look.X_WO[None], setup.start)
    if outcomes.success[0, 0]:
        return ""
    why = why_failed(setup.arms, outcomes[0], [demonstration], look.X_WO)
    why = why.replace(f"with {demonstration.name}, ", "")
    segments = counted(len(demonstration.objects), "segment")
    return f"; not planned where it was shown, of {segments}: {why}"
