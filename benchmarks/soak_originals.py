"""Inputs that are right: what the soak breaks."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import yaml
from soak_data_sets import SETS, import_of, make_data_sets

from drake_screw.resources import find_resource

TASK = """
name: small
robot:
  model: arm.sdf
  joints: [shoulder_pan_joint, shoulder_lift_joint, elbow_joint, wrist_1_joint, wrist_2_joint,
           wrist_3_joint]
  end_effector: hand
  start: [1.14, -1.9, -1.97, 0.11, 0.64, -0.28]
  base: base
table: {center: [0.35, 0.0], size: [1.10, 1.30], top: 0.0, thickness: 0.04}
objects:
  - {name: bowl, x: [0.40, 0.70], y: [-0.40, 0.40], yaw: 0, z: 0.0, radius: 0.08, height: 0.06}
regions: {grid: {x: 1, y: 1}}
coverage: {beta: 0.6, epsilon: 0.2, delta: 0.3}
demonstrations: {initial: 1, first: middle, budget: 2}
teacher: {kind: simulated, motion: pouring}
planner: {tolerance: 1.0e-3, collision: true}
"""
"""Of which runs take a second: one region and two demonstrations."""

MORE: dict[str, Any] = {
    "description": "with most of the keys that there are",
    "obstacles": [
        {"name": "post", "cylinder": {"radius": 0.03, "length": 0.5}, "xyz": [-0.6, -0.4, 0.25]},
        {"name": "jug", "mesh": "jug.obj", "scale": 0.1, "xyz": [-0.6, 0.5, 0.1]},
        {"name": "part", "mesh": "part.stl", "scale": 0.1, "xyz": [-0.7, 0.1, 0.1]},
    ],
    "demonstrations": {"initial": ["library/01_demo_01"], "ask": "earliest", "budget": 4},
    "teacher": {"kind": "recorded", "folder": "library", "choose": "nearest"},
    "segmentation": {"method": "published", "region_of_interest": 1.5},
    "execution": {"position": 0.01, "noise": {"object_position": 0.001}},
    "coverage": {"beta": 0.6, "epsilon": 0.2, "delta": 0.3, "strategy": "eprocess", "options": {}},
    "seed": 0,
}
TOOL = {"xyz": [0, 0, 0.1], "shape": {"box": [0.02, 0.02, 0.02]}, "touches": ["bowl"]}
LID = {"name": "lid", "on": "bowl", "x": 0, "y": 0, "z": 0.06, "radius": 0.03, "height": 0.02}
ALONE = {
    "demonstrations": {},
    "regions": {"grid": {"bowl.x": 2}},
    "teacher": {"kind": "simulated", "motion": "pouring"},
}
MAPPING: dict[str, Any] = {"separator": ",", "decimal": ".", "time": "time", "time_unit": "s"}
MAPPING |= {"angles": "rad", "objects": {"bowl": [0.55, 0.0]}}

OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"
_FACET = "facet normal 0 0 1\nouter loop\nvertex {}\nvertex {}\nvertex {}\nendloop\nendfacet\n"
_CORNERS = ("0 0 0", "1 0 0", "0 1 0", "0 0 1")
_FACETS = [_FACET.format(*(corner for corner in _CORNERS if corner != left)) for left in _CORNERS]
STL = "".join(["solid x\n", *_FACETS, "endsolid x\n"])
LINK = """<link name="{0}"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0"
ixz="0" iyz="0"/></inertial><visual><geometry><mesh filename="part.stl" scale="0.1 0.1 0.1"/>
</geometry></visual><collision><geometry><cylinder radius="0.02" length="0.1"/></geometry>
</collision></link>"""
JOINT = """<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin
xyz="0 0.1 0.2" rpy="1.5 0 0"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="10"
velocity="2"/></joint>"""

LOOK = ("look", "library/01_demo_01", "--scenario", "task.yaml")
IMPORT = ("import", "log.csv", "--scenario", "task.yaml", "--output", "new")
EVALUATE = ("evaluate", "task.yaml", "--demonstrations", "library", "--instances", "places.csv")
EVALUATE += ("--output", "outcomes.csv")
RIGHT = (
    ("check", "full.yaml"),
    ("check", "two.yaml"),
    LOOK,
    IMPORT,
    EVALUATE,
    ("compare", "run", "other"),
)
"""What is right as long as nothing is broken."""


def make_originals(folder: Path) -> None:
    """Make what is broken later: runs, a study, a library, scenarios, models, lists, logs."""
    shipped = find_resource("models", "ur5e", (".sdf",)).read_text()
    text = re.sub(r"<!--.*?-->|<visual.*?</visual>", "", shipped, flags=re.S)
    (folder / "arm.sdf").write_text(re.sub(r"\n\s*\n+", "\n", text))
    links = [LINK.format(f"l{i}") for i in range(7)]
    joints = [JOINT.format(f"j{i}", f"l{i}", f"l{i + 1}") for i in range(6)]
    (folder / "arm.urdf").write_text(f'<robot name="arm">{"".join([*links, *joints])}</robot>')
    (folder / "jug.obj").write_text(OBJ)
    (folder / "part.stl").write_text(STL)
    (folder / "task.yaml").write_text(TASK)
    _call(folder, "run", "task.yaml", "--quiet", "--output", "run")
    _call(folder, "run", "task.yaml", "--quiet", "--output", "other", "--seed", "1")
    _call(folder, "study", "task.yaml", "--regions", "1", "--runs", "2", "--output", "study")
    for one in sorted((folder / "run" / "demonstrations").iterdir()):
        thinned = folder / "library" / one.name
        shutil.copytree(one, thinned)
        lines = (one / "joint_angles.csv").read_text().splitlines()
        (thinned / "joint_angles.csv").write_text("\n".join([*lines[:-1:25], lines[-1]]) + "\n")
        shutil.copyfile(thinned / "joint_angles.csv", folder / "log.csv")
    (folder / "places.csv").write_text("x,y,yaw\n0.5,0.1,0\n0.6,0.2,0\n0.55,-0.1,0\n")
    (folder / "recording.yaml").write_text(yaml.safe_dump(MAPPING))
    task = yaml.safe_load(TASK)
    (folder / "full.yaml").write_text(yaml.safe_dump(task | MORE, sort_keys=False))
    task["robot"]["tool"] = TOOL
    task["objects"].append(LID)
    (folder / "two.yaml").write_text(yaml.safe_dump(task | MORE | ALONE, sort_keys=False))
    record = folder / "run" / "run.json"
    stopped = json.loads(record.read_text()) | {"status": "interrupted", "certificate": None}
    (folder / "stopped.json").write_text(json.dumps(stopped))
    make_data_sets(folder, partial(_call, folder, codes=(0,)))
    for arguments in (*RIGHT, *map(import_of, SETS)):
        _call(folder, *arguments, codes=(0,))


def _call(folder: Path, *arguments: str, codes: Sequence[int] = (0, 1)) -> None:
    command = [sys.executable, "-m", "drake_screw", *arguments]
    done = subprocess.run(command, cwd=folder, check=False, stdout=subprocess.DEVNULL)
    if done.returncode not in codes:
        raise RuntimeError(f"{arguments} ended with {done.returncode}")
