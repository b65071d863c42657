"""What a scenario file may say of the objects of its task, and where they may stand."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Literal

from pydantic import Field

from drake_screw.errors import suggestion
from drake_screw.scenario.block import Block, Problem
from drake_screw.scenario.values import METRES, RADIANS, Interval, Name, OneOf, Positive
from drake_screw.scenario.workcell_blocks import SymmetryBlock
from drake_screw.tasks import AXES

ANGLES = ("yaw", "roll", "pitch")


class ObjectBlock(Block):
    name: Name
    """name of the object: letters, digits, - and _"""
    x: Annotated[Interval, METRES]
    """where the object's frame may lie along x: [lower, upper]"""
    y: Annotated[Interval, METRES]
    """where the object's frame may lie along y: [lower, upper]"""
    yaw: Annotated[Interval, RADIANS] = Interval(0.0, 0.0)
    """how the object may be turned about z: [lower, upper]"""
    z: Annotated[Interval, METRES]
    """height of the object's frame: [lower, upper]"""
    roll: Annotated[Interval, RADIANS] = Interval(0.0, 0.0)
    """how the object may be turned about its x, before it is pitched: [lower, upper]"""
    pitch: Annotated[Interval, RADIANS] = Interval(0.0, 0.0)
    """how the object may be turned about y, before it is yawed: [lower, upper]"""
    orientation: Annotated[Literal["any"], OneOf(("any",))] | None = None
    """any: it may be turned in any way, uniformly on SO(3), in place of roll, pitch and yaw"""
    on: str | None = None
    """name of another object that it stands on: its x, y, z and angles are seen from that one's
    frame; from the world if left out"""
    radius: Annotated[Positive, METRES]
    """radius of the object, to draw it and for collisions"""
    height: Annotated[Positive, METRES]
    """height of the object, to draw it and for collisions"""
    mass: Annotated[Positive, Field(json_schema_extra={"unit": "kg"})] = 0.3
    """mass of the object, a solid cylinder, where it is free to move in an execution"""
    friction: Annotated[float, Field(ge=0.0)] = 0.6
    """its coefficient of friction there; with table and robot, which have 0.6, that is 0.6, too"""
    symmetry: SymmetryBlock | None = None
    """how it may be turned about an axis and be the same to the task; left out if it may not"""

    def fixes(self, axis: str) -> bool:
        """Whether x, y, yaw, z, roll or pitch is a single value."""
        if self.orientation is not None and axis in ANGLES:
            return False
        fixed: bool = getattr(self, axis).fixed
        return fixed

    def broken_rules(self) -> Iterator[Problem]:
        for axis in AXES:
            interval = getattr(self, axis)
            if self.orientation is not None and axis in ANGLES and interval != Interval(0.0, 0.0):
                yield Problem(
                    (axis,),
                    f"with `orientation: any` there is no {axis} to choose",
                    f"Leave {axis} out, or the orientation.",
                )
        for axis in ("yaw", "roll"):
            interval = getattr(self, axis)
            if interval.upper - interval.lower > 2 * math.pi + 1e-9:
                yield Problem(
                    (axis,),
                    "the range is wider than a full turn",
                    "Angles are in rad; a full turn is [-3.141592653589793, 3.141592653589793].",
                )
        if max(-self.pitch.lower, self.pitch.upper) > math.pi / 2 + 1e-9:
            yield Problem(
                ("pitch",),
                "a pitch is between -pi/2 and pi/2",
                "Angles are in rad; what is pitched further has its roll and yaw turned by half a "
                "turn.",
            )


def standing_problems(objects: Sequence[ObjectBlock]) -> Iterator[Problem]:
    """What is wrong with what objects stand on: it must be another one, and end in the world."""
    on = {o.name: o.on for o in objects}
    for index, item in enumerate(objects):
        keys = ("objects", index, "on")
        if item.on is None:
            continue
        if item.on not in on:
            others = [name for name in on if name != item.name]
            yield Problem(
                keys, f"there is no object '{item.on}'", suggestion(item.on, others, "Objects")
            )
            continue
        below: str | None = item.on
        chain = [item.name]
        while below is not None and below not in chain:
            chain.append(below)
            below = on.get(below)
        if below == item.name:
            yield Problem(
                keys,
                "objects stand on one another in a circle: " + " on ".join([*chain, below]),
                "One of them must stand in the world: leave its `on` out.",
            )
