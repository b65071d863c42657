"""The scenario that a command line describes."""

from __future__ import annotations

from pathlib import Path

import pytest

from drake_screw.commands.options import chosen_scenario
from drake_screw.errors import ScenarioError


def test_other_keys_of_a_teacher_go_with_a_folder_of_demonstrations(tmp_path: Path) -> None:
    changes = ["teacher.choose=covers_most", "seed=3"]
    scenario = chosen_scenario("pouring", changes, demonstrations=tmp_path)
    assert (scenario.teacher.kind, scenario.teacher.folder) == ("recorded", tmp_path)
    assert scenario.teacher.choose == "covers_most"
    assert scenario.seed == 3
    assert scenario.teacher.motion is None
    assert chosen_scenario("pouring", demonstrations=tmp_path).teacher.choose == "nearest"


@pytest.mark.parametrize("name", ["demos #2", "my: demos", "Ann's", "{a}, [b]", "a\\nb", "é"])
def test_a_folder_of_demonstrations_may_have_any_name(tmp_path: Path, name: str) -> None:
    (tmp_path / name).mkdir()
    scenario = chosen_scenario("pouring", demonstrations=tmp_path / name)
    assert scenario.teacher.folder == tmp_path / name


def test_another_teacher_beside_a_folder_of_demonstrations_is_refused(tmp_path: Path) -> None:
    changes = ["teacher.kind=simulated", "teacher.motion=pouring"]
    with pytest.raises(ScenarioError, match=r"teacher\.folder: a simulated teacher has no folder"):
        chosen_scenario("pouring", changes, demonstrations=tmp_path)
