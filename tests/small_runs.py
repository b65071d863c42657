"""A small finished run for tests that look at one."""

from __future__ import annotations

from pathlib import Path

import pytest

from drake_screw.runs.run import new_run
from drake_screw.scenario.loader import load_scenario

CHANGES = ["demonstrations.budget=2", "coverage.strategy=eprocess", "seed=0"]


@pytest.fixture(scope="session")
def finished_run(tmp_path_factory) -> Path:
    """Scenario pouring with two demonstrations and two rounds, not certified; do not change it."""
    folder = tmp_path_factory.mktemp("runs") / "pouring"
    for _ in new_run(load_scenario("pouring", CHANGES), folder).events():
        pass
    return folder
