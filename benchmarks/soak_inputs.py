"""For each kind of input, a broken one and the command that it is given to."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml
from soak_breaking import break_file, broken_place
from soak_data_sets import SETS, broken_set, import_of
from soak_originals import EVALUATE, IMPORT, LOOK
from soak_values import Random, pick, word


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
        # A broken place may lead out of here, or round in circles.
        inside = Path.cwd() in Path(os.path.realpath(extra)).parents
        if inside and extra.parent.is_dir() and not extra.exists() and not extra.is_symlink():
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
    main = [Path("run/run.json"), Path("run/scenario.yaml"), *sorted(Path("run").rglob("*.npz"))]
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


def _data_set(rng: Random, originals: Path) -> list[str]:
    name = pick(rng, SETS)
    _bring(originals, "task.yaml", "arm.sdf", name)
    arguments = import_of(name)
    broken_set(rng, name)
    return arguments


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
    "data set": (0.05, _data_set),
}
"""Share of all inputs, and what breaks one in the working directory and says what is called."""
