"""Small runs for tests that look at one, and a scenario with two objects."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from drake_screw.runs.run import new_run
from drake_screw.scenario.loader import load_scenario
from drake_screw.scenario.object_blocks import ObjectBlock
from drake_screw.scenario.schema import Scenario
from drake_screw.scenario.values import Interval

CHANGES = [
    "demonstrations.first=random",
    "objects.0.symmetry=null",
    "demonstrations.budget=2",
    "coverage.strategy=eprocess",
    "seed=0",
]


@pytest.fixture(scope="session")
def finished_run(tmp_path_factory) -> Path:
    """Pouring without symmetry, two demonstrations and rounds, not certified; do not change it."""
    folder = tmp_path_factory.mktemp("runs") / "pouring"
    for _ in new_run(load_scenario("pouring", CHANGES), folder).events():
        pass
    return folder


def two_objects(changes: Sequence[str]) -> Scenario:
    """Pouring into a bowl while a cup stands at the side, which may be turned.

    Args:
        changes: of scenario pouring; they make its regions adaptive.
    """
    one = load_scenario("pouring", changes)
    ranges = {"x": Interval(0.8, 0.95), "y": Interval(0.2, 0.5)}
    bowl = one.objects[0].model_copy(update=ranges)
    cup = ObjectBlock(
        name="cup",
        x=Interval(0.7, 0.8),
        y=Interval(-0.4, -0.4),
        yaw=Interval(-0.5, 0.5),
        z=bowl.z,
        radius=0.04,
        height=0.08,
    )
    return one.model_copy(update={"objects": (bowl, cup)})
