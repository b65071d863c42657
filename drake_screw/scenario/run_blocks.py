"""What a scenario file may say of a run: what to show, who demonstrates, how to plan."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag, ValidationError, model_validator
from pydantic.config import JsonDict
from pydantic_core import InitErrorDetails

from drake_screw.plugins import BUILT_IN, is_plugged_in
from drake_screw.scenario.block import Block, Problem
from drake_screw.scenario.values import (
    AXES,
    METRES,
    RADIANS,
    Axis,
    Folder,
    OneOf,
    Option,
    Options,
    PartOf,
    Probability,
)


class AdaptiveBlock(Block):
    smallest: Annotated[float, Field(ge=1e-9, lt=1)] = 1 / 256
    """share of the work area that the smallest cells distinguished take up"""
    level: Probability = 0.5
    """failure probability that a cell of that size may have without being noticed"""


class RegionsBlock(Block):
    grid: dict[str, Annotated[int, Field(ge=1)]] | None = None
    """number of cells per axis: x, y, yaw, z, roll, pitch of the only object, or <object>.x and so
    on; an axis not named has one cell"""
    adaptive: AdaptiveBlock | None = None
    """cells that are halved wherever something fails, instead of a grid; they bring a strategy of
    their own"""

    def broken_rules(self) -> Iterator[Problem]:
        given = [name for name in ("grid", "adaptive") if getattr(self, name) is not None]
        if len(given) != 1:
            yield Problem(
                (),
                f"expected either grid or adaptive, found {' and '.join(given) or 'neither'}",
                "Write `grid: {x: 4, y: 4}` for cells of one size, or `adaptive: {}` for cells "
                "that are halved wherever something fails.",
            )


class CoverageBlock(Block):
    beta: Probability = 0.95
    """probability of success wanted in every region"""
    epsilon: Annotated[float, Field(ge=1e-4, lt=1)] = 0.02
    """accuracy to which failure probabilities are measured; below 1 - beta"""
    delta: Probability = 0.05
    """probability that the measurement may be wrong: 1 - confidence"""
    success: Annotated[Literal["plan", "execution"], OneOf(("plan", "execution"))] = "plan"
    """what counts as a success: a plan, or a plan whose execution in simulation, objects free to
    move, does no more than the block `execution` allows"""
    strategy: Annotated[str, PartOf("strategies")] = "eprocess"
    """the bandit that measures coverage"""
    options: Options = Field(default={})
    """options of the strategy; where plans are executed `rank_budget` of eprocess is 0 if left out:
    no further instances are drawn to tell which of several weak regions is the weakest"""

    @property
    def strategy_options(self) -> dict[str, Option]:
        executed = self.success == "execution" and self.strategy == "eprocess"
        return {"rank_budget": 0, **self.options} if executed else dict(self.options)

    def broken_rules(self) -> Iterator[Problem]:
        slack = 1 - self.beta
        if self.epsilon >= slack - 1e-12:
            yield Problem(
                ("epsilon",),
                f"the run could never stop: epsilon = {self.epsilon:g} is not below "
                f"1 - beta = {slack:g}, so no measurement could show that a region is good enough",
                f"Choose an epsilon below {slack:g}, or a smaller beta.",
            )


class DemonstrationsBlock(Block):
    initial: Annotated[
        Annotated[int, Field(ge=0), Tag("count")] | Annotated[tuple[Folder, ...], Tag("folders")],
        Discriminator(lambda value: "folders" if isinstance(value, tuple) else "count"),
    ] = 1
    """how many demonstrations to ask for before the first round, or a list of recording folders,
    relative to the scenario file"""
    first: Annotated[
        Literal["random", "middle", "farthest"], OneOf(("random", "middle", "farthest"))
    ] = "random"
    """where the first of the initial demonstrations is asked for: at a random place, in the middle
    of the work area, or at its corner farthest from the arm's shoulder; the others are at random
    places"""
    ask: Annotated[str, PartOf("asking_rules")] = "earliest"
    """chooses the failed instance at which the next demonstration is asked for: in the weakest
    region, the one where the best attempt got least far (earliest) or where most fails around it
    (densest), or in any region, where most fails around it (densest_anywhere)"""
    budget: Annotated[int, Field(ge=1)] = 12
    """most demonstrations in total, the initial ones included"""
    objects: tuple[str, ...] = ()
    """names of the objects that the end effector works on; those that it comes near where left
    out"""

    @property
    def initial_count(self) -> int:
        return self.initial if isinstance(self.initial, int) else len(self.initial)

    def broken_rules(self) -> Iterator[Problem]:
        if self.budget < self.initial_count:
            yield Problem(
                ("budget",),
                f"expected at least the {self.initial_count} initial demonstrations, "
                f"found {self.budget}",
            )


def _only_own_keys_if_built_in(schema: JsonDict) -> None:
    """Adds to the JSON Schema of a teacher what `TeacherBlock` checks by itself."""
    keys = schema["properties"]
    assert isinstance(keys, dict)
    schema["if"] = {"properties": {"kind": {"enum": list(BUILT_IN["teachers"])}}}
    schema["then"] = {"propertyNames": {"enum": list(keys)}}


class TeacherBlock(Block):
    model_config = ConfigDict(extra="allow", json_schema_extra=_only_own_keys_if_built_in)
    __pydantic_extra__: dict[str, Option] = Field(init=False)

    kind: Annotated[str, PartOf("teachers")]
    """who gives the demonstrations"""
    motion: Annotated[str, PartOf("motions")] | None = None
    """what a simulated teacher shows; for that kind only"""
    folder: Folder | None = None
    """library of a recorded teacher, or a folder an interactive one watches for recordings;
    relative to the scenario file"""

    format: Annotated[str, PartOf("recording_formats")] = "folder"
    """format of recordings: in `folder` of a recorded teacher, and in `demonstrations.initial`"""
    choose: Annotated[str, OneOf(("nearest", "covers_most"))] = "nearest"
    """which of its unused recordings a recorded teacher gives: the nearest one of the region that
    is asked for, or the one that, by planning, solves most of the instances that fail so far"""

    @property
    def options(self) -> dict[str, Option]:
        """The further keys of a teacher that is not built in; texts as they are written."""
        return dict(self.__pydantic_extra__)

    def broken_rules(self) -> Iterator[Problem]:
        if is_plugged_in("teachers", self.kind):
            return
        needs = {"simulated": "motion", "recorded": "folder"}.get(self.kind)
        lacks = {"simulated": "folder"}.get(self.kind, "motion")
        if needs is not None and getattr(self, needs) is None:
            yield Problem((needs,), f"missing; a {self.kind} teacher needs it")
        if getattr(self, lacks) is not None:
            yield Problem((lacks,), f"a {self.kind} teacher has no {lacks}")

    @model_validator(mode="before")
    @classmethod
    def _only_own_keys_if_built_in(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        kind = data.get("kind")
        if isinstance(kind, str) and is_plugged_in("teachers", kind):
            return data
        errors = [
            InitErrorDetails(type="extra_forbidden", loc=(name,), input=value)
            for name, value in data.items()
            if name not in cls.model_fields
        ]
        if errors and "kind" not in data:
            errors.append(InitErrorDetails(type="missing", loc=("kind",), input=data))
        if errors:
            raise ValidationError.from_exception_data(cls.__name__, errors)
        return data


class PlannerBlock(Block):
    task: Literal["pose", "position_and_axis"] = "pose"
    """what of the end effector follows the screws: its whole pose, or its position and the
    direction of its `free_axis`, for arms of five joints; the roll about that axis is free then"""
    free_axis: Axis | None = None
    """axis of the end effector's frame about which its roll is free with `position_and_axis`, as a
    letter or a vector; z, out of the hand, where left out"""
    tolerance: Annotated[Annotated[float, Field(ge=1e-9, lt=0.1)], RADIANS] = 1e-4
    """error per step of the joint path"""
    turns: Annotated[int, Field(ge=1, le=360)] = 24
    """turns that are tried of an object or tool that may be turned by any angle"""
    approach: Literal["screw", "free"] = "screw"
    """how the arm comes to the first guiding pose: along a screw, as published, or by any joint
    motion; with `collision`, that leads around what is in the way if OMPL is installed
    (`pip install 'drake-screw[ompl]'`)"""
    ik_seeds: Annotated[int, Field(ge=1, le=1024)] = 32
    """configurations from which inverse kinematics of the first guiding pose sets out where the
    approach is free"""
    redundancy: Literal["least_norm", "away_from_limits"] = "least_norm"
    """what more joints than six do with the motion that the end effector leaves free: as little as
    can be, as published, or away from the joint limits"""
    collision: bool = True
    """whether a plan fails along which the robot, or what it holds, touches itself, the table, an
    obstacle or an object; as published they are not looked at"""
    incomplete_shapes: bool = False
    """whether to look at `collision` although the robot lacks collision shapes, those of its model
    whose meshes are missing or cannot be read; the certificate then names these links"""
    clearance: Annotated[Annotated[float, Field(ge=0.0, le=1.0)], METRES] = 0.0
    """distance that all those have to keep, where `collision` is looked at"""
    joint_margin: Annotated[Annotated[float, Field(ge=0.0, lt=3.0)], RADIANS] = 0.0
    """distance that revolute joints have to keep from their limits"""
    slide_margin: Annotated[Annotated[float, Field(ge=0.0, lt=3.0)], METRES] = 0.0
    """distance that prismatic joints have to keep from their limits"""

    @property
    def roll_axis(self) -> tuple[float, float, float] | None:
        """In the end effector's frame, about which its roll is free; None where none is."""
        if self.task == "pose":
            return None
        return AXES["z"] if self.free_axis is None else self.free_axis

    def broken_rules(self) -> Iterator[Problem]:
        if self.free_axis is not None and self.task == "pose":
            yield Problem(
                ("free_axis",),
                "no roll is free where the whole pose is followed (task: pose)",
                "Write task: position_and_axis, or leave free_axis out.",
            )
        if self.clearance > 0.0 and not self.collision:
            yield Problem(
                ("clearance",),
                "a distance to keep, but collisions are not looked at",
                "Write collision: true, or leave the clearance out.",
            )
