"""Help, versions and completion, and that they are quick to come."""

from __future__ import annotations

import importlib.metadata
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from drake_screw.plugins import BUILT_IN, Group
from tests.commands.conftest import Command

VERBS = [
    "init",
    "list",
    "check",
    "import",
    "look",
    "run",
    "report",
    "compare",
    "inspect",
    "execute",
    "export",
    "evaluate",
    "select",
    "study",
]

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help_with_an_example(command: Command, verb: str) -> None:
    code, out, _ = command(verb, "--help")
    assert code == 0
    assert f"drake-screw {verb}" in out.split("Example:")[1]


def test_the_installed_program_runs_from_anywhere(tmp_path: Path) -> None:
    program = Path(sys.executable).with_name("drake-screw")
    done = subprocess.run(
        [program, "check", "scooping"], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "scooping" in done.stdout


def python(code: str, *args: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """A fresh interpreter that runs `code`."""
    return subprocess.run(
        [sys.executable, "-c", code, *args],
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_verbs_are_listed(command: Command) -> None:
    code, out, _ = command("--help")
    assert code == 0
    listed = out.split("Commands:")[1].split("Begin with")[0].splitlines()
    assert [line.split()[0] for line in listed if line.strip()] == VERBS
    assert not any(line.endswith("...") for line in listed)
    assert "--install-completion" in out
    assert "--show-completion" in out


@pytest.mark.parametrize(("verb", "group"), [("export", "exporters"), ("import", "sources")])
def test_formats_are_listed_whole(command: Command, verb: str, group: Group) -> None:
    _, out, _ = command(verb, "--help")
    assert [name for name in BUILT_IN[group] if name not in out] == []


def test_no_verb_at_all_shows_the_help(command: Command) -> None:
    code, out, _ = command("--verbose")
    assert code == 0
    assert "Commands:" in out
    assert command()[1:] != ("", "")


@pytest.mark.parametrize("args", [["--help"], ["--version"], *([verb, "--help"] for verb in VERBS)])
def test_help_and_version_load_no_drake_and_no_numpy(args: list[str]) -> None:
    code = (
        "import sys\nfrom drake_screw.cli import main\ntry:\n    main()\n"
        "finally:\n    print(*({'pydrake', 'numpy', 'numba', 'matplotlib'} & set(sys.modules)),"
        " file=sys.stderr)"
    )
    done = python(code, *args)
    assert (done.returncode, done.stderr.split()) == (0, [])
    assert done.stdout


def test_the_version(command: Command) -> None:
    version = importlib.metadata.version
    assert command("--version") == (0, f"drake-screw {version('drake-screw')}\n", "")
    code, out, _ = command("--version", "--verbose")
    assert code == 0
    names = ("drake-screw", "drake", "numpy", "numba")
    assert out.splitlines() == [f"{name} {version(name)}" for name in names]


def test_the_package_is_a_program() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "drake_screw", "--version"],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("drake-screw ")


def test_shells_complete_verbs_and_options() -> None:
    code = "import sys; sys.argv[0] = 'drake-screw'; from drake_screw.cli import main; main()"
    done = python(
        code,
        _DRAKE_SCREW_COMPLETE="complete_bash",
        COMP_WORDS="drake-screw e",
        COMP_CWORD="1",
    )
    assert set(done.stdout.split()) == {"execute", "export", "evaluate"}


def test_verbose_logs_with_times_to_standard_error(command: Command) -> None:
    quiet = command("list")
    code, out, err = command("list", "--verbose")
    assert (code, out) == quiet[:2]
    assert quiet[2] == ""
    assert re.search(r"^\d{4}-\d\d-\d\d \d\d:\d\d:\d\d,\d+ DEBUG drake_screw", err, re.MULTILINE)
    assert re.search(r"ended after \d+\.\d s", err)
    code, _, err = command("check", "nowhere.yaml", "-v")
    assert code == 2
    assert "Traceback" in err  # where it was raised, for whoever asked
    assert command("list")[2] == ""
