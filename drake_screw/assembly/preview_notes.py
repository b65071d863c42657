"""What a preview remarks on: what may surprise, or goes wrong in the end."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from drake_screw.planning import connection

if TYPE_CHECKING:
    from drake_screw.assembly.preview import Preview


def notes(preview: Preview) -> Iterator[tuple[str, str]]:
    """A preview's lines of that kind, each with its heading."""
    if preview.farthest_corner > preview.robot.reach:
        yield (
            "note",
            f"the farthest corner of the work area is {preview.farthest_corner:.2f} m from the "
            "shoulder; only an object held long reaches there",
        )
    if preview.looks_aside is not None:
        yield "note", preview.looks_aside
    yield from (("note", str(item)) for item in preview.covered)
    if preview.touching_at_start:
        both = " and ".join(f"'{a}' touches '{b}'" for a, b in preview.touching_at_start)
        yield (
            "note",
            f"{both} at the start; collisions are left out here, but execute and export look "
            "at them, and will find no plan",
        )
    yield from (("note", line) for line in (*preview.assumed, *preview.hints))
    if preview.unseen:
        yield "note", "collision checks are incomplete; these shapes of the robot are missing:"
        yield from (("", f"  {line}") for line in preview.unseen)
    if preview.not_shown is not None:
        yield "note", preview.not_shown
    if preview.unknown_links:
        yield "note", f"links that the robot's model lacks: {', '.join(preview.unknown_links)}"
    if preview.lacks_ompl:
        yield "note", connection.ABSENT
