"""Where scenarios differ, key by key."""

from __future__ import annotations

from drake_screw.scenario.differences import Difference, differences, scenario_differences
from drake_screw.scenario.loader import load_scenario


def test_keys_are_those_that_set_takes() -> None:
    changes = ["objects.0.x=[0.7, 1.0]", "regions={adaptive: {}}", "objects.0.symmetry=null"]
    one, other = load_scenario("pouring"), load_scenario("pouring", changes)
    found = {d.key: d for d in scenario_differences([one, other])}
    assert list(found) == ["objects.0.x", "objects.0.symmetry", "regions.grid", "regions.adaptive"]
    assert found["objects.0.x"].words[1] == "[0.7, 1.0]"
    assert found["objects.0.symmetry"].words == ("{axis: z, turns: any}", "")
    assert found["regions.grid"].values == ({"x": 4, "y": 4}, None)
    back = [f"{key}={d.words[0] or 'null'}" for key, d in found.items()]
    assert scenario_differences([one, load_scenario(other.source, back)]) == ()


def test_scenarios_that_are_the_same_do_not_differ() -> None:
    assert scenario_differences([load_scenario("pouring")] * 3) == ()


def test_blocks_that_one_lacks_are_values() -> None:
    wall = {"name": "wall", "size": [1, 2]}
    found = differences([{"a": [wall], "b": 1}, {"a": [wall, wall]}, {"a": [wall], "b": True}])
    assert found == (Difference("a.1", (None, wall, None)), Difference("b", (1, None, True)))


def test_numbers_have_the_digits_that_tell_them_apart() -> None:
    assert Difference("a", (0.1234567, 0.9, None)).words == ("0.123457", "0.9", "")
    assert Difference("a", (0.1234567, 0.1234568)).words == ("0.1234567", "0.1234568")
    assert Difference("a", (1, True, "1")).words == ("1", "true", "'1'")
