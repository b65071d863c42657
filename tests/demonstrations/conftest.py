"""The arm that the shared demonstrations were recorded on."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_screw.robot import Arm


@pytest.fixture(scope="session")
def calibrated_arm(shared: Path) -> Arm:
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(shared / "reference" / "baxter_left_calibrated.sdf"))
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.Finalize()
    names = [f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2")]
    return Arm(plant, names, "left_hand")
