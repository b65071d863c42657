"""What a scenario file may say of the workcell around the robot: table and objects."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Annotated, Literal

from pydantic import Field

from drake_screw.scenario.block import Block
from drake_screw.scenario.values import (
    METRES,
    Positive,
)
from drake_screw.tasks import Symmetry


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


def repeated(names: Iterable[str]) -> Iterator[tuple[int, str]]:
    """Places and names of those that are there before."""
    seen = set()
    for index, name in enumerate(names):
        if name in seen:
            yield index, name
        seen.add(name)
