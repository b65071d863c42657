"""``drake-screw list``: scenarios and robot models that come with the program."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from drake_screw.commands.options import JsonOption, VerboseOption
from drake_screw.commands.output import Output
from drake_screw.errors import counted

EXAMPLE = "drake-screw list"


@dataclass(frozen=True)
class ShippedScenario:
    """A scenario's name, its own words, and its file."""

    name: str
    description: str
    file: Path


@dataclass(frozen=True)
class ShippedModel:
    """A robot model's name, its joints that are not fixed, and its file."""

    name: str
    joints: tuple[str, ...]
    file: Path


@dataclass(frozen=True)
class Shipped:
    """All that is shipped; as text it is what ``drake-screw list`` prints."""

    scenarios: tuple[ShippedScenario, ...]
    models: tuple[ShippedModel, ...]

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        names = [s.name for s in self.scenarios] + [m.name for m in self.models]
        width = max(map(len, names))
        yield "scenarios (drake-screw run NAME; drake-screw init NAME writes a copy to change)"
        yield from (f"  {item.name:<{width}}  {item.description}" for item in self.scenarios)
        yield "robot models (robot.model: NAME in a scenario)"
        for model in self.models:
            first, last = model.joints[0], model.joints[-1]
            joints = counted(len(model.joints), "joint")
            yield f"  {model.name:<{width}}  {joints}, {first} ... {last}"


def list_shipped(json: JsonOption = None, verbose: VerboseOption = False) -> None:
    """List the scenarios and robot models that are shipped."""
    Output(json).present(shipped())


def shipped() -> Shipped:
    """What is shipped, by name."""
    from drake_screw.resources import (
        MODEL_SUFFIXES,
        SCENARIO_SUFFIXES,
        find_resource,
        list_resources,
    )
    from drake_screw.scenario.loader import load_scenario

    scenarios = [load_scenario(name) for name in list_resources("scenarios", SCENARIO_SUFFIXES)]
    models = {
        name: find_resource("models", name, MODEL_SUFFIXES)
        for name in list_resources("models", MODEL_SUFFIXES)
    }
    return Shipped(
        tuple(ShippedScenario(s.name, s.description, s.source) for s in scenarios if s.source),
        tuple(ShippedModel(name, _joints(file), file) for name, file in models.items()),
    )


def _joints(file: Path) -> tuple[str, ...]:
    joints = ElementTree.parse(file).getroot().iter("joint")
    return tuple(joint.get("name", "") for joint in joints if joint.get("type") != "fixed")
