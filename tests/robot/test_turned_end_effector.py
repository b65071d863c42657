"""An end effector's frame may be turned, and then everything goes by the turned one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pydrake.math import RollPitchYaw

from drake_screw.errors import ModelError
from drake_screw.robot import (
    PlacedShape,
    RobotConfig,
    SphereShape,
    ToolConfig,
    build_workcell,
)
from tests.robot.small_arms import SEVEN, sdf

TURN = (0.3, np.pi / 2.0, -0.2)
NAMES = tuple(joint.name for joint in SEVEN)


@pytest.fixture
def config(tmp_path: Path) -> RobotConfig:
    file = tmp_path / "small.sdf"
    file.write_text(sdf(SEVEN))
    return RobotConfig(str(file), NAMES, "hand", (0.1,) * 7)


def test_the_arm_goes_by_the_turned_frame(config: RobotConfig) -> None:
    plain = build_workcell(config).arm
    turned = build_workcell(replace(config, end_effector_rotation=TURN)).arm
    q = np.linspace(-1.0, 1.0, 7)
    R = RollPitchYaw(TURN).ToRotationMatrix().matrix()
    assert turned.pose(q)[:3, 3] == pytest.approx(plain.pose(q)[:3, 3], abs=1e-12)
    assert turned.pose(q)[:3, :3] == pytest.approx(plain.pose(q)[:3, :3] @ R, abs=1e-12)
    assert turned.screw_chain().pose(q) == pytest.approx(turned.pose(q), abs=1e-9)
    assert turned.end_effector == "hand_turned"


def test_a_tool_may_be_fixed_to_it(config: RobotConfig) -> None:
    ball = ToolConfig("hand_turned", PlacedShape(SphereShape(0.01)), xyz=(0.0, 0.0, 0.2))
    workcell = build_workcell(replace(config, end_effector_rotation=TURN, tool=ball))
    X_ET = workcell.arm.held("hand_turned")
    assert pytest.approx(np.eye(4), abs=1e-12) == X_ET
    assert workcell.tool is not None


def test_a_name_that_is_taken_is_refused(config: RobotConfig, tmp_path: Path) -> None:
    extra = "<frame name='hand_turned' attached_to='a7_link'/>"
    (tmp_path / "small.sdf").write_text(sdf(SEVEN, extra=extra))
    with pytest.raises(ModelError, match="has a frame 'hand_turned'"):
        build_workcell(replace(config, end_effector_rotation=TURN))
