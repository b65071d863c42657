"""Meshes that Drake does not read: converted, or left out and told of."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Convex

from drake_screw.errors import ModelError
from drake_screw.files import file_hash
from drake_screw.robot import (
    MeshShape,
    PlacedShape,
    RobotConfig,
    Workcell,
    build_workcell,
)
from drake_screw.robot.mesh_files import MOST_FACES, hull_file, look_file
from drake_screw.robot.model_file import ModelFile, model_file
from drake_screw.robot.model_meshes import LARGE
from drake_screw.robot.packages import ModelPlace
from drake_screw.said_once import warn_once
from drake_screw.typing import Array
from tests.robot.small_arms import PLANAR, sdf

CORNERS = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.3]], dtype=float)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
OFF = "OFF\n4 4 0\n" + "".join(
    [f"{x} {y} {z}\n" for x, y, z in CORNERS] + [f"3 {a} {b} {c}\n" for a, b, c in FACES]
)
DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse>
<color>0.2 0.4 0.6 1</color></diffuse></lambert></technique></profile_COMMON></effect>
</library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="f" count="12">0 0 0 10 0 0 0 20 0 0 0 30</float_array>
<technique_common><accessor source="#f" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="4" material="mm"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node id="n"><translate>100 0 0</translate>
<instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="mm" target="#m"/></technique_common></bind_material>
</instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>
"""


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))


def stl(corners: Array = CORNERS) -> str:
    lines = ["solid small"]
    for face in FACES:
        points = "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners[face])
        lines.append(f"facet normal 0 0 0\nouter loop\n{points}endloop\nendfacet")
    return "\n".join([*lines, "endsolid small"])


def hull_of(file: Path) -> Array:
    """Corners of a mesh's convex hull as Drake has it, in order."""
    hull = Convex(str(file), 1.0).GetConvexHull()
    corners = np.array([hull.vertex(i) for i in range(hull.num_vertices())]).round(6) + 0.0
    return corners[np.lexsort(corners.T)]


def arm(folder: Path, mesh: str, *, look: str | None = None) -> RobotConfig:
    """A planar arm whose last link has a mesh."""
    text = sdf(PLANAR, shapes={"p3_link": f"<mesh><uri>{mesh}</uri></mesh>"})
    if look is not None:
        shape = f"<geometry><mesh><uri>{look}</uri></mesh></geometry>"
        text = text.replace("<collision", f"<visual name='v'>{shape}</visual><collision", 1)
    (folder / "arm.sdf").write_text(text)
    return RobotConfig(str(folder / "arm.sdf"), ("p1", "p2", "p3"), "hand", (0.0, 0.0, 0.0))


def read(robot: RobotConfig) -> ModelFile:
    return model_file(ModelPlace(robot.model))


def shapes(cell: Workcell) -> int:
    return len(cell.plant.GetCollisionGeometriesForBody(cell.plant.GetBodyByName("p3_link")))


