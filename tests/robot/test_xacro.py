"""Models written in xacro."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drake_screw.errors import ModelError
from drake_screw.robot import RobotConfig, Workcell, build_workcell
from drake_screw.robot.model_file import ModelFile, model_file
from drake_screw.robot.packages import ModelPlace

TETRAHEDRON = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
JOINTS = ("j1", "j2")
ROBOT = '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">'
LINK = f"""{ROBOT}
<xacro:macro name="segment" params="number before length">
  <link name="l${{number}}">
    <inertial><mass value="1"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><mesh filename="tri.obj"/></geometry></collision>
  </link>
  <joint name="j${{number}}" type="revolute">
    <parent link="${{before}}"/><child link="l${{number}}"/>
    <origin xyz="${{length}} 0 0"/><axis xyz="0 0 1"/>
    <limit lower="${{-pi/2}}" upper="${{pi/2}}" velocity="1" effort="1"/>
  </joint>
</xacro:macro>
</robot>
"""
ARM = f"""{ROBOT}
<xacro:arg name="length" default="0.25"/>
<xacro:include filename="$(find arm_parts)/segment.xacro"/>
<link name="base"/>
<xacro:segment number="1" before="base" length="$(arg length)"/>
<xacro:segment number="2" before="l1" length="$(arg length)"/>
</robot>
"""


@pytest.fixture
def arm(tmp_path: Path) -> RobotConfig:
    """An arm of two joints whose macro lies in a package beside its own."""
    parts = tmp_path / "arm_parts"
    parts.mkdir()
    (parts / "package.xml").write_text("<package><name>arm_parts</name></package>")
    (parts / "segment.xacro").write_text(LINK)
    own = tmp_path / "own"
    own.mkdir()
    (own / "arm.urdf.xacro").write_text(ARM)
    (own / "tri.obj").write_text(TETRAHEDRON)
    return RobotConfig(str(own / "arm.urdf.xacro"), JOINTS, "l2", (0.0, 0.0))


def read(arm: RobotConfig) -> ModelFile:
    return model_file(ModelPlace(arm.model, arm.packages), arm.xacro)


def test_a_model_in_xacro_is_expanded_with_its_arguments(arm: RobotConfig) -> None:
    """Its packages are found like others, and relative paths are seen from its file."""
    pytest.importorskip("xacro")

    def cell_of(**arguments: object) -> Workcell:
        return build_workcell(replace(arm, xacro=arguments))

    cell = cell_of()
    assert cell.arm.pose(np.zeros(2))[0, 3] == pytest.approx(0.5)
    assert cell.arm.upper == pytest.approx([np.pi / 2] * 2)
    assert cell.model_file == Path(arm.model)
    link = cell.plant.GetBodyByName("l2")
    assert len(cell.plant.GetCollisionGeometriesForBody(link)) == 1
    assert cell_of(length=0.5).arm.pose(np.zeros(2))[0, 3] == pytest.approx(1.0)


def test_its_hash_is_of_what_it_stands_for(arm: RobotConfig, tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    before = read(arm).hash
    assert read(replace(arm, xacro={"length": 0.3})).hash != before
    own = Path(arm.model)
    own.write_text(ARM.replace("<link", "<!-- a remark --><link", 1))
    assert read(arm).hash == before
    included = tmp_path / "arm_parts" / "segment.xacro"
    included.write_text(LINK.replace('velocity="1"', 'velocity="2"'))
    assert read(arm).hash != before


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (ARM.replace("arm_parts", "no_parts"), "package 'no_parts' is not found"),
        (ARM.replace("$(arg length)", "$(arg width)"), "Undefined substitution argument width"),
        (ARM.replace("xacro:segment number", "xacro:segmnt number"), "unknown macro name"),
        (ARM.replace("</robot>", ""), "not XML: no element found"),
        (ARM.replace("robot", "macros"), "expanded, it is a 'macros' and no robot"),
        (ARM.replace("segment.xacro", "gone.xacro"), "No such file"),
    ],
)
def test_what_xacro_finds_wrong_is_told(text: str, message: str, arm: RobotConfig) -> None:
    pytest.importorskip("xacro")
    Path(arm.model).write_text(text)
    with pytest.raises(ModelError, match=re.escape(message)):
        read(arm)


def test_an_argument_that_lacks_a_value_names_the_key(arm: RobotConfig) -> None:
    pytest.importorskip("xacro")
    Path(arm.model).write_text(ARM.replace("$(arg length)", "$(arg width)"))
    with pytest.raises(ModelError) as caught:
        read(arm)
    assert "xacro: {NAME: value}" in str(caught.value.remedy)
    assert read(replace(arm, xacro={"width": 1})).file == Path(arm.model)


def test_the_extra_is_named_where_xacro_is_missing(
    arm: RobotConfig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xacro", None)
    with pytest.raises(ModelError, match="is not installed") as caught:
        read(arm)
    assert "drake-screw[xacro]" in str(caught.value.remedy)


def test_arguments_need_a_model_in_xacro() -> None:
    with pytest.raises(ModelError, match=r"arguments for xacro \(length\), but the model is not"):
        model_file(ModelPlace("baxter"), {"length": 1.0})
