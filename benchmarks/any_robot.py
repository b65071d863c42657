"""From makers' robot models to certificates: init, check, run and execute, one robot after another.

    python benchmarks/any_robot.py [ROBOT ...] [--folder DIR] [--json FILE]

Models are those of the package example-robot-data (PyPI; it brings its files and is large), or of
DIR, the folder that has `panda_description` and the like in it; there may be those of Fetch
(fetch_ros) and Gen3 (ros2_kortex) beside them. What is not there is left out. Each robot's
scenario is what `drake-screw init` makes of the model as it comes, without a question answered,
with the simulated teacher; a plan in each region is executed. Prints a table in Markdown.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

ROBOTS: dict[str, tuple[str, ...]] = {
    "panda": ("Franka Panda", "panda_description/urdf/panda.urdf"),
    "ur5": ("UR5", "ur_description/urdf/ur5_robot.urdf"),
    "ur10": ("UR10", "ur_description/urdf/ur10_robot.urdf"),
    "xarm7": ("xArm 7", "xarm_description/urdf/xarm7.urdf"),
    "jaco": ("Kinova Jaco", "kinova_description/robots/kinova.urdf"),
    "gen3": ("Kinova Gen3", "kortex_description/robots/gen3.xacro", "--xacro", "dof=7"),
    "z1": ("Unitree Z1", "z1_description/urdf/z1.urdf"),
    "fetch": ("Fetch, lift held", "fetch_description/robots/fetch.urdf"),
    "baxter": ("Baxter", "baxter_description/urdf/baxter.urdf"),
    "tiago": ("Tiago", "tiago_description/robots/tiago_no_hand.urdf"),
    "pr2": ("PR2", "pr2_description/urdf/pr2.urdf"),
}
"""What they are called, where their models are, and what `init` is told besides."""

DATA = Path("share") / "example-robot-data" / "robots"
"""Below where that package is installed."""


def folder_of_models() -> Path | None:
    """Where the package has its models; None where it is not installed."""
    for place in (*map(Path, sys.path), Path(sys.prefix)):
        for folder in (place / "cmeel.prefix" / DATA, place / DATA):
            if folder.is_dir():
                return folder
    return None


def command(folder: Path, *arguments: str) -> tuple[int, str, float]:
    """Exit code, what was printed, and seconds that a drake-screw command took."""
    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "drake_screw", *arguments],
        cwd=folder,
        env=os.environ | {"COLUMNS": "200"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout, time.perf_counter() - began


def tried(model: Path, said: Sequence[str], folder: Path) -> dict[str, Any]:
    """What becomes of a model: `failed` has the command that ended with an error, and its words."""
    found: dict[str, Any] = {"model": str(model)}
    for name, arguments in (
        ("init", (str(model), *said, "--output", "mine.yaml")),
        ("check", ("mine.yaml", "--json", "check.json")),
        ("run", ("mine.yaml", "--output", "mine", "--json", "run.json")),
        ("execute", ("mine", "--per-region", "1", "--json", "execute.json")),
    ):
        code, printed, seconds = command(folder, name, *arguments)
        found[f"{name}_seconds"] = seconds
        if code != 0:
            return found | {"failed": name, "said": printed[-2000:]}
    for name in ("check", "run", "execute"):
        found[name] = json.loads((folder / f"{name}.json").read_text())
    return found


def row(name: str, found: dict[str, Any]) -> str:
    """A robot's row of the table."""
    times = [found.get(f"{c}_seconds") for c in ("init", "check", "run", "execute")]
    spent = " + ".join("" if t is None else f"{t:.0f}" for t in times)
    if "failed" in found:
        said = found["said"].strip().splitlines()
        return f"| {name} | {found['failed']}: {said[-1] if said else ''} | | | | {spent} |"
    check, run, execute = (found[c] for c in ("check", "run", "execute"))
    summary = execute["summary"]
    return (
        f"| {name} | {len(check['robot']['joints'])} joints, `{check['robot']['end_effector']}` "
        f"| {run['status']}, {len(run['demonstrations'])} "
        f"| {summary['flawless']} of {summary['instances']} "
        f"| {check['plans_per_second']:,.0f} | {spent} |"
    )


def table(folder: Path, robots: Iterable[str]) -> Iterator[tuple[str, dict[str, Any], str]]:
    """Key, findings and row of each robot whose model is in the folder."""
    for key in robots:
        name, file, *said = ROBOTS[key]
        if not (folder / file).is_file():
            print(f"{name} is left out: there is no {folder / file}", file=sys.stderr)
            continue
        with tempfile.TemporaryDirectory() as scratch:
            found = tried(folder / file, said, Path(scratch))
        yield key, found, row(name, found)


def main() -> None:
    """Try them, print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("robots", nargs="*", metavar="ROBOT", help=f"of {', '.join(ROBOTS)}")
    parser.add_argument("--folder", type=Path, help="with the models")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write what is found there")
    arguments = parser.parse_args()
    folder = arguments.folder or folder_of_models()
    if folder is None or not folder.is_dir():
        parser.error("no models: pip install example-robot-data, or give --folder")
    if unknown := [key for key in arguments.robots if key not in ROBOTS]:
        parser.error(f"no robot {', '.join(unknown)}; there are {', '.join(ROBOTS)}")
    print(
        "| robot | arm | certificate, demonstrations | executed | places/s "
        "| seconds: init + check + run + execute |\n|---|---|---|---|---|---|"
    )
    results = {}
    for key, found, line in table(folder.resolve(), arguments.robots or ROBOTS):
        print(line, flush=True)
        results[key] = found
        if arguments.json:
            arguments.json.write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
