"""Parts are found by name: built in, from installed packages, or anybody's own."""

from __future__ import annotations

import sys
from importlib.metadata import EntryPoint, EntryPoints
from pathlib import Path
from typing import get_args

import pytest

from drake_screw import bandits, plugins
from drake_screw.acquisition.simulated import MOTIONS
from drake_screw.errors import PluginError, RecordingError
from drake_screw.plugins import BUILT_IN, Group, find, is_known, is_plugged_in, names


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that modules are imported from."""
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


@pytest.fixture
def installed(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A package that declares a strategy, and one that has the name of a built-in one."""
    (own / "installed_part.py").write_text("class Patient: pass\n")
    points = EntryPoints(
        EntryPoint(name, "installed_part:Patient", "drake_screw.strategies")
        for name in ("patient", "eprocess")
    )
    monkeypatch.setattr(plugins, "entry_points", lambda group: points.select(group=group))


@pytest.mark.parametrize("group", get_args(Group))
def test_every_built_in_part_is_where_it_is_said_to_be(group: Group) -> None:
    for name in BUILT_IN[group]:
        assert callable(find(group, name))
        assert is_known(group, name)
        assert not is_plugged_in(group, name)


def test_built_in_names_are_those_of_the_parts() -> None:
    assert tuple(find("strategies", n).name for n in BUILT_IN["strategies"]) == bandits.STRATEGIES
    assert dict(MOTIONS) == {name: find("motions", name) for name in BUILT_IN["motions"]}


def test_entry_points_are_found_by_name_after_the_built_in_ones(installed: None) -> None:
    assert names("strategies") == (*bandits.STRATEGIES, "patient")
    assert find("strategies", "patient").__name__ == "Patient"
    assert is_plugged_in("strategies", "patient")
    assert find("strategies", "eprocess").__name__ == "EProcess"
    assert names("motions") == tuple(MOTIONS)


def test_a_reference_finds_anything_that_can_be_called(own: Path) -> None:
    (own / "own_part.py").write_text("class Outer:\n    class Inner: pass\n")
    assert is_plugged_in("teachers", "own_part:Outer.Inner")
    assert find("teachers", "own_part:Outer.Inner").__name__ == "Inner"


@pytest.mark.parametrize("name", ["", ":", "a:", ":b", "a b:c", "a/b:c", "a.:b", "simulatd"])
def test_what_is_no_name_and_no_reference_is_refused(name: str) -> None:
    assert not is_known("teachers", name)
    with pytest.raises(PluginError, match="no teacher") as caught:
        find("teachers", name)
    assert "Choices: simulated, recorded, interactive; or package.module:Object" in str(
        caught.value
    )


@pytest.mark.parametrize(
    ("text", "name", "message"),
    [
        (None, "missing_part:Mine", "module missing_part cannot be imported: ModuleNotFoundError"),
        ("1 / 0", "broken_part:Mine", "cannot be imported: ZeroDivisionError: division by zero"),
        ("class Mine: pass", "broken_part:Mien", "no 'Mien' in broken_part\n  Did you mean 'Mine'"),
        ("Mine = 3", "broken_part:Mine", "expected a class or a function, found int"),
    ],
)
def test_what_cannot_be_found_is_told(
    own: Path, monkeypatch: pytest.MonkeyPatch, text: str | None, name: str, message: str
) -> None:
    if text is not None:
        (own / "broken_part.py").write_text(text)
        monkeypatch.delitem(sys.modules, "broken_part", raising=False)
    with pytest.raises(PluginError) as caught:
        find("teachers", name)
    assert f"teacher '{name}': " in str(caught.value)
    assert message in str(caught.value)


def test_what_a_part_of_somebody_elses_raises_is_told_in_its_name(own: Path) -> None:
    (own / "raising_part.py").write_text("def mine(setup):\n    return setup['x']\n")
    with pytest.raises(PluginError) as caught:
        find("teachers", "raising_part:mine")({})
    assert caught.value.message == "teacher 'raising_part:mine' raised KeyError: 'x'"
    assert f"In {own / 'raising_part.py'}:2." in str(caught.value)
    assert isinstance(caught.value.__cause__, KeyError)


def test_what_it_refuses_in_our_words_is_left_as_it_is(own: Path) -> None:
    text = "from drake_screw import RecordingError\ndef mine(): raise RecordingError('no')\n"
    (own / "refusing_part.py").write_text(text)
    with pytest.raises(RecordingError, match="no"):
        find("teachers", "refusing_part:mine")()
