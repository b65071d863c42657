"""The schema describes itself, and its rules refuse what a run could not use."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import pytest
from pydantic import ValidationError

from drake_screw.bandits import STRATEGIES
from drake_screw.scenario.block import Block, Problem
from drake_screw.scenario.meanings import meanings
from drake_screw.scenario.object_blocks import ObjectBlock
from drake_screw.scenario.problems import problems_of
from drake_screw.scenario.robot_blocks import RecordedOnBlock, RobotBlock
from drake_screw.scenario.run_blocks import (
    CoverageBlock,
    DemonstrationsBlock,
    RegionsBlock,
    TeacherBlock,
)
from drake_screw.scenario.schema import Scenario
from drake_screw.scenario.values import Interval

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
CUP = BOWL.model_copy(update={"name": "cup", "yaw": Interval(-1, 1)})

Data = dict[str, Any]


def blocks(block: type[Block]) -> Iterator[type[Block]]:
    yield block
    for field in block.model_fields.values():
        for inner in (field.annotation, *get_args(field.annotation)):
            if isinstance(inner, type) and issubclass(inner, Block):
                yield from blocks(inner)


def find_problems(data: Data) -> tuple[Problem, ...]:
    try:
        Scenario.model_validate(data)
    except ValidationError as error:
        return tuple(problems_of(error, data))
    return ()


def test_every_key_is_described_and_every_block_frozen() -> None:
    found = list(blocks(Scenario))
    assert len(set(found)) == 20
    for block in found:
        for name, field in block.model_fields.items():
            assert meanings(block).get(name), f"{block.__name__}.{name}"
            extra = field.json_schema_extra
            units = ("m", "rad", "rad/s", "kg", "N")
            assert extra is None or extra in [{"unit": unit} for unit in units]
        assert block.model_config["frozen"]
    with pytest.raises(ValidationError, match="frozen"):
        GOOD.seed = 1  # type: ignore[misc]


def test_a_good_scenario_has_no_problems() -> None:
    assert find_problems(changed()) == ()
    assert Scenario.model_validate(changed()) == GOOD


def test_cells_are_per_object_and_axis() -> None:
    assert GOOD.cells == ((4, 1, 1, 1, 1, 1),)
    assert Scenario(**changed(regions={"grid": {"bowl.x": 3}})).cells == ((3, 1, 1, 1, 1, 1),)
    two = changed(objects=(BOWL, CUP), regions=RegionsBlock(grid={"cup.yaw": 5, "bowl.x": 2}))
    assert find_problems(two) == ()
    assert Scenario(**two).cells == ((2, 1, 1, 1, 1, 1), (1, 1, 5, 1, 1, 1))


def test_adaptive_regions_start_as_one() -> None:
    assert find_problems(adaptive()) == ()
    assert Scenario(**adaptive()).cells == ((1, 1, 1, 1, 1, 1),)


def test_source_does_not_take_part_in_comparison() -> None:
    read = GOOD.read_from(Path("/somewhere.yaml"))
    assert read.source == Path("/somewhere.yaml")
    assert read.model_copy(update={"seed": 3}).source == read.source
    assert read == GOOD
    assert read != GOOD.model_copy(update={"seed": 3})


def changed(**values: Any) -> Data:
    return {**GOOD.model_dump(), **values}


def with_block(name: str, **values: Any) -> Data:
    return changed(**{name: {**GOOD.model_dump()[name], **values}})


def with_object(**values: Any) -> Data:
    return changed(objects=({**BOWL.model_dump(), **values},))


def adaptive(**values: Any) -> Data:
    return changed(regions={"adaptive": values})


def obstacle(**values: Any) -> Data:
    return changed(obstacles=({"name": "wall", **values},))


def tool(**values: Any) -> Data:
    return with_block("robot", tool=values)


BOX = {"box": (0.1, 0.2, 0.3)}


def recorded_on(**values: Any) -> Data:
    block = RecordedOnBlock(model="arm", joints=("c", "d"), end_effector="hand")
    return changed(recorded_on={**block.model_dump(), **values})


def test_another_robot_may_have_made_the_recordings() -> None:
    assert GOOD.recorded_on is None
    assert find_problems(recorded_on()) == ()
    assert find_problems(recorded_on(joints=("a", "b", "e"), parked={"c": 0.0})) == ()


@pytest.mark.parametrize(
    ("data", "path", "message", "remedy"),
    [
        (changed(name="a b"), "name", "letters, digits, - and _; found 'a b'", ""),
        (changed(name=""), "name", "letters, digits", ""),
        (changed(seed=-1), "seed", "expected a number of at least 0, found -1", ""),
        (with_block("robot", joints=(), start=()), "robot.joints", "at least one joint", ""),
        (with_block("robot", joints=("a", "a")), "robot.joints.1", "'a' is listed twice", ""),
        (with_block("robot", start=(0.0,)), "robot.start", "expected 2 angles", "Joints: a, b"),
        (with_block("robot", start=()), "robot.start", "expected 2 angles", "Joints: a, b"),
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
            changed(table={"center": (0, 0), "size": (1, 0), "top": 0}),
            "table.size.1",
            "expected a number above 0, found 0",
            "extent",
        ),
        (changed(objects=(), regions=RegionsBlock(grid={})), "objects", "at least one", ""),
        (
            changed(objects=(BOWL, BOWL), regions=RegionsBlock(grid={})),
            "objects.1.name",
            "another object named 'bowl'",
            "",
        ),
        (
            obstacle(),
            "obstacles.0",
            "expected one shape, found none",
            "box, cylinder, sphere, mesh",
        ),
        (obstacle(**BOX, sphere={"radius": 1.0}), "obstacles.0", "found box and sphere", ""),
        (obstacle(box=(0.1, -0.2, 0.3)), "obstacles.0.box.1", "above 0, found -0.2", "full sizes"),
        (obstacle(box=(0.1, 0.2)), "obstacles.0.box", "expected a list of 3 numbers", ""),
        (
            obstacle(cylinder={"radius": 0.0, "length": 1.0}),
            "obstacles.0.cylinder.radius",
            "above 0, found 0.0",
            "",
        ),
        (obstacle(**BOX, scale=2.0), "obstacles.0.scale", "a box has no scale", "Leave it out"),
        (obstacle(**BOX, name="bowl"), "obstacles.0.name", "another thing named 'bowl'", "own"),
        (
            changed(obstacles=({"name": "wall", **BOX}, {"name": "wall", **BOX})),
            "obstacles.1.name",
            "another thing named 'wall'",
            "",
        ),
        (tool(shape={}), "robot.tool.shape", "expected one shape, found none", ""),
        (tool(touches=("a",)), "robot.tool.touches", "without a shape", "Give it a shape"),
        (tool(shape=BOX, touches=("a", "a")), "robot.tool.touches.1", "listed twice", ""),
        (with_object(name="b.x"), "objects.0.name", "letters, digits, - and _", ""),
        (with_object(x=(1.0, 0.5)), "objects.0.x", "lower limit 1.0 lies above", "single"),
        (
            with_object(x=(-1.7e308, 1.7e308)),
            "objects.0.x",
            "-1.7e+308 m is beyond 1,000 m",
            "in m",
        ),
        (with_object(yaw=(-180, 180)), "objects.0.yaw", "wider than a full turn", "rad"),
        (with_object(radius=0.0), "objects.0.radius", "above 0, found 0.0", "radius"),
        (with_object(height=-1.0), "objects.0.height", "above 0, found -1.0", "height"),
        (with_block("regions", grid={"x": 0}), "regions.grid.x", "at least 1, found 0", ""),
        (with_block("regions", grid={"yow": 1}), "regions.grid.yow", "no axis", "mean 'yaw'?"),
        (with_block("regions", grid={"y": 2}), "regions.grid.y", "y of 'bowl' is fixed", "range"),
        (with_block("regions", grid={"x": 2, "bowl.x": 2}), "regions.grid.bowl.x", "twice", ""),
        (
            changed(objects=(BOWL, CUP)),
            "regions.grid.x",
            "'x' is an axis of every object",
            "Axes: bowl.x, bowl.y, bowl.yaw, bowl.z",
        ),
        (with_block("regions", grid=None), "regions", "grid or adaptive, found neither", "{x: 4"),
        (
            with_block("regions", adaptive={}),
            "regions",
            "found grid and adaptive",
            "`adaptive: {}`",
        ),
        (adaptive(smallest=1.0), "regions.adaptive.smallest", "below 1, found 1.0", "share"),
        (adaptive(smallest=1e-10), "regions.adaptive.smallest", "of at least 1e-09", ""),
        (adaptive(level=0.0), "regions.adaptive.level", "at least 1e-12 and below 1", "noticed"),
        (
            {**adaptive(), "objects": ({**BOWL.model_dump(), "x": 1},)},
            "regions.adaptive",
            "nothing to split",
            "range",
        ),
        (
            {**adaptive(), "coverage": CoverageBlock(options={"spend": False})},
            "coverage.options",
            "strategy of their own",
            "regions.adaptive",
        ),
        (
            with_block("coverage", beta=1.0),
            "coverage.beta",
            "at least 1e-12 and below 1, found 1.0",
            "",
        ),
        (with_block("coverage", delta=0.0), "coverage.delta", "at least 1e-12 and below 1", ""),
        (with_block("coverage", delta=1e-320), "coverage.delta", "at least 1e-12", ""),
        (with_block("coverage", beta=1e-320), "coverage.beta", "at least 1e-12", ""),
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
            with_block("demonstrations", ask="earlyest"),
            "demonstrations.ask",
            "there is no 'earlyest'",
            "Did you mean 'earliest'? Choices: earliest, densest, densest_anywhere",
        ),
        (
            with_block("demonstrations", first="center"),
            "demonstrations.first",
            "there is no 'center'",
            "Choices: random, middle, farthest",
        ),
        (
            with_block("teacher", choose="most"),
            "teacher.choose",
            "there is no 'most'",
            "Choices: nearest, covers_most",
        ),
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
            changed(teacher={"kind": "recorded"}),
            "teacher.folder",
            "missing; a recorded teacher needs it",
            "",
        ),
        (
            changed(segmentation={"region_of_interest": 0.9}),
            "segmentation.region_of_interest",
            "of at least 1",
            "",
        ),
        (
            changed(planner={"tolerance": 0.0}),
            "planner.tolerance",
            "at least 1e-09",
            "",
        ),
    ],
)
def test_rules(data: Data, path: str, message: str, remedy: str) -> None:
    (problem,) = find_problems(data)
    assert problem.path == path
    assert message in problem.message
    assert remedy in (problem.remedy or "")


def test_several_problems_are_all_found() -> None:
    data = changed(
        seed=-1, coverage={"delta": 2.0}, objects=({**BOWL.model_dump(), "radius": -1.0},)
    )
    assert {p.path for p in find_problems(data)} == {
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
    assert find_problems(changed(demonstrations=DemonstrationsBlock(initial=3, budget=3))) == ()
