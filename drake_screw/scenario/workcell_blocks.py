"""What a scenario file may say of the workcell: arms, table and objects."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from pydantic import Field

from drake_screw.scenario.block import Block, Problem
from drake_screw.scenario.values import (
    METRES,
    RADIANS,
    Angles,
    Interval,
    ModelName,
    Name,
    Positive,
)
from drake_screw.tasks import AXES


class RobotBlock(Block):
    model: ModelName = Field(
        description="shipped model's name, or the path of a model file, relative to the scenario "
        "file"
    )
    joints: tuple[str, ...] = Field(description="names of the arm's joints, from base to hand")
    end_effector: str = Field(description="name of the frame that the demonstrations move")
    start: tuple[float, ...] = Field(
        description="joint angles from which every plan starts, in the order of `joints`",
        json_schema_extra=RADIANS,
    )
    base: str = Field(default="base", description="name of the frame fixed to the world's origin")
    parked: Angles = Field(
        default={},
        description="where other joints rest; joints not named rest at the model's default",
        json_schema_extra=RADIANS,
    )

    def broken_rules(self) -> Iterator[Problem]:
        yield from _joints(self.joints, self.parked, "Give its angle in robot.start.")
        if len(self.start) != len(self.joints):
            yield Problem(
                ("start",),
                f"expected {len(self.joints)} angles, one for each joint, found {len(self.start)}",
                f"Joints: {', '.join(self.joints)}",
            )


class RecordedOnBlock(Block):
    model: ModelName = Field(
        description="shipped model's name, or the path of a model file, relative to the scenario "
        "file"
    )
    joints: tuple[str, ...] = Field(
        description="names of that arm's joints, from base to hand; the recordings have a column "
        "for each"
    )
    end_effector: str = Field(
        description="name of that arm's frame which `robot.end_effector` stands for: same axes, "
        "same grip"
    )
    base: str = Field(
        default="base",
        description="name of the frame in which the recordings have the objects' poses; its z "
        "points up",
    )
    parked: Angles = Field(
        default={},
        description="where other joints rested; joints not named rested at the model's default",
        json_schema_extra=RADIANS,
    )

    def broken_rules(self) -> Iterator[Problem]:
        remedy = "Its angles are in the recordings; leave it out."
        yield from _joints(self.joints, self.parked, remedy)


class TableBlock(Block):
    center: tuple[float, float] = Field(
        description="x, y of the centre of the table's top", json_schema_extra=METRES
    )
    size: tuple[Positive, Positive] = Field(
        description="extent of the table's top along x, y", json_schema_extra=METRES
    )
    top: float = Field(description="height of the table's upper face", json_schema_extra=METRES)
    thickness: Positive = Field(
        default=0.04, description="thickness of the table's top", json_schema_extra=METRES
    )


class ObjectBlock(Block):
    name: Name = Field(description="name of the object: letters, digits, - and _")
    x: Interval = Field(
        description="where the object's frame may lie along x: [lower, upper]",
        json_schema_extra=METRES,
    )
    y: Interval = Field(
        description="where the object's frame may lie along y: [lower, upper]",
        json_schema_extra=METRES,
    )
    yaw: Interval = Field(
        default=Interval(0.0, 0.0),
        description="how the object may be turned about z: [lower, upper]",
        json_schema_extra=RADIANS,
    )
    z: float = Field(description="height of the object's frame", json_schema_extra=METRES)
    radius: Positive = Field(
        description="radius of the object, to draw it and for collisions", json_schema_extra=METRES
    )
    height: Positive = Field(
        description="height of the object, to draw it and for collisions", json_schema_extra=METRES
    )

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


def _joints(joints: tuple[str, ...], parked: Iterable[str], instead: str) -> Iterator[Problem]:
    if not joints:
        yield Problem(("joints",), "expected at least one joint, found none")
    for index, name in repeated(joints):
        yield Problem(("joints", index), f"joint '{name}' is listed twice")
    for name in parked:
        if name in joints:
            yield Problem(
                ("parked", name),
                f"joint '{name}' belongs to the arm, so it cannot be parked",
                instead,
            )
