"""Packages that models speak of, found where they lie."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_screw.errors import ModelError
from drake_screw.robot import RobotConfig, Workcell, build_workcell
from drake_screw.robot.packages import Packages, package_name, split_address
from drake_screw.robot.parts import add_robot
from drake_screw.scenario.loader import dump_scenario, load_scenario
from drake_screw.scenario.reference_page import MINIMAL
from tests.robot.small_arms import PLANAR, sdf

TETRAHEDRON = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
JOINTS = ("p1", "p2", "p3")


@pytest.fixture(autouse=True)
def _nothing_set(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)


def package(folder: Path, name: str | None = None) -> Path:
    """A package with a mesh, named as its folder or otherwise; returns its folder."""
    (folder / "meshes").mkdir(parents=True)
    (folder / "meshes" / "tri.obj").write_text(TETRAHEDRON)
    text = f"<package>\n  <!-- <name>old</name> -->\n  <name> {name or folder.name} </name>\n"
    (folder / "package.xml").write_text(f"{text}</package>\n")
    return folder


def model(file: Path, address: str) -> Path:
    """A planar arm whose last link has a mesh."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(sdf(PLANAR, shapes={"p3_link": f"<mesh><uri>{address}</uri></mesh>"}))
    return file


def cell_of(file: Path | str, **packages: Path) -> Workcell:
    return build_workcell(
        RobotConfig(str(file), JOINTS, "hand", (0.0, 0.0, 0.0), packages=packages)
    )


def shaped(cell: Workcell) -> bool:
    link = cell.plant.GetBodyByName("p3_link")
    return len(cell.plant.GetCollisionGeometriesForBody(link)) == 1


@pytest.mark.parametrize("scheme", ["package", "model"])
@pytest.mark.parametrize(
    ("folder", "name"), [("my_robot", None), ("robot-main", "my_robot"), ("my_robot", "other")]
)
def test_the_package_around_a_model_is_found(
    scheme: str, folder: str, name: str | None, tmp_path: Path
) -> None:
    """By the name in package.xml, or that of its folder."""
    root = package(tmp_path / folder, name)
    file = model(root / "urdf" / "deep" / "arm.sdf", f"{scheme}://my_robot/meshes/tri.obj")
    assert shaped(cell_of(file))


@pytest.mark.parametrize("folder", ["parts", "parts-1.0"])
def test_packages_beside_are_found(folder: str, tmp_path: Path) -> None:
    package(tmp_path / "src" / folder, "parts")
    file = package(tmp_path / "src" / "my_robot") / "urdf" / "arm.sdf"
    assert shaped(cell_of(model(file, "package://parts/meshes/tri.obj")))


def test_a_folder_without_package_xml_counts_by_its_parts(tmp_path: Path) -> None:
    package(tmp_path / "parts")
    (tmp_path / "parts" / "package.xml").unlink()
    (tmp_path / "notes").mkdir()
    file = model(tmp_path / "own" / "arm.sdf", "package://parts/meshes/tri.obj")
    assert shaped(cell_of(file))
    assert Packages(near=file).find("notes") is None


def test_packages_of_the_environment_are_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package(tmp_path / "ws" / "src" / "group" / "robot_v2", "in_workspace")
    package(tmp_path / "prefix" / "share" / "in_prefix")
    package(tmp_path / "site" / "cmeel.prefix" / "share" / "in-python", "in_python")
    package(tmp_path / "site" / "plain")
    monkeypatch.setenv("ROS_PACKAGE_PATH", os.pathsep.join(["/nowhere", f"{tmp_path}/ws/src"]))
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "prefix"))
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    found = {"in_workspace": "robot_v2", "in_prefix": "in_prefix", "plain": "plain"}
    found |= {"in_python": "in-python", "in-python": "in-python"}
    for name, folder in found.items():
        path = Packages().find(name)
        assert path is not None
        assert path.name == folder
        file = model(tmp_path / "elsewhere" / "arm.sdf", f"package://{name}/meshes/tri.obj")
        assert shaped(cell_of(file))
    assert Packages().find("..") is None


