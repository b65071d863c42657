"""Arms to plan for: two small ones, and the one that the shared demonstrations were recorded on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_screw.demonstrations import (
    Demonstration,
    SegmentationConfig,
    demonstration_from_recording,
    read_library,
)
from drake_screw.robot import Arm

ELBOW_UP = (1.04349043096, -0.220126243062, -0.7470486437, 1.52439340796, 1.88181093154)
START = {
    "pouring": (*ELBOW_UP, -0.96870886755, -0.490873852123),
    "scooping": (*ELBOW_UP, -0.96870886755, 1.02968460387),
}


def serial_arm(links: Sequence[tuple[str, str, float]]) -> Arm:
    """Revolute joints j1, j2, ... given as (position in the link before, axis, limit +-)."""
    parts, before = ["<link name='base'/>"], "base"
    for i, (place, axis, limit) in enumerate(links, start=1):
        parts.append(
            f"<link name='l{i}'><pose relative_to='{before}'>{place} 0 0 0</pose></link>"
            f"<joint name='j{i}' type='revolute'><parent>{before}</parent><child>l{i}</child>"
            f"<axis><xyz>{axis}</xyz><limit><lower>{-limit}</lower><upper>{limit}</upper></limit>"
            "</axis></joint>"
        )
        before = f"l{i}"
    parts.append(f"<frame name='hand' attached_to='{before}'><pose>0.1 0 0.05 0 0 0</pose></frame>")
    plant = MultibodyPlant(0.0)
    text = f"<sdf version='1.9'><model name='small'>{''.join(parts)}</model></sdf>"
    Parser(plant).AddModelsFromString(text, ".sdf")
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.Finalize()
    return Arm(plant, [f"j{i + 1}" for i in range(len(links))], "hand")


@pytest.fixture(scope="session")
def seven() -> Arm:
    """A man-like arm of seven joints, about 1 m long."""
    z, y, x = "0 0 1", "0 1 0", "1 0 0"
    return serial_arm(
        [
            ("0 0 0.3", z, 1.7),
            ("0.07 0 0.1", y, 1.3),
            ("0.1 0 0", x, 1.6),
            ("0.27 0 0.07", y, 2.1),
            ("0.1 0 0", x, 1.6),
            ("0.27 0 0.01", y, 1.5),
            ("0.1 0 0", x, 1.8),
        ]
    )


@pytest.fixture(scope="session")
def planar() -> Arm:
    """Three joints about z, with links of 0.5 m and 0.4 m and an end effector 0.1 m out."""
    z = "0 0 1"
    return serial_arm([("0 0 0.2", z, 2.8), ("0.5 0 0", z, 2.6), ("0.4 0 0", z, 2.6)])


@pytest.fixture(scope="session")
def calibrated_arm(shared: Path) -> Arm:
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(shared / "reference" / "baxter_left_calibrated.sdf"))
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.Finalize()
    names = [f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2")]
    return Arm(plant, names, "left_hand")


@pytest.fixture(scope="session")
def recorded(shared: Path, calibrated_arm: Arm) -> Mapping[str, tuple[Demonstration, ...]]:
    """The demonstrations of each recorded task."""
    arm = calibrated_arm
    return {
        task: tuple(
            demonstration_from_recording(recording, arm, SegmentationConfig())
            for recording in read_library(
                shared / "demos" / task, arm.joint_names, arm.lower, arm.upper
            )
        )
        for task in START
    }


@pytest.fixture(params=START)
def task(request: pytest.FixtureRequest) -> str:
    """The recorded tasks' names."""
    return str(request.param)


@pytest.fixture
def q_start(task: str) -> np.ndarray:
    """Where the arm starts in a recorded task."""
    return np.array(START[task])
