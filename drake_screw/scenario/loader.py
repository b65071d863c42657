"""Reading scenario files, with errors that name the place, and writing them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import yaml
from pydantic import ValidationError

from drake_screw.errors import ScenarioError
from drake_screw.resources import SCENARIO_SUFFIXES, find_resource
from drake_screw.scenario.block import Problem
from drake_screw.scenario.problems import problems_of
from drake_screw.scenario.schema import Scenario
from drake_screw.scenario.yaml_marks import (
    Dumper,
    Entries,
    Node,
    Place,
    Scalar,
    locate,
    parse,
    plain,
    put,
)
from drake_screw.typing import PathLike

SHOWN = 12
"""Problems of a scenario that a message lists."""

_BEFORE_IT_WAS_WRITTEN = {
    ("segmentation", "method"): "published",
    ("demonstrations", "ask"): "earliest",
    ("demonstrations", "first"): "random",
    ("teacher", "choose"): "nearest",
}
"""What earlier versions did that had no such key."""


def load_scenario(name_or_path: PathLike, overrides: Sequence[str] = ()) -> Scenario:
    """Reads a scenario file, fills in defaults and makes its paths absolute.

    Opens no other file: a model or a recording that does not exist shows when it is used.

    Args:
        name_or_path: the name of a shipped scenario, or the path of a file.
        overrides: texts ``key.path=value`` that replace values of the file, in order. The value is
            YAML; lists are entered by place, from 0: ``objects.0.z=-0.06``. Paths are relative to
            the working directory, while those of the file are relative to the file.

    Raises:
        ScenarioError: the file does not exist or cannot be used. Names file, line and key of
            everything that is wrong, or the first thing where it is not even YAML.
    """
    file = find_resource("scenarios", name_or_path, SCENARIO_SUFFIXES)
    return _scenario(_entries(file), overrides, file)


def load_stored_scenario(file: PathLike) -> Scenario:
    """Reads a scenario that `dump_scenario` wrote, perhaps in an earlier version.

    Every key is written out there. One that is missing did not exist yet, and stands for what that
    version did, whatever the default has become.

    Raises:
        ScenarioError: as `load_scenario`.
    """
    path = find_resource("scenarios", file, SCENARIO_SUFFIXES)
    tree = _entries(path)
    overrides = []
    for (block, key), meaning in _BEFORE_IT_WAS_WRITTEN.items():
        found = tree.entries.get(block)
        if isinstance(found, Entries) and key not in found.entries:
            overrides.append(f"{block}.{key}={meaning}")
    planner = tree.entries.get("planner")
    if isinstance(planner, Entries) and "slide_margin" not in planner.entries:
        margin = planner.entries.get("joint_margin")
        if isinstance(margin, Scalar):  # of prismatic joints, too, in m
            overrides.append(f"planner.slide_margin={margin.value}")
    return _scenario(tree, overrides, path)


def dump_scenario(scenario: Scenario) -> str:
    """The scenario as YAML with every key written out, which `load_scenario` reads back as equal.

    Numbers are exact. Paths are absolute, so that the text can be put anywhere.
    """
    return yaml.dump(
        scenario.model_dump(mode="json", exclude_none=True),
        Dumper=Dumper,
        default_flow_style=None,
        sort_keys=False,
        allow_unicode=True,
        width=100,
    )


def _entries(file: Path) -> Entries:
    """The file's keys and values, with their marks."""
    tree = parse(_read(file), Place(file))
    if tree is None or (isinstance(tree, Scalar) and tree.value is None):
        raise ScenarioError("the file is empty", remedy="Start from a shipped one.", file=file)
    if not isinstance(tree, Entries):
        raise tree.place.error(
            "expected keys with values, such as `name: pouring`", "See the shipped scenarios."
        )
    return tree


def _scenario(tree: Node, overrides: Sequence[str], file: Path) -> Scenario:
    """What a file's tree says, with some of its values replaced."""
    for text in overrides:
        tree = _override(tree, text)
    data = plain(tree)
    try:
        return Scenario.model_validate(data).read_from(file)
    except ValidationError as error:
        raise _error(problems_of(error, data), tree, file) from None


def _read(file: Path) -> str:
    try:
        data = file.read_bytes()
    except OSError as error:
        raise ScenarioError(f"the file cannot be read: {error.strerror}", file=file) from None
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ScenarioError(
            f"the file is not UTF-8 text: byte 0x{data[error.start]:02x} has no meaning there",
            remedy="Save it as UTF-8.",
            file=file,
            line=data.count(b"\n", 0, error.start) + 1,
        ) from None


def _override(tree: Node, text: str) -> Node:
    path, equals, value = text.partition("=")
    keys = tuple(path.strip().split("."))
    place = Place(override=text)
    if not equals or not all(keys):
        raise place.error("expected key.path=value, such as coverage.beta=0.9")
    return put(tree, keys, parse(value, place) or Scalar(None, place))


def _error(problems: Sequence[Problem], tree: Node, file: Path) -> ScenarioError:
    errors = [locate(tree, p.keys).error(f"{p.path}: {p.message}", p.remedy) for p in problems]
    if len(errors) == 1:
        return errors[0]
    lines = []
    for error in sorted(errors, key=lambda e: e.line or 0)[:SHOWN]:
        place = "" if error.line is None else f"line {error.line}: "
        lines.append(f"  {place}{error.message}")
        lines.extend([f"    {error.remedy}"] if error.remedy else [])
    few = "" if len(errors) <= SHOWN else f", of which these are the first {SHOWN}"
    return ScenarioError("\n".join([f"{len(errors):,} problems{few}", *lines]), file=file)
