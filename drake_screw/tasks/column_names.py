"""What a table calls the coordinates of task instances; all tables that are read or written do."""

from __future__ import annotations

from drake_screw.tasks.work_area import WorkArea


def column_name(area: WorkArea, i: int, axis: str) -> str:
    """The column of an axis of object i: ``x``, and ``bowl.x`` where there are several objects."""
    return axis if len(area.objects) == 1 else f"{area.objects[i].name}.{axis}"


def other_names(area: WorkArea, i: int, axis: str) -> tuple[str, ...]:
    """What else it may be called in a table that is read: by the object, even by the only one.

    The last is what tables of executions and regions used to call it.
    """
    name = area.objects[i].name
    return tuple(n for n in (f"{name}.{axis}", f"{name}_{axis}") if n != column_name(area, i, axis))


def column_names(area: WorkArea) -> tuple[str, ...]:
    """Those of `WorkArea.columns`, in their order."""
    return tuple(column_name(area, i, area.axes[j]) for i, j in area.columns)
