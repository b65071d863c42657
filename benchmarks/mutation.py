"""What part of small changes to the code (mutants) the tests notice.

Mutants are made and tested by mutmut, those of a package with the tests of that package, in a copy
of the tree in build/mutation. It passes over what numba compiles and over other functions with
decorators. A mutant is killed if a test fails or does not end.

    python benchmarks/mutation.py [PATH ...] [--sample N] [--seed 0]

PATH is a module or a package of drake_screw, by default each of the packages that everything rests
on. All packages take hours; --sample tests N mutants of each PATH, drawn at random.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
from collections import Counter
from contextlib import chdir
from pathlib import Path
from random import Random

from mutmut.mutation.file_mutation import mutate_file_contents

ROOT = Path(__file__).resolve().parents[1]
COPIED = ("drake_screw", "tests", "benchmarks", "models", "scenarios")
PACKAGES = ("screws", "planning", "bandits", "acquisition", "demonstrations")
KILLED = ("killed", "timeout", "segfault")
# mutmut runs the tests in forks of a process that has not used Drake: its threads would be missing.
CONFIGURATION = """
[tool.mutmut]
source_paths = ["drake_screw"]
only_mutate = ["{pattern}"]
also_copy = ["models", "scenarios", "benchmarks"]
pytest_add_cli_args_test_selection = ["tests/{package}"]
process_isolation = "forkserver"
track_dependencies = false
use_git_change_detection = false
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("paths", nargs="*", type=Path, metavar="PATH")
    parser.add_argument("--sample", type=int, metavar="N")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    paths = arguments.paths or [ROOT / "drake_screw" / package for package in PACKAGES]
    scores = [report(path.resolve(), arguments.sample, arguments.seed) for path in paths]
    print("", *scores, sep="\n")


def report(path: Path, sample: int | None, seed: int) -> str:
    """Test the mutants of a module or a package; the survivors are printed, the score returned."""
    place = path.relative_to(ROOT)
    package = place.parts[1]
    pattern = str(place) if path.is_file() else f"{place}/*"
    folder = ROOT / "build" / "mutation" / package
    shutil.rmtree(folder, ignore_errors=True)
    for name in COPIED:
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    text = (ROOT / "pyproject.toml").read_text()
    configuration = CONFIGURATION.format(pattern=pattern, package=package)
    (folder / "pyproject.toml").write_text(text + configuration)
    with chdir(folder):
        mutants = [name for file in modules(path) for name in mutants_of(file)]
    chosen = Random(seed).sample(mutants, min(sample, len(mutants))) if sample else []
    mutmut(folder, "run", "--max-children", "1", *chosen)
    lines = mutmut(folder, "results", "--all", "true").splitlines()
    found = dict(line.strip().rsplit(": ", 1) for line in lines if ": " in line)
    found = {name: status for name, status in found.items() if status != "not checked"}
    for name, status in sorted(found.items()):
        if status not in KILLED:
            print(f"\n{status}: {name}\n{mutmut(folder, 'show', name)}")
    counts = Counter(found.values())
    killed = sum(counts[status] for status in KILLED)
    stated = ", ".join(f"{count} {status}" for status, count in counts.most_common())
    share = killed / max(len(found), 1)
    return f"{place}: {share:.0%} of {len(found)} out of {len(mutants)} mutants killed ({stated})"


def modules(path: Path) -> list[Path]:
    """The modules at a path, but for those that only import."""
    files = [path] if path.is_file() else sorted(path.rglob("*.py"))
    return [file for file in files if file.name != "__init__.py"]


def mutants_of(file: Path) -> list[str]:
    """mutmut's names of a module's mutants."""
    module = ".".join(file.relative_to(ROOT).with_suffix("").parts)
    return [f"{module}.{n}" for n in mutate_file_contents(str(file), file.read_text()).mutant_names]


def mutmut(folder: Path, *arguments: str) -> str:
    """Run mutmut in a copy of the tree; what it prints. It shows by itself how a run gets on."""
    program = Path(sys.executable).with_name("mutmut")
    output = None if arguments[0] == "run" else subprocess.PIPE
    done = subprocess.run([program, *arguments], cwd=folder, stdout=output, text=True)
    if done.returncode != 0:
        raise SystemExit(f"mutmut {arguments[0]} failed")
    return done.stdout or ""


if __name__ == "__main__":
    main()
