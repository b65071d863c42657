"""Inputs that are right, and for each kind of them a command that is given a broken one."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import yaml
from soak_breaking import Random, break_file, broken_place, pick, word

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
    for arguments in RIGHT:
        _call(folder, *arguments, codes=(0,))


def _call(folder: Path, *arguments: str, codes: Sequence[int] = (0, 1)) -> None:
    command = [sys.executable, "-m", "drake_screw", *arguments]
    done = subprocess.run(command, cwd=folder, check=False, stdout=subprocess.DEVNULL)
    if done.returncode not in codes:
        raise RuntimeError(f"{arguments} ended with {done.returncode}")


def _bring(originals: Path, *names: str) -> None:
    """Copy originals to the working directory."""
    for name in names:
        source, copy = originals / name, Path(name)
        copy.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, copy)
        else:
            shutil.copyfile(source, copy)


def _scenario(rng: Random, originals: Path) -> list[str]:
    name = pick(rng, ("task.yaml", "full.yaml", "full.yaml", "two.yaml"))
    _bring(originals, name, "arm.sdf", "jug.obj", "part.stl", "library")
    break_file(rng, Path(name))
    return ["check", name]


def _override(rng: Random, originals: Path) -> list[str]:
    _bring(originals, "full.yaml", "arm.sdf", "jug.obj", "part.stl", "library")
    keys = list(_keys(yaml.load(Path("full.yaml").read_text(), Loader=yaml.CSafeLoader)))
    changes = []
    for _ in range(int(pick(rng, (1, 1, 2)))):
        key = pick(rng, keys)
        chance = rng.random()
        if chance < 0.15:
            key = pick(
                rng, (key + ".x", key[:-1], key + ".0", key + ".99", word(rng), "objects.-1")
            )
        change = key + word(rng) if chance > 0.95 else f"{key}={word(rng)}"
        changes += ["--set", change.replace("\x00", "")]
    return ["check", "full.yaml", *changes]


def _keys(tree: Any, path: str = "") -> list[str]:
    entries = tree.items() if isinstance(tree, dict) else enumerate(tree)
    found = []
    for key, value in entries:
        found.append(f"{path}{key}")
        if isinstance(value, dict | list):
            found += _keys(value, f"{path}{key}.")
    return found


def _recording(rng: Random, originals: Path) -> list[str]:
    _bring(originals, "task.yaml", "arm.sdf", "library/01_demo_01")
    break_file(rng, Path("library/01_demo_01/joint_angles.csv"))
    return [*LOOK]


def _poses(rng: Random, originals: Path) -> list[str]:
    _bring(originals, "task.yaml", "arm.sdf", "library/01_demo_01")
    break_file(rng, Path("library/01_demo_01/object_poses.csv"))
    return [*LOOK]


def _library(rng: Random, originals: Path) -> list[str]:
    _bring(originals, "full.yaml", "arm.sdf", "jug.obj", "part.stl", "library")
    places = [Path("library"), *sorted(Path("library").rglob("*"))]
    broken_place(rng, pick(rng, places))
    if rng.random() < 0.5:
        extra = Path(pick(rng, ("library", "library/02_demo_02"))) / pick(
            rng,
            (
                "region_of_interest.txt",
                "hand_poses.csv",
                "x",
                "demo_03",
                ".hidden",
                "joint_angles.csv",
            ),
        )
        if extra.parent.is_dir() and not extra.exists() and not extra.is_symlink():
            extra.write_text(word(rng), errors="replace")
    commands = (["check", "full.yaml"], ["look", "library", "--scenario", "full.yaml"])
    return list(pick(rng, commands))


def _log(rng: Random, originals: Path) -> list[str]:
    _bring(originals, "task.yaml", "arm.sdf", "log.csv")
    arguments = [*IMPORT]
    if rng.random() < 0.5:
        _bring(originals, "recording.yaml")
        break_file(rng, Path(pick(rng, ("recording.yaml", "recording.yaml", "log.csv"))))
        return arguments
    place = "0.55,0.0"
    if rng.random() < 0.5:
        break_file(rng, Path("log.csv"))
    else:
        place = pick(rng, (word(rng), f"0.5,{word(rng)}", "0.5", "1,2,3,4,5", "x@hand:1s", "hand"))
    name = "bowl" if rng.random() < 0.9 else word(rng)
    return [*arguments, "--object", f"{name}={place}".replace("\x00", "")]


def _instances(rng: Random, originals: Path) -> list[str]:
    _bring(originals, "task.yaml", "arm.sdf", "library", "places.csv")
    break_file(rng, Path("places.csv"))
    return [*EVALUATE]


def _run_directory(rng: Random, originals: Path) -> list[str]:
    _bring(originals, "run", "arm.sdf")
    if rng.random() < 0.4:
        shutil.copyfile(originals / "stopped.json", "run/run.json")
    files = [f for f in sorted(Path("run").rglob("*")) if f.suffix not in (".png", ".html", ".log")]
    main = [Path("run/run.json"), Path("run/scenario.yaml"), *Path("run").rglob("*.npz")]
    break_file(rng, pick(rng, main if rng.random() < 0.7 else files))
    place = ["--instance", "0.5", "0.1"]
    commands = (
        *(["run", "--resume", "run"],) * 4,
        *(["compare", "run", str(originals / "other")],) * 6,
        ["export", "run", *place, "--format", "npz", "--output", "plan.npz"],
        ["report", "run"],
        ["inspect", "run", "--html", "page.html"],
        ["execute", "run", *place, "--graphviz"],
    )
    return list(pick(rng, commands))


def _model(rng: Random, originals: Path) -> list[str]:
    if rng.random() < 0.3:
        _bring(originals, "arm.urdf", "part.stl")
        broken = "arm.urdf" if rng.random() < 0.8 else "part.stl"
        break_file(rng, Path(broken))
        return ["init", "arm.urdf", "--output", "mine.yaml", "--arm", "no such arm"]
    _bring(originals, "full.yaml", "arm.sdf", "jug.obj", "part.stl", "library")
    broken = pick(rng, ("arm.sdf", "arm.sdf", "arm.sdf", "jug.obj", "part.stl"))
    break_file(rng, Path(broken))
    if broken == "arm.sdf":
        return ["look", "library/01_demo_01", "--scenario", "full.yaml"]
    return ["check", "full.yaml"]


def _study(rng: Random, originals: Path) -> list[str]:
    _bring(originals, "study", "arm.sdf")
    files = [f for f in sorted(Path("study").rglob("*")) if f.suffix not in (".png", ".svg")]
    break_file(rng, pick(rng, files))
    return ["study", "--resume", "study", "--workers", "1"]


_OPTIONS = {
    "check": ("--model", "--set", "--json"),
    "look": ("--scenario", "--model", "--set", "--json", "--html"),
    "import": (
        "--format",
        "--rate",
        "--episodes",
        "--mapping",
        "--object",
        "--output",
        "--scenario",
    ),
    "report": ("--axes", "--json"),
    "compare": ("--json", "--html"),
    "export": ("--instance", "--format", "--output"),
    "inspect": ("--round", "--instance", "--port", "--host"),
    "evaluate": ("--demonstrations", "--instances", "--output", "--model", "--set"),
    "select": ("--demonstrations", "--instances", "--seed", "--set"),
    "study": ("--regions", "--runs", "--seed", "--workers", "--resume", "--output"),
    "init": ("--arm", "--task", "--table-height", "--package", "--xacro", "--srdf", "--output"),
    "list": ("--json",),
    "run": ("--seed", "--output", "--resume", "--port", "--host", "--set"),
}


def _command_line(rng: Random, originals: Path) -> list[str]:
    _bring(originals, "task.yaml", "arm.sdf", "log.csv", "places.csv")
    verb = pick(rng, list(_OPTIONS))
    things = ("task.yaml", "log.csv", "places.csv", "nowhere", ".", "arm.sdf", "pouring")
    arguments = [word(rng) if rng.random() < 0.5 else pick(rng, things)]
    for _ in range(int(rng.integers(1, 4))):
        option = pick(rng, _OPTIONS[verb]) if rng.random() < 0.9 else f"--{word(rng)}"
        arguments += [option, word(rng) if rng.random() < 0.8 else pick(rng, things)]
    if verb in ("run", "study", "select"):  # nothing that might do what it says, for minutes
        arguments[0] = "nowhere.yaml"
    return [verb, *(a.replace("\x00", "")[:100_000] for a in arguments)]


KINDS: dict[str, tuple[float, Callable[[Random, Path], list[str]]]] = {
    "scenario": (0.22, _scenario),
    "override": (0.2, _override),
    "recording": (0.1, _recording),
    "object poses": (0.09, _poses),
    "library": (0.03, _library),
    "log": (0.09, _log),
    "instances": (0.1, _instances),
    "run directory": (0.02, _run_directory),
    "model": (0.04, _model),
    "study": (0.01, _study),
    "command line": (0.1, _command_line),
}
"""Share of all inputs, and what breaks one in the working directory and says what is called."""
