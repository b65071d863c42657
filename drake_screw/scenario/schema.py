"""What a scenario file may say: one frozen dataclass for each of its blocks.

The fields are the file's keys. Each carries its meaning, unit and limits in its metadata (see
`key`); the loader, the checks and the reference page are driven by them.
"""

# ruff: noqa: RUF009 (`key` makes a dataclass field)

from __future__ import annotations

import math
from dataclasses import MISSING, dataclass, field
from pathlib import Path
from typing import Any, NewType

STRATEGIES = (
    "eprocess",
    "naive_pac",
    "clopper_pearson",
    "successive_elimination",
    "lucb",
    "ucb",
    "median_elimination",
)
TEACHERS = ("simulated", "recorded", "interactive")
MOTIONS = ("pouring", "scooping")
AXES = ("x", "y", "yaw")
NAME_PATTERN = "[A-Za-z0-9_-]+"

ModelName = NewType("ModelName", str)
"""The name of a shipped model, or the path of one."""


def key(
    meaning: str,
    *,
    unit: str = "",
    default: Any = MISSING,
    default_factory: Any = MISSING,
    choices: tuple[str, ...] = (),
    pattern: str = "",
    above: float = -math.inf,
    at_least: float = -math.inf,
    below: float = math.inf,
) -> Any:
    """A key of the scenario file.

    The key is required unless it has a default. Limits hold for every number in a list or a
    mapping; `choices` and `pattern` (a regular expression for the whole text) for every text.
    """
    rules = {"choices": choices, "pattern": pattern}
    limits = {"above": above, "at_least": at_least, "below": below}
    metadata = {"meaning": meaning, "unit": unit, **rules, **limits}
    if default_factory is not MISSING:
        return field(default_factory=default_factory, metadata=metadata)
    return field(default=default, metadata=metadata)


@dataclass(frozen=True)
class Interval:
    """A range of numbers, written ``[lower, upper]``, or one number where both are the same."""

    lower: float
    upper: float

    @property
    def fixed(self) -> bool:
        return self.lower == self.upper


@dataclass(frozen=True, kw_only=True)
class RobotBlock:
    model: ModelName = key(
        "shipped model's name, or the path of a model file, relative to the scenario file"
    )
    joints: tuple[str, ...] = key("names of the arm's joints, from base to hand")
    end_effector: str = key("name of the frame that the demonstrations move")
    start: tuple[float, ...] = key(
        "joint angles from which every plan starts, in the order of `joints`", unit="rad"
    )
    base: str = key("name of the frame fixed to the world's origin", default="base")
    parked: dict[str, float] = key(
        "where other joints rest; joints not named rest at the model's default",
        unit="rad",
        default_factory=dict,
    )


@dataclass(frozen=True, kw_only=True)
class TableBlock:
    center: tuple[float, float] = key("x, y of the centre of the table's top", unit="m")
    size: tuple[float, float] = key("extent of the table's top along x, y", unit="m", above=0)
    top: float = key("height of the table's upper face", unit="m")
    thickness: float = key("thickness of the table's top", unit="m", default=0.04, above=0)


@dataclass(frozen=True, kw_only=True)
class ObjectBlock:
    name: str = key("name of the object: letters, digits, - and _", pattern=NAME_PATTERN)
    x: Interval = key("where the object's frame may lie along x: [lower, upper]", unit="m")
    y: Interval = key("where the object's frame may lie along y: [lower, upper]", unit="m")
    yaw: Interval = key(
        "how the object may be turned about z: [lower, upper]",
        unit="rad",
        default=Interval(0.0, 0.0),
    )
    z: float = key("height of the object's frame", unit="m")
    radius: float = key("radius of the object, to draw it and for collisions", unit="m", above=0)
    height: float = key("height of the object, to draw it and for collisions", unit="m", above=0)


@dataclass(frozen=True, kw_only=True)
class AdaptiveBlock:
    smallest: float = key(
        "share of the work area that the smallest cells told apart take up",
        default=1 / 256,
        at_least=1e-9,
        below=1,
    )
    level: float = key(
        "failure probability that a cell of that size may have without being noticed",
        default=0.5,
        above=0,
        below=1,
    )


@dataclass(frozen=True, kw_only=True)
class RegionsBlock:
    grid: dict[str, int] | None = key(
        "number of cells per axis: x, y, yaw of the only object, or <object>.x and so on; "
        "an axis not named has one cell",
        default=None,
        at_least=1,
    )
    adaptive: AdaptiveBlock | None = key(
        "cells that are halved wherever something fails, instead of a grid; they bring a strategy "
        "of their own",
        default=None,
    )


@dataclass(frozen=True, kw_only=True)
class CoverageBlock:
    beta: float = key(
        "probability of success wanted in every region", default=0.95, above=0, below=1
    )
    epsilon: float = key(
        "accuracy to which failure probabilities are measured; below 1 - beta",
        default=0.02,
        at_least=1e-4,
        below=1,
    )
    delta: float = key(
        "probability that the measurement may be wrong: 1 - confidence",
        default=0.05,
        above=0,
        below=1,
    )
    strategy: str = key("the bandit that measures coverage", default="eprocess", choices=STRATEGIES)
    options: dict[str, bool | int | float | str] = key(
        "options of the strategy", default_factory=dict
    )


