"""What to say of a recording that has another robot's columns."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from drake_screw.demonstrations.library import JOINTS
from drake_screw.errors import RecordingError


def with_hint(
    error: RecordingError, joints: Sequence[str], own: Sequence[str], *, foreign: bool
) -> RecordingError:
    """The error, with what the scenario should say where the columns are of another arm.

    Args:
        error: that reading ended in.
        joints: of the arm that was read for.
        own: of the arm that is planned for.
        foreign: whether the scenario says that the two differ.
    """
    header = _header(error.file) if error.line == 1 else set()
    if not header or set(joints) <= header:
        return error
    if set(own) <= header:
        hint = "It is of the scenario's own robot: remove the block recorded_on."
    elif foreign or set(joints) & header:
        return error
    else:
        hint = (
            "If another robot made it, describe that one in a block recorded_on, as scenario "
            "pouring_iiwa does."
        )
    return RecordingError(
        error.message, remedy=f"{error.remedy}. {hint}", file=error.file, line=error.line
    )


def _header(file: Path | None) -> set[str]:
    if file is None or file.name != JOINTS or not file.is_file():
        return set()
    with file.open(encoding="utf-8-sig", errors="replace") as lines:
        return {name.strip().strip('"') for name in lines.readline().split(",")}
