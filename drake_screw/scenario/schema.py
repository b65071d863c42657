"""A whole scenario: its blocks, and the rules among them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

from pydantic import Field, PrivateAttr

from drake_screw.errors import suggestion
from drake_screw.scenario.block import Block, Problem
from drake_screw.scenario.execution_block import ExecutionBlock
from drake_screw.scenario.object_blocks import ObjectBlock, standing_problems
from drake_screw.scenario.robot_blocks import RecordedOnBlock, RobotBlock
from drake_screw.scenario.run_blocks import (
    CoverageBlock,
    DemonstrationsBlock,
    PlannerBlock,
    RegionsBlock,
    TeacherBlock,
)
from drake_screw.scenario.segmentation_block import SegmentationBlock
from drake_screw.scenario.shape_blocks import ObstacleBlock
from drake_screw.scenario.values import Name
from drake_screw.scenario.workcell_blocks import TableBlock, repeated
from drake_screw.tasks import AXES

MOST_REGIONS = 4096
"""Of a grid. Every region takes some samples in every round, and its place in every picture."""


class Scenario(Block):
    """A whole run: a scenario file with its defaults filled in and its paths made absolute."""

    name: Name
    """name of the scenario: letters, digits, - and _"""
    description: str = ""
    """what the scenario is, in one line"""
    robot: RobotBlock
    """the robot, and the arm or arms of it that are planned for"""
    table: TableBlock | None = None
    """the table, a box; leave it out for none"""
    objects: tuple[ObjectBlock, ...]
    """the objects of the task, and where they may lie"""
    apart: bool = False
    """whether places where objects overlap are left out; for a grid of regions"""
    obstacles: tuple[ObstacleBlock, ...] = ()
    """other things in the workcell that never move, placed in the world's frame"""
    regions: RegionsBlock
    """how the work area is divided"""
    coverage: CoverageBlock = CoverageBlock()
    """what the run must show"""
    demonstrations: DemonstrationsBlock = DemonstrationsBlock()
    """how many demonstrations there may be"""
    teacher: TeacherBlock
    """where demonstrations come from"""
    recorded_on: RecordedOnBlock | None = None
    """the arm that a recorded teacher's recordings, and those listed in `demonstrations.initial`,
    were made on, where it is not `robot`"""
    segmentation: SegmentationBlock = SegmentationBlock()
    """how recordings are cut into constant screws"""
    planner: PlannerBlock = PlannerBlock()
    """how plans are computed"""
    execution: ExecutionBlock = ExecutionBlock()
    """what a simulated execution may do and still be as planned"""
    seed: Annotated[int, Field(ge=0)] = 0
    """seed of all random draws"""
    meshcat: bool = False
    """whether a run shows itself in the browser as it goes on"""

    _source: Path | None = PrivateAttr(default=None)

    @property
    def source(self) -> Path | None:
        """The file it was read from; it does not take part in comparison."""
        return self._source

    def read_from(self, file: Path) -> Scenario:
        """The same scenario, with `file` as its source."""
        copy = self.model_copy()
        copy._source = file
        return copy

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scenario) and dict(self) == dict(other)

    @property
    def cells(self) -> tuple[tuple[int, ...], ...]:
        """Number of cells along each of AXES, of each object; to begin with, where adaptive."""
        grid = self.regions.grid or {}
        short = grid if len(self.objects) == 1 else {}

        def count(name: str, axis: str) -> int:
            return grid.get(f"{name}.{axis}", short.get(axis, 1))

        return tuple(tuple(count(o.name, axis) for axis in AXES) for o in self.objects)

    def broken_rules(self) -> Iterator[Problem]:
        if not self.objects:
            yield Problem(("objects",), "expected at least one object, found none")
        for index, name in repeated(o.name for o in self.objects):
            yield Problem(
                ("objects", index, "name"),
                f"there is another object named '{name}'",
                "Give every object a name of its own.",
            )
        names = [o.name for o in self.objects]
        for index, name in repeated([*names, *(o.name for o in self.obstacles)]):
            if index >= len(names):
                yield Problem(
                    ("obstacles", index - len(names), "name"),
                    f"there is another thing named '{name}'",
                    "Give every object and every obstacle a name of its own.",
                )
        for index, name in enumerate(self.demonstrations.objects):
            if name not in names:
                yield Problem(
                    ("demonstrations", "objects", index),
                    f"there is no object '{name}'",
                    suggestion(name, names, "Objects"),
                )
        yield from standing_problems(self.objects)
        yield from self._apart()
        yield from self._executed()
        yield from self._adaptive()
        yield from self._grid()
        K = math.prod(count for counts in self.cells for count in counts)
        if K > MOST_REGIONS:
            yield Problem(
                ("regions", "grid"),
                f"{K:,} regions; a grid has {MOST_REGIONS:,} at most",
                "Write smaller numbers, or `adaptive: {}` for cells that get small only where "
                "needed.",
            )

    def _apart(self) -> Iterator[Problem]:
        if self.apart and len(self.objects) == 1:
            yield Problem(
                ("apart",), "there is just one object", "Leave it out, or add another object."
            )
        if self.apart and self.regions.adaptive is not None:
            yield Problem(
                ("apart",),
                "adaptive regions are halved by what they take up, which says nothing of what is "
                "left where objects must not overlap",
                "Write a grid, as in `regions: {grid: {cup.x: 2, cup.y: 2}}`, or leave `apart` "
                "out.",
            )

    def _executed(self) -> Iterator[Problem]:
        if self.coverage.success == "plan":
            return
        if self.robot.arms is not None and len(self.robot.arms) > 1:
            yield Problem(
                ("coverage", "success"),
                "plans of one of several arms are not executed in a run",
                "Write coverage.success: plan, and see drake-screw execute; or give a single arm.",
            )
        if not self.planner.collision:
            yield Problem(
                ("planner", "collision"),
                "plans are executed (coverage.success: execution), and those that touch something "
                "never are",
                "Write planner.collision: true, or coverage.success: plan.",
            )

    def _adaptive(self) -> Iterator[Problem]:
        if self.regions.adaptive is None:
            return
        if all(o.fixes(axis) for o in self.objects for axis in AXES):
            yield Problem(
                ("regions", "adaptive"),
                "there is nothing to split: the pose of every object is fixed",
                "Give an object a range, or write `grid: {}` for a single region.",
            )
        if self.coverage.options:
            yield Problem(
                ("coverage", "options"),
                "adaptive regions bring a strategy of their own, which has no options here",
                "Leave the options out; what can be chosen is in regions.adaptive.",
            )

    def _grid(self) -> Iterator[Problem]:
        axes: dict[str, tuple[ObjectBlock, str]] = {}
        if len(self.objects) == 1:
            axes.update({axis: (self.objects[0], axis) for axis in AXES})
        axes.update({f"{o.name}.{axis}": (o, axis) for o in self.objects for axis in AXES})
        used: dict[tuple[str, str], str] = {}
        for name, count in (self.regions.grid or {}).items():
            keys = ("regions", "grid", name)
            if name not in axes:
                reason = "is an axis of every object" if name in AXES else "is no axis of an object"
                yield Problem(keys, f"'{name}' {reason}", suggestion(name, axes, "Axes"))
                continue
            item, axis = axes[name]
            if item.fixes(axis) and count > 1:
                yield Problem(
                    keys,
                    f"{axis} of '{item.name}' is fixed, so it cannot be split into {count} cells",
                    f"Give '{item.name}' a range in {axis}, or leave the axis out of the grid.",
                )
            first = used.setdefault((item.name, axis), name)
            if first != name:
                yield Problem(keys, f"the axis is given twice, as '{first}' and as '{name}'")
