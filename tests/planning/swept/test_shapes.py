"""Collision shapes that cannot be looked at along paths."""

from __future__ import annotations

from pathlib import Path

import pytest

from drake_screw.errors import ModelError
from drake_screw.planning.swept.shapes import cell_of
from drake_screw.robot import MeshShape, ObstacleConfig, PlacedShape, RobotConfig, build_workcell
from tests.robot.small_arms import PLANAR, sdf


def test_a_flat_mesh_is_refused(tmp_path: Path) -> None:
    """On a link, and as an obstacle; each by the mesh's file and by whose it is."""
    sheet, model = tmp_path / "sheet.obj", tmp_path / "small.sdf"
    sheet.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n")
    robot = RobotConfig(str(model), tuple(joint.name for joint in PLANAR), "hand", (0.0,) * 3)
    model.write_text(sdf(PLANAR, shapes={"p3_link": "<mesh><uri>sheet.obj</uri></mesh>"}))
    with pytest.raises(ModelError, match="flat, and a collision shape of 'p3_link'") as caught:
        cell_of(build_workcell(robot))
    assert caught.value.file == sheet
    assert "a thin box" in str(caught.value)
    model.write_text(sdf(PLANAR))
    wall = ObstacleConfig("wall", PlacedShape(MeshShape(sheet)))
    with pytest.raises(ModelError, match="flat, and a collision shape of 'wall'") as caught:
        cell_of(build_workcell(robot, obstacles=(wall,)))
    assert caught.value.file == sheet