def test_what_is_given_comes_first(tmp_path: Path) -> None:
    package(tmp_path / "my_robot")
    given = package(tmp_path / "mine", "whatever")
    file = model(tmp_path / "my_robot" / "arm.sdf", "package://my_robot/meshes/own.obj")
    (given / "meshes" / "own.obj").write_text(TETRAHEDRON)
    assert shaped(cell_of(file, my_robot=given))


def test_a_package_that_is_not_found_is_named_with_the_remedy(tmp_path: Path) -> None:
    file = model(tmp_path / "arm.sdf", "package://no_such/meshes/tri.obj")
    with pytest.raises(ModelError, match="package 'no_such' is not found") as caught:
        cell_of(file)
    assert caught.value.file == file
    remedy = str(caught.value.remedy)
    assert "packages: {no_such: path/of/its/folder}" in remedy
    assert "above and beside the model's file, in ROS_PACKAGE_PATH (not set)" in remedy


def test_a_given_folder_has_to_exist(tmp_path: Path) -> None:
    file = model(tmp_path / "arm.sdf", "package://my_robot/meshes/tri.obj")
    with pytest.raises(ModelError, match=r"package 'my_robot' does not exist: .*gone"):
        cell_of(file, my_robot=tmp_path / "gone")


def test_kinematics_alone_need_no_meshes(tmp_path: Path) -> None:
    file = model(tmp_path / "arm.sdf", "package://no_such/meshes/tri.obj")
    plant = MultibodyPlant(0.0)
    add_robot(Parser(plant), RobotConfig(str(file), JOINTS, "hand", (0.0,) * 3))
    assert plant.HasJointNamed("p3")


def test_packages_of_included_models_are_found(tmp_path: Path) -> None:
    root = package(tmp_path / "inner_robot")
    inner = model(root / "arm.sdf", "package://inner_robot/meshes/tri.obj")
    outer = tmp_path / "outer" / "cell.dmd.yaml"
    outer.parent.mkdir()
    outer.write_text(
        "directives:\n# - add_model: {name: no, file: package://not_there/arm.sdf}\n"
        f"- add_model:\n    name: arm\n    file: package://inner_robot/{inner.name}\n"
    )
    assert shaped(cell_of(outer))


def test_a_model_may_be_named_by_its_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = package(tmp_path / "my_robot")
    file = model(root / "urdf" / "arm.sdf", "package://my_robot/meshes/tri.obj")
    address = "package://my_robot/urdf/arm.sdf"
    assert cell_of(address, my_robot=root).model_file == file
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    assert cell_of(address).model_file == file
    with pytest.raises(ModelError, match=r"no such file: 'package://my_robot/urdf/leg\.sdf'"):
        cell_of("package://my_robot/urdf/leg.sdf")
    with pytest.raises(ModelError, match="package 'yours' is not found"):
        cell_of("package://yours/urdf/arm.sdf")


def test_folders_in_a_scenario_are_relative_to_it(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    text = MINIMAL.replace(
        "  model: baxter\n",
        "  model: package://my_robot/a.urdf\n  packages: {my_robot: ../there}\n",
    )
    file.write_text(text)
    scenario = load_scenario(file)
    assert scenario.robot.model == "package://my_robot/a.urdf"
    assert scenario.robot.packages == {"my_robot": tmp_path.parent / "there"}
    copy = tmp_path / "sub" / "copy.yaml"
    copy.parent.mkdir()
    copy.write_text(dump_scenario(scenario))
    assert load_scenario(copy) == scenario


def test_addresses_and_names() -> None:
    assert split_address("model://a/b%20c/d.obj") == ("a", "b c/d.obj")
    assert split_address("meshes/a.obj") is None
    assert package_name(Path("/nowhere")) is None
