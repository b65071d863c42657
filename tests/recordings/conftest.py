"""What recordings are understood with, and one of people."""

from __future__ import annotations

from pathlib import Path

import pytest

from drake_screw import Setup, load_scenario
from drake_screw.demonstrations import Recording


@pytest.fixture(scope="session")
def setup() -> Setup:
    return Setup(load_scenario("pouring"))


@pytest.fixture(scope="session")
def demo(setup: Setup, shared: Path) -> Recording:
    return setup.recorder.read(shared / "demos" / "pouring" / "demo_01")
