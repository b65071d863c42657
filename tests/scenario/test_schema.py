"""The schema describes itself, and its rules refuse what a run could not use."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import FrozenInstanceError, fields, is_dataclass, replace
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest

from drake_screw.scenario.checks import find_problems
from drake_screw.scenario.schema import (
    STRATEGIES,
    AdaptiveBlock,
    CoverageBlock,
    DemonstrationsBlock,
    Interval,
    ObjectBlock,
    PlannerBlock,
    RecordedOnBlock,
    RegionsBlock,
    RobotBlock,
    Scenario,
    SegmentationBlock,
    TableBlock,
    TeacherBlock,
)

BOWL = ObjectBlock(
    name="bowl", x=Interval(0.7, 1.1), y=Interval(0.3, 0.3), z=0.0, radius=0.08, height=0.06
)
GOOD = Scenario(
    name="good",
    robot=RobotBlock(model="arm", joints=("a", "b"), end_effector="hand", start=(0.0, 1.0)),
    objects=(BOWL,),
    regions=RegionsBlock(grid={"x": 4}),
    teacher=TeacherBlock(kind="simulated", motion="pouring"),
)
CUP = replace(BOWL, name="cup", yaw=Interval(-1, 1))


def blocks(block: type) -> Iterator[type]:
    yield block
    for hint in get_type_hints(block).values():
        for inner in (hint, *get_args(hint)):
            if is_dataclass(inner) and inner is not Interval:
                yield from blocks(inner)


def test_every_key_is_described_and_every_block_frozen() -> None:
    found = list(blocks(Scenario))
    assert len(found) == 12
    for block in found:
        for item in fields(block):
            if item.name == "source":
                assert not item.metadata
                continue
            assert item.metadata["meaning"], f"{block.__name__}.{item.name}"
            assert item.metadata["unit"] in ("", "m", "rad")
    with pytest.raises(FrozenInstanceError):
        GOOD.seed = 1  # type: ignore[misc]


def test_a_good_scenario_has_no_problems() -> None:
    assert find_problems(GOOD) == ()


def test_cells_are_per_object_and_axis() -> None:
    assert GOOD.cells == ((4, 1, 1),)
    assert replace(GOOD, regions=RegionsBlock(grid={"bowl.x": 3})).cells == ((3, 1, 1),)
    two = replace(GOOD, objects=(BOWL, CUP), regions=RegionsBlock(grid={"cup.yaw": 5, "bowl.x": 2}))
    assert find_problems(two) == ()
    assert two.cells == ((2, 1, 1), (1, 1, 5))


def test_adaptive_regions_start_as_one() -> None:
    assert find_problems(adaptive()) == ()
    assert adaptive().cells == ((1, 1, 1),)


def test_source_does_not_take_part_in_comparison() -> None:
    assert replace(GOOD, source=Path("/somewhere.yaml")) == GOOD


def with_block(name: str, **values: Any) -> Scenario:
    return replace(GOOD, **{name: replace(getattr(GOOD, name), **values)})


def with_object(**values: Any) -> Scenario:
    return replace(GOOD, objects=(replace(BOWL, **values),))


def adaptive(**values: Any) -> Scenario:
    return replace(GOOD, regions=RegionsBlock(adaptive=AdaptiveBlock(**values)))


def recorded_on(**values: Any) -> Scenario:
    block = RecordedOnBlock(model="arm", joints=("c", "d"), end_effector="hand")
    return replace(GOOD, recorded_on=replace(block, **values))


def test_another_robot_may_have_made_the_recordings() -> None:
    assert GOOD.recorded_on is None
    assert find_problems(recorded_on()) == ()
    assert find_problems(recorded_on(joints=("a", "b", "e"), parked={"c": 0.0})) == ()


@pytest.mark.parametrize(
    ("scenario", "path", "message", "remedy"),
    [
        (replace(GOOD, name="a b"), "name", "letters, digits, - and _; found 'a b'", ""),
        (replace(GOOD, name=""), "name", "letters, digits", ""),
        (replace(GOOD, seed=-1), "seed", "expected a number of at least 0, found -1", ""),
        (with_block("robot", joints=(), start=()), "robot.joints", "at least one joint", ""),
        (with_block("robot", joints=("a", "a")), "robot.joints.1", "'a' is listed twice", ""),
        (with_block("robot", start=(0.0,)), "robot.start", "expected 2 angles", "Joints: a, b"),
        (
            with_block("robot", parked={"b": 0.0}),
            "robot.parked.b",
            "belongs to the arm",
            "robot.start",
        ),
        (recorded_on(joints=()), "recorded_on.joints", "at least one joint", ""),
        (recorded_on(joints=("c", "c")), "recorded_on.joints.1", "'c' is listed twice", ""),
        (recorded_on(parked={"c": 0.0}), "recorded_on.parked.c", "belongs to the arm", "leave it"),
        (
            replace(GOOD, table=TableBlock(center=(0, 0), size=(1, 0), top=0)),
            "table.size.1",
            "expected a number above 0, found 0",
            "extent",
        ),
        (replace(GOOD, objects=(), regions=RegionsBlock(grid={})), "objects", "at least one", ""),
        (
            replace(GOOD, objects=(BOWL, BOWL), regions=RegionsBlock(grid={})),
            "objects.1.name",
            "another object named 'bowl'",
            "",
        ),
        (with_object(name="b.x"), "objects.0.name", "letters, digits, - and _", ""),
        (with_object(x=Interval(1.0, 0.5)), "objects.0.x", "lower limit 1.0 lies above", "single"),
        (with_object(x=Interval(-1.7e308, 1.7e308)), "objects.0.x", "too wide", ""),
        (with_object(yaw=Interval(-180, 180)), "objects.0.yaw", "wider than a full turn", "rad"),
        (with_object(radius=0.0), "objects.0.radius", "above 0, found 0.0", "radius"),
        (with_object(height=-1.0), "objects.0.height", "above 0, found -1.0", "height"),
        (with_block("regions", grid={"x": 0}), "regions.grid.x", "at least 1, found 0", ""),
        (with_block("regions", grid={"yow": 1}), "regions.grid.yow", "no axis", "mean 'yaw'?"),
        (with_block("regions", grid={"y": 2}), "regions.grid.y", "y of 'bowl' is fixed", "range"),
        (with_block("regions", grid={"x": 2, "bowl.x": 2}), "regions.grid.bowl.x", "twice", ""),
        (
            replace(GOOD, objects=(BOWL, CUP)),
            "regions.grid.x",
            "'x' is an axis of every object",
            "Axes: bowl.x, bowl.y, bowl.yaw, cup.x",
        ),
        (with_block("regions", grid=None), "regions", "grid or adaptive, found neither", "{x: 4"),
        (
            with_block("regions", adaptive=AdaptiveBlock()),
            "regions",
            "found grid and adaptive",
            "`adaptive: {}`",
        ),
        (adaptive(smallest=1.0), "regions.adaptive.smallest", "below 1, found 1.0", "share"),
        (adaptive(smallest=1e-10), "regions.adaptive.smallest", "of at least 1e-09", ""),
        (adaptive(level=0.0), "regions.adaptive.level", "above 0 and below 1", "noticed"),
        (
            replace(adaptive(), objects=(replace(BOWL, x=Interval(1, 1)),)),
            "regions.adaptive",
            "nothing to split",
            "range",
        ),
        (
            replace(adaptive(), coverage=CoverageBlock(options={"spend": False})),
            "coverage.options",
            "strategy of their own",
            "regions.adaptive",
        ),
        (with_block("coverage", beta=1.0), "coverage.beta", "above 0 and below 1, found 1.0", ""),
        (with_block("coverage", delta=0.0), "coverage.delta", "above 0 and below 1", "confidence"),
        (
            with_block("coverage", epsilon=0.0),
            "coverage.epsilon",
            "at least 0.0001 and below 1",
            "",
        ),
        (with_block("coverage", epsilon=0.05), "coverage.epsilon", "could never stop", "0.05"),
        (with_block("coverage", beta=0.9, epsilon=0.1), "coverage.epsilon", "never stop", "0.1"),
        (
            with_block("coverage", strategy="naive"),
            "coverage.strategy",
            "there is no 'naive'",
            "Did you mean 'naive_pac'?",
        ),
        (with_block("demonstrations", initial=-1), "demonstrations.initial", "at least 0", ""),
        (with_block("demonstrations", initial=13), "demonstrations.budget", "the 13 initial", ""),
        (
            with_block("demonstrations", initial=(Path("/a"), Path("/b")), budget=1),
            "demonstrations.budget",
            "the 2 initial demonstrations, found 1",
            "",
        ),
        (with_block("demonstrations", initial=0, budget=0), "demonstrations.budget", "1", ""),
        (
            with_block("teacher", kind="recorder"),
            "teacher.kind",
            "there is no 'recorder'",
            "Did you mean 'recorded'? Choices: simulated, recorded",
        ),
        (with_block("teacher", motion="pour"), "teacher.motion", "'pour'", "mean 'pouring'?"),
        (with_block("teacher", motion=None), "teacher.motion", "missing; a simulated", ""),
        (with_block("teacher", folder=Path("/a")), "teacher.folder", "has no folder", ""),
        (
            replace(GOOD, teacher=TeacherBlock(kind="recorded")),
            "teacher.folder",
            "missing; a recorded teacher needs it",
            "",
        ),
        (
            replace(GOOD, segmentation=SegmentationBlock(region_of_interest=0.9)),
            "segmentation.region_of_interest",
            "of at least 1",
            "",
        ),
        (
            replace(GOOD, planner=PlannerBlock(tolerance=0.0)),
            "planner.tolerance",
            "at least 1e-09",
            "",
        ),
    ],
)
def test_rules(scenario: Scenario, path: str, message: str, remedy: str) -> None:
    (problem,) = find_problems(scenario)
    assert problem.path == path
    assert message in problem.message
    assert remedy in (problem.remedy or "")


def test_several_problems_are_all_found() -> None:
    scenario = replace(
        GOOD, seed=-1, coverage=CoverageBlock(delta=2.0), objects=(replace(BOWL, radius=-1.0),)
    )
    assert {p.path for p in find_problems(scenario)} == {
        "objects.0.radius",
        "coverage.delta",
        "seed",
    }


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_every_strategy_is_accepted(strategy: str) -> None:
    assert find_problems(with_block("coverage", strategy=strategy)) == ()


def test_limits_that_are_just_met_are_accepted() -> None:
    assert find_problems(with_object(yaw=Interval(-math.pi, math.pi))) == ()
    assert find_problems(with_block("coverage", epsilon=0.0499)) == ()
    assert (
        find_problems(replace(GOOD, demonstrations=DemonstrationsBlock(initial=3, budget=3))) == ()
    )
