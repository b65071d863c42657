"""What a scenario file may say of the workcell around the robot: table and objects."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Annotated, Literal

from pydantic import Field

from drake_screw.scenario.block import Block, Problem
from drake_screw.scenario.values import (
    METRES,
    RADIANS,
    Interval,
    Name,
    Positive,
)
from drake_screw.tasks import AXES, Symmetry


class TableBlock(Block):
    center: Annotated[tuple[float, float], METRES]
    """x, y of the centre of the table's top"""
    size: Annotated[tuple[Positive, Positive], METRES]
    """extent of the table's top along x, y"""
    top: Annotated[float, METRES]
    """height of the table's upper face"""
    thickness: Annotated[Positive, METRES] = 0.04
    """thickness of the table's top"""


class SymmetryBlock(Block):
    axis: Literal["x", "y", "z"] = "z"
    """axis of the frame, through its origin, about which turns leave the body as it is"""
    turns: Literal["any"] | Annotated[int, Field(ge=2)]
    """any for a body of revolution; else how many turns in a full one look the same: 4 for a
    square box"""

    @property
    def symmetry(self) -> Symmetry:
        axis = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}[self.axis]
        return Symmetry(axis, None if self.turns == "any" else self.turns)


class ObjectBlock(Block):
    name: Name
    """name of the object: letters, digits, - and _"""
    x: Annotated[Interval, METRES]
    """where the object's frame may lie along x: [lower, upper]"""
    y: Annotated[Interval, METRES]
    """where the object's frame may lie along y: [lower, upper]"""
    yaw: Annotated[Interval, RADIANS] = Interval(0.0, 0.0)
    """how the object may be turned about z: [lower, upper]"""
    z: Annotated[float, METRES]
    """height of the object's frame"""
    radius: Annotated[Positive, METRES]
    """radius of the object, to draw it and for collisions"""
    height: Annotated[Positive, METRES]
    """height of the object, to draw it and for collisions"""
    symmetry: SymmetryBlock | None = None
    """how it may be turned about an axis and be the same to the task; left out if it may not"""

    def broken_rules(self) -> Iterator[Problem]:
        for axis in AXES:
            interval = getattr(self, axis)
            if not math.isfinite(interval.upper - interval.lower):
                yield Problem((axis,), "the range is too wide")
        if self.yaw.upper - self.yaw.lower > 2 * math.pi + 1e-9:
            yield Problem(
                ("yaw",),
                "the range is wider than a full turn",
                "Angles are in rad; a full turn is [-3.141592653589793, 3.141592653589793].",
            )


def repeated(names: Iterable[str]) -> Iterator[tuple[int, str]]:
    """Places and names of those that are there before."""
    seen = set()
    for index, name in enumerate(names):
        if name in seen:
            yield index, name
        seen.add(name)
