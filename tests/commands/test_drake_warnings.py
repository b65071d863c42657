"""Drake's warnings of models: gathered, and told once in a line for each kind."""

from __future__ import annotations

import logging
import subprocess
import sys
from pathlib import Path

import pytest

from drake_screw.commands.drake_warnings import Gathered, lines_of, understood

INERTIAL = (
    "<inertial><mass value='1'/>\n<inertia ixx='1' iyy='0.001' izz='0.01' ixy='0' ixz='0' "
    "iyz='0'/></inertial>"
)


def model(folder: Path, links: int) -> Path:
    """Links that cannot be, a floating joint, and what Drake knows nothing of."""
    parts = [f"<link name='l{i}'>\n{INERTIAL}\n</link>" for i in range(links)]
    joints = [
        f"<joint name='j{i}' type='revolute'>\n<parent link='l{i - 1}'/><child link='l{i}'/>\n"
        "<limit lower='-1' upper='1' velocity='1' effort='1'/><safety_controller/></joint>"
        for i in range(1, links)
    ]
    floating = (
        "<link name='odom'/>\n<joint name='drift' type='floating'>\n"
        "<parent link='odom'/><child link='l0'/></joint>"
    )
    file = folder / "shaky.urdf"
    file.write_text("\n".join(["<robot name='shaky'>", *parts, floating, *joints, "</robot>"]))
    return file


def run(folder: Path, links: int, *options: str) -> str:
    """What `check` says on standard error of a scenario with such a model."""
    scenario = folder / "shaky.yaml"
    scenario.write_text(
        f"name: shaky\nrobot: {{model: {model(folder, links).name}, joints: [j1, j2], "
        "end_effector: l2, start: [0, 0.1], base: l0}\n"
        "objects: [{name: bowl, x: [0, 0.1], y: [0, 0.1], z: 0, radius: 0.05, height: 0.05}]\n"
        "teacher: {kind: simulated, motion: pouring}\nregions: {grid: {x: 1, y: 1}}\n"
    )
    command = [sys.executable, "-m", "drake_screw", *options, "check", str(scenario)]
    return subprocess.run(command, capture_output=True, text=True, check=False).stderr


def test_a_line_for_each_kind_with_the_names(tmp_path: Path) -> None:
    said = run(tmp_path, 9)
    inertia = [line for line in said.splitlines() if "inertias that are not physical" in line]
    assert inertia[0] == (
        "shaky.urdf: 9 links have inertias that are not physical; only simulation needs them: "
        "l0, l1, l2, l3, l4, l5, ..."
    )
    assert "shaky.urdf: 1 floating joint is held where it is by default: drift" in said
    assert "left out: safety_controller" in said
    assert "triangle inequality" not in said
    assert said.count("inertias that are not physical") == 1


def test_in_full_with_verbose(tmp_path: Path) -> None:
    said = run(tmp_path, 3, "--verbose")
    assert said.count("triangle inequality") >= 3
    assert "have inertias that are not physical" not in said


def warn(gathered: Gathered, text: str, level: int = logging.WARNING) -> bool:
    return gathered.filter(logging.LogRecord("drake", level, "", 0, text, (), None))


def test_told_once_and_nothing_else_is_kept_back(caplog: pytest.LogCaptureFixture) -> None:
    gathered, logger = Gathered(), logging.getLogger("drake_screw.told")
    assert not warn(gathered, "Allocating contexts", logging.INFO)
    assert warn(gathered, "half spaces are not supported")
    for _ in range(3):
        for line in (3, 7):
            assert not warn(gathered, f"a/b.sdf:{line}: warning: some {{odd}} thing\nand more")
        gathered.tell(logger)
    assert [record.message for record in caplog.records] == ["b.sdf: some {odd} thing"]


def test_what_a_line_of_several_elements_is_about_is_not_guessed(tmp_path: Path) -> None:
    file = tmp_path / "a.urdf"
    file.write_text("<link name='a'><inertia/></link><link name='b'><inertia/></link>\n")
    warned = understood(f"{file}:1: warning: While parsing inertia matrix: no")
    assert warned is not None
    assert warned.name is None
    assert list(lines_of([warned, warned])) == [
        "a.urdf: 2 links have inertias that are not physical; only simulation needs them"
    ]
    assert understood("no warning of a parser") is None
