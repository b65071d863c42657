"""What a scenario file may say of the workcell: arms, what they hold, table and objects."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Annotated, Literal

from pydantic import Field

from drake_screw.errors import suggestion
from drake_screw.scenario.block import Block, Problem
from drake_screw.scenario.shape_blocks import ShapeBlock
from drake_screw.scenario.values import (
    METRES,
    RADIANS,
    Address,
    Angles,
    Interval,
    Limits,
    ModelName,
    Name,
    NamedState,
    Options,
    Packages,
    Pairs,
    Positive,
)
from drake_screw.tasks import AXES, Symmetry


class RobotBlock(Block):
    model: ModelName
    """shipped model's name, or the path of a model file, relative to the scenario file, or its
    address in a package, `package://NAME/...`"""
    joints: tuple[str, ...]
    """names of the arm's joints, from base to end effector"""
    end_effector: str
    """name of the frame that the demonstrations move"""
    end_effector_rotation: Annotated[tuple[float, float, float], RADIANS] | None = None
    """roll, pitch and yaw by which that frame is turned, about its own origin, before it is used,
    for a model that has none whose z axis points out of the hand; not turned if left out"""
    start: Annotated[tuple[float, ...] | NamedState, RADIANS]
    """joint angles from which every plan starts, in the order of `joints`; or the name of a state
    in the SRDF file, `ready`, or `GROUP/ready` where several groups have one of that name"""
    base: str = "base"
    """name of the link or frame at the world's origin, z up, whatever holds the robot; what is
    between it and the model's root is held. `world` leaves the model where it puts itself"""
    parked: Annotated[Angles, RADIANS] = Field(default={})
    """where other joints rest; joints not named rest at the model's default"""
    tool: ToolBlock | None = None
    """what the end effector holds"""
    velocity_limits: Annotated[Limits, Field(json_schema_extra={"unit": "rad/s"})] = Field(
        default={}
    )
    """greatest velocities of joints of the arm (of prismatic ones in m/s), in place of the model's;
    a joint that has none there either moves at 1 rad/s or 0.25 m/s. They matter to the simulated
    teacher, to exports and to executions"""
    ignore_collisions: Pairs = ()
    """pairs of links that may touch, [[left_finger, right_finger], ...]: whether they do is not
    looked at. One of a pair may be `table` or an obstacle"""
    packages: Packages = Field(default={})
    """folders of packages that the model speaks of as `package://NAME/...` and that are not found
    by themselves"""
    xacro: Options = Field(default={})
    """arguments of a model that is written in xacro"""
    srdf: Address | None = None
    """path of the SRDF file that says which links may touch one another, and what states there are,
    relative to the scenario file, or its address in a package"""

    def broken_rules(self) -> Iterator[Problem]:
        yield from _joints(self.joints, self.parked, "Give its angle in robot.start.")
        for index, (one, other) in enumerate(self.ignore_collisions):
            if one == other:
                yield Problem(
                    ("ignore_collisions", index),
                    f"'{one}' is there twice",
                    "Name the two links that may touch; a link never collides with itself.",
                )
        for name in self.velocity_limits:
            if name not in self.joints:
                yield Problem(
                    ("velocity_limits", name),
                    f"'{name}' is no joint of the arm",
                    suggestion(name, self.joints, "Joints"),
                )
        if isinstance(self.start, str):
            if self.srdf is None:
                yield Problem(
                    ("start",),
                    f"'{self.start}' would be a state of an SRDF file, and none is given",
                    "Give the file in robot.srdf, or an angle for each joint, [0.1, ...].",
                )
        elif len(self.start) != len(self.joints):
            yield Problem(
                ("start",),
                f"expected {len(self.joints)} angles, one for each joint, found {len(self.start)}",
                f"Joints: {', '.join(self.joints)}",
            )


class RecordedOnBlock(Block):
    model: ModelName
    """shipped model's name, or the path of a model file, relative to the scenario file, or its
    address in a package, `package://NAME/...`"""
    joints: tuple[str, ...]
    """names of that arm's joints, from base to end effector; the recordings have a column for
    each"""
    end_effector: str
    """name of that arm's frame which `robot.end_effector` stands for: same axes, same grip"""
    end_effector_rotation: Annotated[tuple[float, float, float], RADIANS] | None = None
    """roll, pitch and yaw by which that frame is turned first; not turned if left out"""
    base: str = "base"
    """name of the frame in which the recordings have the objects' poses; its z points up"""
    parked: Annotated[Angles, RADIANS] = Field(default={})
    """where other joints rested; joints not named rested at the model's default"""
    packages: Packages = Field(default={})
    """folders of packages that the model speaks of"""
    xacro: Options = Field(default={})
    """arguments of a model that is written in xacro"""

    def broken_rules(self) -> Iterator[Problem]:
        remedy = "Its angles are in the recordings; leave it out."
        yield from _joints(self.joints, self.parked, remedy)


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


class ToolBlock(Block):
    frame: str | None = None
    """name of the tool's frame, fixed to the end effector; the end effector's own if left out"""
    xyz: Annotated[tuple[float, float, float], METRES] = (0.0, 0.0, 0.0)
    """where the tool is in that frame"""
    rpy: Annotated[tuple[float, float, float], RADIANS] = (0.0, 0.0, 0.0)
    """how it is turned there: roll, pitch and yaw"""
    symmetry: SymmetryBlock | None = None
    """how it may be turned about an axis and do the same; left out if it may not"""
    shape: ShapeBlock | None = None
    """its shape, placed in the tool's frame, for collisions and to draw it; a part of the robot
    that moves with the end effector"""
    touches: tuple[str, ...] = ()
    """names of links, of the table, obstacles and objects that the shape may touch, such as the
    fingers around it; it always may touch the links that are rigidly fixed to it"""

    def broken_rules(self) -> Iterator[Problem]:
        for index, name in repeated(self.touches):
            yield Problem(("touches", index), f"'{name}' is listed twice")
        if self.touches and self.shape is None:
            yield Problem(
                ("touches",), "a tool without a shape touches nothing", "Give it a shape."
            )


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
    mass: Annotated[Positive, Field(json_schema_extra={"unit": "kg"})] = 0.3
    """mass of the object, a solid cylinder, where it is free to move in an execution"""
    friction: Annotated[float, Field(ge=0.0)] = 0.6
    """its coefficient of friction there; with table and robot, which have 0.6, that is 0.6, too"""
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
