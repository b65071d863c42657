"""Rules that the values of a scenario must obey, beyond having the right types."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from drake_screw.errors import nearest
from drake_screw.scenario.schema import (
    AXES,
    Interval,
    ObjectBlock,
    RecordedOnBlock,
    RobotBlock,
    Scenario,
)

Keys = tuple[str | int, ...]
"""The way to a value in the file: names of keys, and places in lists, counted from 0."""


MOST_REGIONS = 4096
"""Of a grid. Every region takes some samples in every round, and its place in every picture."""


@dataclass(frozen=True)
class Problem:
    """What is wrong with the value at `keys`, and what the user can do about it."""

    keys: Keys
    message: str
    remedy: str | None = None

    @property
    def path(self) -> str:
        """For example ``objects.0.radius``."""
        return ".".join(str(k) for k in self.keys)


def suggestion(name: str, valid: Iterable[str], plural: str) -> str:
    """For example ``Did you mean 'beta'? Keys: beta, epsilon``."""
    valid = list(valid)
    guess = nearest(name, valid)
    return (f"Did you mean '{guess}'? " if guess else "") + f"{plural}: {', '.join(valid)}"


def find_problems(scenario: Scenario) -> tuple[Problem, ...]:
    """Every rule that a scenario breaks; empty where it is usable.

    Rules about several keys at once are tried only when each key is within its own limits.
    Reads no file: whether a model or a recording exists shows when it is opened.
    """
    return tuple(_block(scenario, ())) or tuple(
        problem
        for rule in (
            *(_robot, _objects, _regions, _grid, _number_of_regions, _coverage),
            *(_demonstrations, _teacher, _recorded_on),
        )
        for problem in rule(scenario)
    )


def _block(block: Any, keys: Keys) -> Iterator[Problem]:
    for item in fields(block):
        if "meaning" in item.metadata:
            yield from _value(getattr(block, item.name), (*keys, item.name), item.metadata)


def _value(value: Any, keys: Keys, rules: Mapping[str, Any]) -> Iterator[Problem]:
    if isinstance(value, Interval):
        if value.lower > value.upper:
            yield Problem(
                keys,
                f"lower limit {value.lower} lies above upper limit {value.upper}",
                "Write [lower, upper], or a single number for a fixed value.",
            )
    elif is_dataclass(value):
        yield from _block(value, keys)
    elif isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from _value(item, (*keys, index), rules)
    elif isinstance(value, dict):
        for name, item in value.items():
            yield from _value(item, (*keys, name), rules)
    elif isinstance(value, str):
        yield from _text(value, keys, rules)
    elif isinstance(value, int | float):
        yield from _number(value, keys, rules)


def _text(value: str, keys: Keys, rules: Mapping[str, Any]) -> Iterator[Problem]:
    choices, pattern = rules["choices"], rules["pattern"]
    if choices and value not in choices:
        yield Problem(keys, f"there is no '{value}'", suggestion(value, choices, "Choices"))
    if pattern and not re.fullmatch(pattern, value):
        yield Problem(keys, f"expected the {rules['meaning']}; found '{value}'")


def _number(value: float, keys: Keys, rules: Mapping[str, Any]) -> Iterator[Problem]:
    limits = []
    if math.isfinite(rules["above"]):
        limits.append((value > rules["above"], f"above {rules['above']}"))
    if math.isfinite(rules["at_least"]):
        limits.append((value >= rules["at_least"], f"of at least {rules['at_least']}"))
    if math.isfinite(rules["below"]):
        limits.append((value < rules["below"], f"below {rules['below']}"))
    if not all(kept for kept, _ in limits):
        wanted = " and ".join(text for _, text in limits)
        yield Problem(
            keys, f"expected a number {wanted}, found {value}", f"Meaning: {rules['meaning']}."
        )


def _repeated(names: Iterable[str]) -> Iterator[tuple[int, str]]:
    seen = set()
    for index, name in enumerate(names):
        if name in seen:
            yield index, name
        seen.add(name)


def _robot(scenario: Scenario) -> Iterator[Problem]:
    robot = scenario.robot
    yield from _joints(robot, "robot", "Give its angle in robot.start.")
    if len(robot.start) != len(robot.joints):
        yield Problem(
            ("robot", "start"),
            f"expected {len(robot.joints)} angles, one for each joint, found {len(robot.start)}",
            f"Joints: {', '.join(robot.joints)}",
        )


def _joints(arm: RobotBlock | RecordedOnBlock, block: str, instead: str) -> Iterator[Problem]:
    if not arm.joints:
        yield Problem((block, "joints"), "expected at least one joint, found none")
    for index, name in _repeated(arm.joints):
        yield Problem((block, "joints", index), f"joint '{name}' is listed twice")
    for name in arm.parked:
        if name in arm.joints:
            yield Problem(
                (block, "parked", name),
                f"joint '{name}' belongs to the arm, so it cannot be parked",
                instead,
            )


def _objects(scenario: Scenario) -> Iterator[Problem]:
    if not scenario.objects:
        yield Problem(("objects",), "expected at least one object, found none")
    for index, name in _repeated(o.name for o in scenario.objects):
        yield Problem(
            ("objects", index, "name"),
            f"there is another object named '{name}'",
            "Give every object a name of its own.",
        )
    for index, item in enumerate(scenario.objects):
        for axis in AXES:
            interval = getattr(item, axis)
            if not math.isfinite(interval.upper - interval.lower):
                yield Problem(("objects", index, axis), "the range is too wide")
        if item.yaw.upper - item.yaw.lower > 2 * math.pi + 1e-9:
            yield Problem(
                ("objects", index, "yaw"),
                "the range is wider than a full turn",
                "Angles are in rad; a full turn is [-3.141592653589793, 3.141592653589793].",
            )


def _regions(scenario: Scenario) -> Iterator[Problem]:
    given = [name for name in ("grid", "adaptive") if getattr(scenario.regions, name) is not None]
    if len(given) != 1:
        yield Problem(
            ("regions",),
            f"expected either grid or adaptive, found {' and '.join(given) or 'neither'}",
            "Write `grid: {x: 4, y: 4}` for cells of one size, or `adaptive: {}` for cells that "
            "are halved wherever something fails.",
        )
    if scenario.regions.adaptive is None:
        return
    if all(getattr(o, axis).fixed for o in scenario.objects for axis in AXES):
        yield Problem(
            ("regions", "adaptive"),
            "there is nothing to split: x, y and yaw of every object are fixed",
            "Give an object a range, or write `grid: {}` for a single region.",
        )
    if scenario.coverage.options:
        yield Problem(
            ("coverage", "options"),
            "adaptive regions bring a strategy of their own, which has no options here",
            "Leave the options out; what can be chosen is in regions.adaptive.",
        )


def _number_of_regions(scenario: Scenario) -> Iterator[Problem]:
    K = math.prod(count for counts in scenario.cells for count in counts)
    if K > MOST_REGIONS:
        yield Problem(
            ("regions", "grid"),
            f"{K:,} regions; a grid has {MOST_REGIONS:,} at most",
            "Write smaller numbers, or `adaptive: {}` for cells that get small only where needed.",
        )


def _grid(scenario: Scenario) -> Iterator[Problem]:
    axes: dict[str, tuple[ObjectBlock, str]] = {}
    if len(scenario.objects) == 1:
        axes.update({axis: (scenario.objects[0], axis) for axis in AXES})
    axes.update({f"{o.name}.{axis}": (o, axis) for o in scenario.objects for axis in AXES})
    used: dict[tuple[str, str], str] = {}
    for name, count in (scenario.regions.grid or {}).items():
        keys = ("regions", "grid", name)
        if name not in axes:
            reason = "is an axis of every object" if name in AXES else "is no axis of an object"
            yield Problem(keys, f"'{name}' {reason}", suggestion(name, axes, "Axes"))
            continue
        item, axis = axes[name]
        if getattr(item, axis).fixed and count > 1:
            yield Problem(
                keys,
                f"{axis} of '{item.name}' is fixed, so it cannot be split into {count} cells",
                f"Give '{item.name}' a range in {axis}, or leave the axis out of the grid.",
            )
        first = used.setdefault((item.name, axis), name)
        if first != name:
            yield Problem(keys, f"the axis is given twice, as '{first}' and as '{name}'")


def _coverage(scenario: Scenario) -> Iterator[Problem]:
    slack = 1 - scenario.coverage.beta
    if scenario.coverage.epsilon >= slack - 1e-12:
        yield Problem(
            ("coverage", "epsilon"),
            f"the run could never stop: epsilon = {scenario.coverage.epsilon:g} is not below "
            f"1 - beta = {slack:g}, so no measurement could tell that a region is good enough",
            f"Choose an epsilon below {slack:g}, or a smaller beta.",
        )


def _demonstrations(scenario: Scenario) -> Iterator[Problem]:
    block = scenario.demonstrations
    if block.budget < block.initial_count:
        yield Problem(
            ("demonstrations", "budget"),
            f"expected at least the {block.initial_count} initial demonstrations, "
            f"found {block.budget}",
        )


def _teacher(scenario: Scenario) -> Iterator[Problem]:
    teacher = scenario.teacher
    needs = {"simulated": "motion", "recorded": "folder"}.get(teacher.kind)
    lacks = {"simulated": "folder"}.get(teacher.kind, "motion")
    if needs is not None and getattr(teacher, needs) is None:
        yield Problem(("teacher", needs), f"missing; a {teacher.kind} teacher needs it")
    if getattr(teacher, lacks) is not None:
        yield Problem(("teacher", lacks), f"a {teacher.kind} teacher has no {lacks}")


def _recorded_on(scenario: Scenario) -> Iterator[Problem]:
    block = scenario.recorded_on
    if block is not None:
        yield from _joints(block, "recorded_on", "Its angles are in the recordings; leave it out.")
