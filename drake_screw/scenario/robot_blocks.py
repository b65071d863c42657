"""What a scenario file may say of robots: their arms, and what these hold."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Annotated, Any, cast

from pydantic import ConfigDict, Field, model_validator
from pydantic.config import JsonDict

from drake_screw.errors import suggestion
from drake_screw.scenario.block import Block, Problem
from drake_screw.scenario.shape_blocks import ShapeBlock
from drake_screw.scenario.values import (
    METRES,
    RADIANS,
    Address,
    Angles,
    Limits,
    ModelName,
    Name,
    NamedState,
    Options,
    Packages,
    Pairs,
)
from drake_screw.scenario.workcell_blocks import SymmetryBlock, repeated

ONLY_ARM = "arm"
"""The name of a robot's arm where it has just one."""

_OF_ONE_ARM = ("joints", "end_effector", "end_effector_rotation", "start", "tool")
_NEEDED = ("joints", "end_effector", "start")


class ArmBlock(Block):
    name: Name
    """name of the arm: letters, digits, - and _"""
    joints: tuple[str, ...]
    """names of its joints, from base to end effector"""
    end_effector: str
    """name of its frame that the demonstrations move: same axes and same grip in all arms"""
    end_effector_rotation: Annotated[tuple[float, float, float], RADIANS] | None = None
    """roll, pitch and yaw by which that frame is turned first; not turned if left out"""
    start: Annotated[tuple[float, ...] | NamedState, RADIANS]
    """joint angles from which its plans start, and where it rests while another arm moves, in the
    order of `joints`; or the name of a state in the SRDF file"""
    tool: ToolBlock | None = None
    """what its end effector holds"""

    def broken_rules(self) -> Iterator[Problem]:
        yield from _joints(self.joints, (), "")
        yield from _start(self.start, self.joints)


def _one_arm_or_several(schema: JsonDict) -> None:
    """Says in the JSON Schema of a robot what `RobotBlock` checks by itself."""
    schema["required"] = ["model"]
    keys = schema["properties"]
    assert isinstance(keys, dict)
    for name in _NEEDED:
        keys[name] = {**cast(JsonDict, keys[name]), "default": None}
    schema["if"] = {"required": ["arms"]}
    schema["then"] = {"not": {"anyOf": [{"required": [key]} for key in _OF_ONE_ARM]}}
    schema["else"] = {"required": list(_NEEDED)}