@dataclass(frozen=True, kw_only=True)
class DemonstrationsBlock:
    initial: int | tuple[Path, ...] = key(
        "how many demonstrations to draw at random places before the first round, or a list of "
        "recording folders, relative to the scenario file",
        default=1,
        at_least=0,
    )
    budget: int = key(
        "most demonstrations in total, the initial ones included", default=12, at_least=1
    )

    @property
    def initial_count(self) -> int:
        return self.initial if isinstance(self.initial, int) else len(self.initial)


@dataclass(frozen=True, kw_only=True)
class TeacherBlock:
    kind: str = key("who gives the demonstrations", choices=TEACHERS)
    motion: str | None = key(
        "what a simulated teacher shows; for that kind only", default=None, choices=MOTIONS
    )
    folder: Path | None = key(
        "library of a recorded teacher, or a folder an interactive one watches for recordings; "
        "relative to the scenario file",
        default=None,
    )


@dataclass(frozen=True, kw_only=True)
class RecordedOnBlock:
    model: ModelName = key(
        "shipped model's name, or the path of a model file, relative to the scenario file"
    )
    joints: tuple[str, ...] = key(
        "names of that arm's joints, from base to hand; the recordings have a column for each"
    )
    end_effector: str = key(
        "name of that arm's frame which `robot.end_effector` stands for: same axes, same grip"
    )
    base: str = key(
        "name of the frame in which the recordings have the objects' poses; its z points up",
        default="base",
    )
    parked: dict[str, float] = key(
        "where other joints rested; joints not named rested at the model's default",
        unit="rad",
        default_factory=dict,
    )


@dataclass(frozen=True, kw_only=True)
class SegmentationBlock:
    spacing: float = key(
        "smallest distance between poses kept of a recording", unit="m", default=0.005, above=0
    )
    position_tolerance: float = key(
        "largest distance of the recorded hand from a constant screw",
        unit="m",
        default=0.015,
        above=0,
    )
    rotation_tolerance: float = key(
        "largest chordal quaternion distance of the recorded hand from a constant screw",
        default=0.15,
        above=0,
    )
    min_progress: float = key(
        "smallest advance of the screw parameter between successive poses", default=0.001, above=0
    )
    region_of_interest: float = key(
        "guiding poses lie within this many times the smallest distance of hand and object",
        default=1.5,
        at_least=1,
    )


@dataclass(frozen=True, kw_only=True)
class PlannerBlock:
    tolerance: float = key(
        "error per step of the joint path", unit="rad", default=1e-4, at_least=1e-9, below=0.1
    )
    collision: bool = key(
        "whether a plan that touches the robot itself, the table or an object fails",
        default=False,
    )


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """A whole run: a scenario file with its defaults filled in and its paths made absolute.

    `source` is the file it was read from; it does not take part in comparison.
    """

    name: str = key("name of the scenario: letters, digits, - and _", pattern=NAME_PATTERN)
    description: str = key("what the scenario is, in one line", default="")
    robot: RobotBlock = key("the arm")
    table: TableBlock | None = key("the table, a box; leave it out for none", default=None)
    objects: tuple[ObjectBlock, ...] = key("the objects of the task, and where they may lie")
    regions: RegionsBlock = key("how the work area is divided")
    coverage: CoverageBlock = key("what the run must show", default=CoverageBlock())
    demonstrations: DemonstrationsBlock = key(
        "how many demonstrations there may be", default=DemonstrationsBlock()
    )
    teacher: TeacherBlock = key("where demonstrations come from")
    recorded_on: RecordedOnBlock | None = key(
        "the arm that a recorded teacher's recordings, and those listed in "
        "`demonstrations.initial`, were made on, where it is not `robot`",
        default=None,
    )
    segmentation: SegmentationBlock = key(
        "how recordings are cut into constant screws", default=SegmentationBlock()
    )
    planner: PlannerBlock = key("how plans are computed", default=PlannerBlock())
    seed: int = key("seed of all random draws", default=0, at_least=0)
    meshcat: bool = key("whether a run shows itself in the browser as it goes on", default=False)
    source: Path | None = field(default=None, compare=False)

    @property
    def cells(self) -> tuple[tuple[int, int, int], ...]:
        """Number of cells along x, y, yaw of each object; to begin with, where adaptive."""
        grid = self.regions.grid or {}
        short = grid if len(self.objects) == 1 else {}

        def count(name: str, axis: str) -> int:
            return grid.get(f"{name}.{axis}", short.get(axis, 1))

        return tuple(
            (count(o.name, "x"), count(o.name, "y"), count(o.name, "yaw")) for o in self.objects
        )