@pytest.mark.parametrize(
    ("name", "text"), [("small.STL", stl()), ("small.off", OFF)], ids=["stl", "off"]
)
def test_a_mesh_is_converted_to_its_hull(name: str, text: str, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    (tmp_path / name).write_text(text)
    converted = hull_file(tmp_path / name)
    assert np.allclose(hull_of(converted), CORNERS[np.lexsort(CORNERS.T)], atol=1e-7)
    made = converted.stat().st_mtime_ns
    assert hull_file(tmp_path / name) == converted
    assert converted.stat().st_mtime_ns == made
    assert not list(tmp_path.glob("*.obj"))
    (tmp_path / name).write_text(text.replace("0.2", "0.25"))
    assert hull_file(tmp_path / name) != converted


DAMAGE: dict[str, Callable[[Path], object]] = {
    "cut off": lambda file: file.write_bytes(file.read_bytes()[:-70]),
    "changed": lambda file: file.write_bytes(file.read_bytes().replace(b"0.", b"7.", 1)),
    "empty": lambda file: file.write_bytes(b""),
    "of zeros": lambda file: file.write_bytes(bytes(file.stat().st_size)),
    "a folder": lambda file: (file.unlink(), file.mkdir(), (file / "x").touch()),
}


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=list(DAMAGE))
def test_a_damaged_file_in_the_cache_is_noticed_told_and_made_again(
    damage: Callable[[Path], object], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    pytest.importorskip("collada")
    (tmp_path / "small.dae").write_text(DAE)
    hull, look = hull_file(tmp_path / "small.dae"), look_file(tmp_path / "small.dae")
    model = read(arm(tmp_path, "small.dae", look="small.dae")).read
    for file in (hull, look, look.with_suffix(".mtl"), model):
        right = file.read_bytes()
        damage(file)
        caplog.clear()
        assert hull_file(tmp_path / "small.dae") == hull
        assert look_file(tmp_path / "small.dae") == look
        assert read(arm(tmp_path, "small.dae", look="small.dae")).read == model
        assert file.read_bytes() == right
        assert caplog.messages == [f"{file}: it is damaged, and made again"]
        warn_once.cache_clear()


def test_a_file_where_the_cache_has_a_folder_makes_way(tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    (tmp_path / "small.stl").write_text(stl())
    hull = hull_file(tmp_path / "small.stl")
    shutil.rmtree(hull.parent)
    hull.parent.write_bytes(b"")
    assert hull_file(tmp_path / "small.stl") == hull
    assert hull.is_file()


def test_collada_counts_in_its_unit_with_its_axes_as_they_are(tmp_path: Path) -> None:
    """As ROS, Gazebo and Pinocchio do, whatever up axis it states."""
    pytest.importorskip("trimesh")
    pytest.importorskip("collada")
    (tmp_path / "small.dae").write_text(DAE)
    moved = CORNERS + np.array([1.0, 0.0, 0.0])
    found = hull_of(hull_file(tmp_path / "small.dae"))
    assert np.allclose(found, moved[np.lexsort(moved.T)], atol=1e-7)
    look = look_file(tmp_path / "small.dae")
    assert "Kd 0.2000 0.4000 0.6000" in look.with_suffix(".mtl").read_text()
    assert f"mtllib {look.with_suffix('.mtl').name}" in look.read_text()


def test_gltf_in_one_file_is_turned_as_drake_turns_gltf(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.Trimesh(CORNERS, FACES)
    mesh.export(tmp_path / "small.glb")
    for name, content in mesh.export(file_type="gltf").items():
        (tmp_path / name).write_bytes(content)
    drake = hull_of(tmp_path / "model.gltf")
    assert np.allclose(hull_of(hull_file(tmp_path / "small.glb")), drake, atol=1e-6)


def test_a_look_of_many_triangles_is_coarsened(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.5)
    assert len(ball.faces) > MOST_FACES
    ball.export(tmp_path / "ball.stl")
    lines = look_file(tmp_path / "ball.stl").read_text().splitlines()
    faces = sum(line.startswith("f ") for line in lines)
    assert MOST_FACES / 4 < faces <= MOST_FACES
    corners = np.array([line.split()[1:] for line in lines if line.startswith("v ")], dtype=float)
    assert np.linalg.norm(corners, axis=1) == pytest.approx(0.5, abs=0.01)


def test_a_robot_with_such_meshes_is_planned_with_their_hulls(tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    (tmp_path / "small.stl").write_text(stl())
    robot = arm(tmp_path, "small.stl", look="small.stl")
    cell = build_workcell(robot)
    assert shapes(cell) == 1
    assert cell.model.left_out == ()
    assert cell.model_file == Path(robot.model)
    before = read(robot).hash
    (tmp_path / "small.stl").write_text(stl(2.0 * CORNERS))
    assert read(robot).hash != before


def test_obstacles_and_tools_may_be_such_meshes(tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    (tmp_path / "small.stl").write_text(stl())
    shape = PlacedShape(MeshShape(tmp_path / "small.stl", 2.0))
    assert shape.corners().max(axis=0) == pytest.approx([0.2, 0.4, 0.6])
    (tmp_path / "small.stl").write_text(stl(CORNERS * [1.0, 1.0, 0.0]))
    with pytest.raises(ModelError, match="this mesh is flat"):
        shape.corners()
    (tmp_path / "small.stl").write_text(stl())
    with pytest.raises(
        ModelError, match="10000 times as large as in the file, goes as far as 3e"
    ) as e:
        PlacedShape(MeshShape(tmp_path / "small.stl", 1e4)).corners()
    assert "0.001 if they are in mm" in str(e.value)


def test_a_large_obj_file_is_coarsened_to_be_looked_at(tmp_path: Path) -> None:
    """Pages hold all meshes; as a collision shape it stays as it is."""
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=6, radius=0.05)
    (tmp_path / "ball.obj").write_text(trimesh.exchange.obj.export_obj(ball, digits=8))
    assert (tmp_path / "ball.obj").stat().st_size > LARGE
    model = read(arm(tmp_path, "ball.obj", look="ball.obj"))
    text = model.read.read_text()
    assert f"<uri>{tmp_path / 'ball.obj'}</uri>" in text
    (look,) = (tmp_path / "cache").glob("drake_screw/meshes/*.obj")
    assert f"<uri>{look}</uri>" in text
    assert look.stat().st_size < LARGE / 2
    assert model.hash == file_hash(model.file)


def test_a_model_that_drake_reads_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "small.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
    model = read(arm(tmp_path, "small.obj"))
    assert model.read == model.file
    assert not (tmp_path / "cache").exists()


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("gone.obj", None, "does not exist"),
        ("small.stl", "solid small\nendsolid small", "cannot be read|holds no triangles"),
        ("small.stl", stl(CORNERS * [1.0, 1.0, 0.0]), "is flat"),
        ("small.step", "ISO-10303-21;", "is of a kind .*step.* that neither Drake reads"),
    ],
)
def test_a_shape_whose_mesh_cannot_be_had_is_left_out_with_a_note(
    name: str, text: str | None, reason: str, tmp_path: Path
) -> None:
    pytest.importorskip("trimesh")
    if text is not None:
        (tmp_path / name).write_text(text)
    cell = build_workcell(arm(tmp_path, name, look="gone_too.obj"))
    assert shapes(cell) == 0
    assert cell.model.incomplete == ("p3_link",)
    shape, look = cell.model.left_out if name != "gone.obj" else cell.model.left_out[::-1]
    if shape.role == "visual":
        shape, look = look, shape
    assert (shape.role, shape.link, shape.mesh) == ("collision", "p3_link", name)
    with pytest.raises(AssertionError, match=reason):
        raise AssertionError(shape.reason)
    assert look.mesh == "gone_too.obj"
    assert str(shape).startswith(f"link 'p3_link': the mesh '{name}' ")


def test_the_extra_is_named_where_it_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "trimesh", None)
    (tmp_path / "small.stl").write_text(stl())
    with pytest.raises(ModelError, match=r"pip install 'drake-screw\[meshes\]'"):
        hull_file(tmp_path / "small.stl")
    assert read(arm(tmp_path, "small.stl")).incomplete == ("p3_link",)


def test_a_missing_texture_or_material_is_no_matter(tmp_path: Path) -> None:
    materials = (
        "<material name='a'><texture filename='gone.png'/></material>",
        "<material name='b'><texture filename='package://no_such/a.png'/></material>",
        "<material name='never_defined'/>",
    )
    looks = "".join(
        f"<visual><geometry><box size='1 1 1'/></geometry>{text}</visual>" for text in materials
    )
    file = tmp_path / "arm.urdf"
    file.write_text(
        f"<robot name='arm'><link name='base'/><link name='hand'>{looks}</link>"
        "<joint name='j' type='revolute'><parent link='base'/><child link='hand'/>"
        "<axis xyz='0 0 1'/><limit lower='-1' upper='1' velocity='1' effort='1'/></joint></robot>"
    )
    cell = build_workcell(RobotConfig(str(file), ("j",), "hand", (0.0,)))
    assert cell.model.left_out == ()


def test_materials_of_one_name_are_told_apart(tmp_path: Path) -> None:
    """Drake refuses a second definition; published models have them."""
    looks = "".join(
        f"<visual><geometry><box size='1 1 1'/></geometry><material name='grey'>"
        f"<color rgba='{c} {c} {c} 1'/></material></visual>"
        for c in (0.3, 0.5, 0.3)
    )
    file = tmp_path / "arm.urdf"
    file.write_text(
        f"<robot name='arm'><link name='base'/><link name='hand'>{looks}</link>"
        "<joint name='j' type='revolute'><parent link='base'/><child link='hand'/>"
        "<axis xyz='0 0 1'/><limit lower='-1' upper='1' velocity='1' effort='1'/></joint></robot>"
    )
    cell = build_workcell(RobotConfig(str(file), ("j",), "hand", (0.0,)))
    assert cell.model.read != file
    assert cell.model.read.read_text().count('name="grey"') == 2


def test_oddities_of_published_models_are_no_matter(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """No name, fixed joints that follow, joints that follow fixed ones, motors of none."""
    limits = "<axis xyz='0 0 1'/><limit lower='-1' upper='1' velocity='1' effort='1'/>"
    joints = "".join(
        f"<link name='{name}'/><joint name='{name}_joint' type='{kind}'><parent link='base'/>"
        f"<child link='{name}'/>{limits}{mimic}</joint>"
        f"<transmission name='{name}'><type>transmission_interface/SimpleTransmission</type>"
        f"<joint name='{motor}'/><actuator name='{name}_motor'/></transmission>"
        for name, kind, mimic, motor in (
            ("hand", "revolute", "", "hand_joint"),
            ("fixed", "fixed", "<mimic joint='hand_joint'/>", "gone_joint"),
            ("left", "revolute", "<mimic joint='fixed_joint'/>", "gone_joint"),
            ("right", "revolute", "<mimic joint='hand_joint'/>", "gone_joint"),
        )
    )
    look = "<visual><geometry><mesh filename='package:///a.obj'/></geometry></visual>"
    file = tmp_path / "arm.urdf"
    file.write_text(f"<robot><link name='base'>{look}</link>{joints}</robot>")
    cell = build_workcell(RobotConfig(str(file), ("hand_joint",), "hand", (0.0,)))
    assert [s.reason for s in cell.model.left_out] == ["is at an address that leads nowhere"]
    assert cell.model.read.read_text().count("<mimic") == 1
    assert cell.model.read.read_text().count("<transmission") == 1
    assert "'left_joint' is to follow 'fixed_joint', which does not move" in caplog.text
