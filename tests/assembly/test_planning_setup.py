"""The planner that a scenario describes."""

from __future__ import annotations

import pytest

from drake_screw import Setup, load_scenario
from drake_screw.errors import ScenarioError


def test_redundancy_is_the_scenario_s() -> None:
    assert Setup(load_scenario("pouring")).batch_planner.redundancy == "least_norm"
    away = load_scenario("pouring", ["planner.redundancy=away_from_limits"])
    assert Setup(away).batch_planner.redundancy == "away_from_limits"


@pytest.mark.parametrize(
    ("key", "choices"),
    [("redundancy", "least_norm, away_from_limits"), ("approach", "screw, free")],
)
def test_what_there_is_not_is_refused_with_the_choices(key: str, choices: str) -> None:
    with pytest.raises(ScenarioError) as refused:
        load_scenario("pouring", [f"planner.{key}=middle"])
    assert f"planner.{key}: there is no 'middle'" in str(refused.value)
    assert f"Choices: {choices}" in str(refused.value)
