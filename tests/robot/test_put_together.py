"""Meshes of models that others are put together of: directives add them, an SDF includes them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drake_screw.robot import RobotConfig, Workcell, build_workcell
from drake_screw.robot.model_file import ModelFile, model_file
from drake_screw.robot.packages import ModelPlace
from tests.robot.small_arms import PLANAR, sdf
from tests.robot.test_mesh_files import stl

LARGE = np.array([[0, 0, 0], [0.4, 0, 0], [0, 0.4, 0], [0, 0, 0.4]], dtype=float)
ARM = sdf(PLANAR, shapes={"p3_link": "<mesh><uri>package://parts/meshes/link.{}</uri></mesh>"})


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))


def parts(folder: Path, suffix: str = "stl") -> Path:
    """A package with an arm whose last link has a mesh, and a folder of it as SDF includes it."""
    package = folder / "parts"
    for name in ("meshes", "arm"):
        (package / name).mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>parts</name></package>")
    (package / "arm" / "one.sdf").write_text(ARM.format(suffix))
    (package / "arm" / "model.config").write_text(
        "<model><name>arm</name><sdf version='1.9'>one.sdf</sdf></model>"
    )
    return package


def added(folder: Path, package: Path) -> Path:
    file = folder / "robot.dmd.yaml"
    file.write_text(
        "directives:\n- add_model:\n    name: arm\n    file: package://parts/arm/one.sdf  # arm\n"
        "- add_weld: {parent: world, child: 'arm::base', X_PC: {rotation: !Rpy {deg: [0, 0, 0]}}}\n"
    )
    return file


def added_twice_over(folder: Path, package: Path) -> Path:
    added(package, package)
    file = folder / "all.dmd.yaml"
    file.write_text(
        "directives:\n- add_model_instance: {name: left}\n"
        '- add_directives: {file: "package://parts/robot.dmd.yaml", model_namespace: left}\n'
    )
    return file


def included(folder: Path, package: Path) -> Path:
    return _including(folder, "model://parts/arm")


def included_by_path(folder: Path, package: Path) -> Path:
    return _including(folder, "parts/arm")


def _including(folder: Path, address: str) -> Path:
    file = folder / "robot.sdf"
    file.write_text(
        "<sdf version='1.9'><model name='robot'>"
        f"<include merge='true'><uri>{address}</uri><name>arm</name></include></model></sdf>"
    )
    return file


WAYS = [added, added_twice_over, included, included_by_path]
Way = Callable[[Path, Path], Path]


def robot(file: Path, package: Path) -> RobotConfig:
    start = (0.0, 0.0, 0.0)
    given = {"parts": package}
    base = "world" if file.suffix == ".yaml" else "base"
    return RobotConfig(str(file), ("p1", "p2", "p3"), "hand", start, base, packages=given)


def read(file: Path, package: Path) -> ModelFile:
    return model_file(ModelPlace(str(file), {"parts": package}))


def shapes(cell: Workcell) -> int:
    plant, inspector = cell.plant, cell.scene_graph.model_inspector()
    link = plant.GetBodyByName("p3_link")
    return len(inspector.GetGeometries(plant.GetBodyFrameIdOrThrow(link.index())))


@pytest.mark.parametrize("way", WAYS)
def test_a_mesh_that_drake_does_not_read_is_converted(way: Way, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    package = parts(tmp_path)
    (package / "meshes" / "link.stl").write_text(stl(LARGE))
    file = way(tmp_path, package)
    cell = build_workcell(robot(file, package))
    assert shapes(cell) == 1
    before = read(file, package)
    assert (before.file, before.left_out) == (file, ())
    (package / "meshes" / "link.stl").write_text(stl(2.0 * LARGE))
    assert read(file, package).hash != before.hash


@pytest.mark.parametrize("way", WAYS)
def test_a_mesh_that_is_missing_is_left_out_and_told_of(way: Way, tmp_path: Path) -> None:
    package = parts(tmp_path)
    found = read(way(tmp_path, package), package)
    assert found.incomplete == ("p3_link",)
    assert shapes(build_workcell(robot(found.file, package))) == 0


@pytest.mark.parametrize("way", WAYS)
def test_what_drake_reads_stays_as_it_is_and_counts(way: Way, tmp_path: Path) -> None:
    package = parts(tmp_path, "obj")
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in LARGE)
    (package / "meshes" / "link.obj").write_text(f"{corners}f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    file = way(tmp_path, package)
    found = read(file, package)
    assert (found.read == file) is (way is not included_by_path)
    assert found.left_out == ()
    assert shapes(build_workcell(robot(file, package))) == 1
    arm = package / "arm" / "one.sdf"
    arm.write_text(arm.read_text().replace("<mass>", "<mass>1", 1))
    assert read(file, package).hash != found.hash
