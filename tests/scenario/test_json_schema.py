"""The JSON Schema that editors are given accepts what the loader accepts, and little else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import yaml
from jsonschema import Draft202012Validator

from drake_screw.errors import ScenarioError
from drake_screw.resources import SCENARIO_SUFFIXES, find_resource, list_resources
from drake_screw.scenario.json_schema import COMMAND, for_editors
from drake_screw.scenario.loader import dump_scenario, load_scenario
from drake_screw.scenario.reference_page import MINIMAL
from drake_screw.scenario.yaml_marks import Dumper, Place, parse, plain

FILE = Path(__file__).parents[2] / "scenarios" / "scenario.schema.json"
NAMES = list_resources("scenarios", SCENARIO_SUFFIXES)
SCHEMA = Draft202012Validator(json.loads(FILE.read_text()))


def errors(text: str) -> list[str]:
    """What an editor underlines in a file: the keys to it."""
    data = json.loads(json.dumps(plain(parse(text, Place()))))
    return [".".join(map(str, error.absolute_path)) for error in SCHEMA.iter_errors(data)]


def changed(**values: Any) -> str:
    return yaml.dump({**yaml.safe_load(MINIMAL), **values}, Dumper=Dumper)


def test_the_file_is_the_one_the_schema_gives() -> None:
    assert FILE.read_text() == for_editors(), f"{FILE.name} is stale; run: {COMMAND}"
    Draft202012Validator.check_schema(SCHEMA.schema)


@pytest.mark.parametrize("name", NAMES)
def test_shipped_scenarios_name_it_and_obey_it(name: str) -> None:
    file = find_resource("scenarios", name, SCENARIO_SUFFIXES)
    text = file.read_text()
    first = text.splitlines()[0]
    assert first == f"# yaml-language-server: $schema={FILE.name}"
    assert (file.parent / FILE.name).is_file()
    assert errors(text) == []
    assert errors(dump_scenario(load_scenario(name))) == []


@pytest.mark.parametrize(
    "values",
    [
        {"coverage": None},
        {"coverage": {"options": None, "epsilon": 0.01}},
        {"table": None, "recorded_on": None, "segmentation": {}},
        {"demonstrations": {"initial": ["one", "two"]}},
        {"obstacles": [{"name": "wall", "box": [1, 0.1, 1], "xyz": [3, 0, 0]}]},
        {"obstacles": [{"name": "jug", "mesh": "jug.obj", "scale": 0.001}]},
        {"coverage": {"strategy": "my.module:Mine", "options": {"n": 1, "fast": True}}},
        {"teacher": {"kind": "my.module:Mine", "patience": 3}},
        {"teacher": {"kind": "simulated", "motion": "my.module:nudging"}},
    ],
)
def test_what_the_loader_accepts_is_accepted(tmp_path: Path, values: dict[str, Any]) -> None:
    file = tmp_path / "minimal.yaml"
    file.write_text(changed(**values))
    load_scenario(file)
    assert errors(file.read_text()) == []


@pytest.mark.parametrize(
    ("values", "place"),
    [
        ({"sede": 1}, ""),
        ({"seed": -1}, "seed"),
        ({"robot": None}, "robot"),
        ({"coverage": {"betta": 0.9}}, "coverage"),
        ({"coverage": {"beta": 1.0}}, "coverage.beta"),
        ({"coverage": {"strategy": "eproces"}}, "coverage.strategy"),
        ({"teacher": {"kind": "simulated", "motoin": "pouring"}}, "teacher"),
        ({"planner": {"collision": "no"}}, "planner.collision"),
        ({"regions": {"grid": {"x": 0}}}, "regions.grid"),
        ({"obstacles": [{"name": "wall", "box": [1, 1]}]}, "obstacles.0.box"),
        ({"obstacles": [{"name": "wall", "ball": 1}]}, "obstacles.0"),
    ],
)
def test_what_the_loader_refuses_is_refused(
    tmp_path: Path, values: dict[str, Any], place: str
) -> None:
    file = tmp_path / "minimal.yaml"
    file.write_text(changed(**values))
    with pytest.raises(ScenarioError):
        load_scenario(file)
    assert place in errors(file.read_text())