class RobotBlock(Block):
    model_config = ConfigDict(json_schema_extra=_one_arm_or_several)

    model: ModelName
    """shipped model's name, or the path of a model file, relative to the scenario file, or its
    address in a package, `package://NAME/...`"""
    joints: tuple[str, ...] | None
    """names of the arm's joints, from base to end effector; needed without `arms`"""
    end_effector: str | None
    """name of the frame that the demonstrations move; needed without `arms`"""
    end_effector_rotation: Annotated[tuple[float, float, float], RADIANS] | None = None
    """roll, pitch and yaw by which that frame is turned, about its own origin, before it is used,
    for a model that has none whose z axis points out of the hand; not turned if left out"""
    start: Annotated[tuple[float, ...] | NamedState | None, RADIANS]
    """joint angles from which every plan starts, in the order of `joints`; or the name of a state
    in the SRDF file, `ready`, or `GROUP/ready` where several groups have one of that name; needed
    without `arms`"""
    arms: tuple[ArmBlock, ...] | None = None
    """several arms, in the place of the keys of a single one (`joints`, `end_effector`,
    `end_effector_rotation`, `start`, `tool`): a plan is of one of them, the first listed that can,
    while the others rest where they start"""
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
    looked at. One of a pair may be `table`, an obstacle or an object, one that is grasped say"""
    packages: Packages = Field(default={})
    """folders of packages that the model speaks of as `package://NAME/...` and that are not found
    by themselves"""
    xacro: Options = Field(default={})
    """arguments of a model that is written in xacro"""
    srdf: Address | None = None
    """path of the SRDF file that says which links may touch one another, and what states there are,
    relative to the scenario file, or its address in a package"""

    @model_validator(mode="before")
    @classmethod
    def _several_arms_have_their_own(cls, data: Any) -> Any:
        if isinstance(data, dict) and data.get("arms") is not None:
            return dict.fromkeys(_NEEDED) | data
        return data

    @property
    def each_arm(self) -> tuple[ArmBlock, ...]:
        """The arms that are planned for, in the order in which they are tried."""
        if self.arms is not None:
            return self.arms
        own = {key: getattr(self, key) for key in _OF_ONE_ARM}
        return (ArmBlock(name=ONLY_ARM, **own),)

    def place(self, arm: int) -> str:
        """Where the keys of an arm are: `robot`, or `robot.arms.1` of several."""
        return "robot" if self.arms is None else f"robot.arms.{arm}"

    def broken_rules(self) -> Iterator[Problem]:
        if self.arms is None:
            yield from self._single_arm()
        else:
            yield from self._several_arms(self.arms)
        for index, (one, other) in enumerate(self.ignore_collisions):
            if one == other:
                yield Problem(
                    ("ignore_collisions", index),
                    f"'{one}' is there twice",
                    "Name the two links that may touch; a link never collides with itself.",
                )
        arms = (self,) if self.arms is None else self.arms
        known = [name for arm in arms for name in arm.joints or ()]
        for name in self.velocity_limits:
            if name not in known:
                what = "the arm" if self.arms is None else "an arm"
                yield Problem(
                    ("velocity_limits", name),
                    f"'{name}' is no joint of {what}",
                    suggestion(name, known, "Joints"),
                )
        for keys, start in self._starts():
            if isinstance(start, str) and self.srdf is None:
                yield Problem(
                    keys,
                    f"'{start}' would be a state of an SRDF file, and none is given",
                    "Give the file in robot.srdf, or an angle for each joint, [0.1, ...].",
                )

    def _single_arm(self) -> Iterator[Problem]:
        for key in _NEEDED:
            if getattr(self, key) is None:
                yield Problem((key,), "missing; an arm needs it", "Or list several in robot.arms.")
        if self.joints is not None:
            yield from _joints(self.joints, self.parked, "Give its angle in robot.start.")
            yield from _start("" if self.start is None else self.start, self.joints)

    def _several_arms(self, arms: tuple[ArmBlock, ...]) -> Iterator[Problem]:
        if not arms:
            yield Problem(("arms",), "expected at least one arm, found none")
        for key in _OF_ONE_ARM:
            if getattr(self, key) is not None:
                yield Problem(
                    (key,),
                    "is of a single arm, and robot.arms lists them",
                    f"Write it in each of robot.arms, or leave robot.arms out; keys of a single "
                    f"arm: {', '.join(_OF_ONE_ARM)}.",
                )
        for index, name in repeated(arm.name for arm in arms):
            yield Problem(
                ("arms", index, "name"),
                f"there is another arm named '{name}'",
                "Give every arm a name of its own.",
            )
        owners: dict[str, str] = {}
        for i, arm in enumerate(arms):
            for j, name in enumerate(arm.joints):
                if owners.setdefault(name, arm.name) != arm.name:
                    yield Problem(
                        ("arms", i, "joints", j),
                        f"joint '{name}' belongs to arm '{owners[name]}', too",
                        "Arms move one at a time, and share no joint; what carries both may be "
                        "parked.",
                    )
        for name in self.parked:
            if name in owners:
                yield Problem(
                    ("parked", name),
                    f"joint '{name}' belongs to arm '{owners[name]}', so it cannot be parked",
                    "Give its angle in the start of that arm, where it rests, too.",
                )

    def _starts(self) -> Iterator[tuple[tuple[str | int, ...], object]]:
        if self.arms is None:
            yield ("start",), self.start
        for i, arm in enumerate(self.arms or ()):
            yield ("arms", i, "start"), arm.start


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


def _start(start: tuple[float, ...] | str, joints: tuple[str, ...]) -> Iterator[Problem]:
    if not isinstance(start, str) and len(start) != len(joints):
        yield Problem(
            ("start",),
            f"expected {len(joints)} angles, one for each joint, found {len(start)}",
            f"Joints: {', '.join(joints)}",
        )
