"""Collision shapes of a robot's model that Drake would not take as they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw.errors import ModelError
from drake_screw.robot import ObjectConfig, RobotConfig, TableConfig, Workcell, build_workcell
from tests.robot.small_arms import PLANAR, sdf

DRAKE = 'xmlns:drake="http://drake.mit.edu"'
BALL = "<sphere><radius>0.03</radius></sphere>"
PLANE = "<plane><normal>0 0 1</normal><size>1 1</size></plane>"
TABLE = TableConfig(center=(0.6, 0.0), size=(0.2, 0.2), top=0.1)
BOWL = ObjectConfig("bowl", 0.05, 0.05)


def cell_of(model: Path, **surroundings: object) -> Workcell:
    robot = RobotConfig(str(model), ("p1", "p2", "p3"), "hand", (0.0, 0.0, 0.0))
    return build_workcell(robot, **surroundings)  # type: ignore[arg-type]


def sdf_with(folder: Path, **shapes: str) -> Path:
    file = folder / "small.sdf"
    file.write_text(sdf(PLANAR, shapes=shapes))
    return file


def urdf_with(folder: Path, shape: str) -> Path:
    """The links p0 to p3, the last one with a shape."""
    mass = '<mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    links = [f'<link name="base"><inertial>{mass}</inertial></link>']
    for i, before in enumerate(("base", "p1_link", "p2_link"), start=1):
        own = f"<collision><geometry>{shape}</geometry></collision>" if i == 3 else ""
        links.append(
            f'<link name="p{i}_link"><inertial>{mass}</inertial>{own}</link>'
            f'<joint name="p{i}" type="revolute"><parent link="{before}"/>'
            f'<child link="p{i}_link"/><origin xyz="0.3 0 0"/><axis xyz="0 0 1"/>'
            '<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>'
        )
    links.append('<link name="hand"/><joint name="fixed" type="fixed"><parent link="p3_link"/>')
    links.append('<child link="hand"/></joint>')
    file = folder / "small.urdf"
    file.write_text(f'<robot name="small" {DRAKE}>{"".join(links)}</robot>')
    return file


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ("<box><size>0 0.1 0.1</size></box>", "a box with size 0 0.1 0.1"),
        ("<box><size>0.1\n-0.1 0.1</size></box>", "a box with size 0.1 -0.1 0.1"),
        ("<box/>", "a box without size"),
        ("<sphere><radius>0</radius></sphere>", "a sphere with radius 0"),
        ("<sphere><radius>1e9</radius></sphere>", "a sphere with radius 1e9, over 1,000 m"),
        ("<capsule><radius>0.1</radius></capsule>", "a capsule without length"),
        ("<cylinder><radius>0.1</radius><length>0</length></cylinder>", "cylinder with length 0"),
        ("<ellipsoid><radii>0.1 nan 1</radii></ellipsoid>", "an ellipsoid with radii 0.1 nan 1"),
        (f"<drake:capsule {DRAKE}><radius>0</radius></drake:capsule>", "capsule with radius 0"),
        ("<cone><radius>1</radius><length>1</length></cone>", "a cone, which Drake leaves out"),
    ],
)
def test_a_shape_that_would_be_replaced_or_left_out_is_refused(
    shape: str, message: str, tmp_path: Path
) -> None:
    """The reader of SDF makes a box of 1 m of one without a size, and goes on without a cone."""
    model = sdf_with(tmp_path, p3_link=shape)
    with pytest.raises(ModelError, match="'p3_link_hull' of link 'p3_link' is ") as caught:
        cell_of(model)
    assert message in str(caught.value)
    assert caught.value.file == model
    assert caught.value.remedy


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ('<box size="0 0.1 0.1"/>', "a box with size 0 0.1 0.1"),
        ('<cylinder radius="0.1"/>', "a cylinder without length"),
        ('<drake:ellipsoid a="1" b="0" c="1"/>', "an ellipsoid with b 0"),
    ],
)
def test_a_shape_without_a_size_in_urdf_is_refused(
    shape: str, message: str, tmp_path: Path
) -> None:
    model = urdf_with(tmp_path, shape)
    with pytest.raises(ModelError, match="a collision shape of link 'p3_link' is") as caught:
        cell_of(model)
    assert message in str(caught.value)
    assert caught.value.file == model


def test_other_shapes_are_taken(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
    for shape in (
        "<ellipsoid><radii>0.1 0.2 0.1</radii></ellipsoid>",
        f"<drake:ellipsoid {DRAKE}><a>0.1</a><b>0.2</b><c>0.1</c></drake:ellipsoid>",
        f"<drake:capsule {DRAKE}><radius>0.1</radius><length>0.1</length></drake:capsule>",
        "<mesh><uri>a.obj</uri><scale>0.1 -0.2 0.3</scale></mesh>",
        "<empty/>",
    ):
        cell = cell_of(sdf_with(tmp_path, p3_link=shape))
        link = cell.plant.GetBodyByName("p3_link")
        count = len(cell.plant.GetCollisionGeometriesForBody(link))
        assert count == (0 if shape == "<empty/>" else 1)
    cell_of(urdf_with(tmp_path, '<drake:ellipsoid a="1" b="1" c="1"/>'))


def test_what_drake_ends_the_program_for_is_an_error(tmp_path: Path) -> None:
    """Of MJCF, which is not looked at beforehand."""
    file = tmp_path / "no_mass.xml"
    file.write_text(
        "<mujoco model='small'><worldbody><body name='base'>"
        "<inertial pos='0 0 0' mass='0' diaginertia='0 0 0'/></body></worldbody></mujoco>"
    )
    with pytest.raises(ModelError, match=r"no_mass.xml: Drake cannot read this model: .*mass > 0"):
        cell_of(file)


def test_models_that_directives_add_are_looked_at(tmp_path: Path) -> None:
    small = urdf_with(tmp_path, '<box size="0 1 1"/>')
    outer = tmp_path / "outer.dmd.yaml"
    outer.write_text(f"directives:\n- add_model: {{name: small, file: file://{small}}}\n")
    with pytest.raises(ModelError, match="is a box with size 0 1 1") as caught:
        cell_of(outer)
    assert caught.value.file == small


@pytest.mark.parametrize("link", ["base", "p3_link"])
def test_a_plane_beside_anything_but_balls_is_refused(link: str, tmp_path: Path) -> None:
    model = sdf_with(tmp_path, **{link: PLANE})
    with pytest.raises(ModelError, match=f"link '{link}' is a plane") as caught:
        cell_of(model, objects=(BOWL,))
    assert caught.value.file == model
    assert "the cylinder of 'bowl'" in str(caught.value)
    assert "a large box in place of the plane" in str(caught.value)


def test_a_plane_beside_the_table_that_the_arm_carries_it_to_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"'p3_link' is a plane.* the box of 'table'"):
        cell_of(sdf_with(tmp_path, p3_link=PLANE), table=TABLE)
    cell_of(sdf_with(tmp_path, base=PLANE), table=TABLE)


def test_a_plane_beside_balls_is_looked_at(tmp_path: Path) -> None:
    text = sdf(PLANAR, shapes={"base": PLANE, "p3_link": BALL})
    model = tmp_path / "small.sdf"
    none = np.empty((0, 4, 4))
    for height, touches in ((0.46, False), (0.48, True)):
        own = f"<collision name='base_hull'><pose>0 0 {height} 0 0 0</pose>"
        model.write_text(text.replace("<collision name='base_hull'>", own))
        assert cell_of(model).collides(np.zeros((1, 3)), none)[0] == touches
