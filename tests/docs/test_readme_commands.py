"""The README's commands can be read; slow: they do what it says, one after the other."""

from __future__ import annotations

import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from drake_screw.cli import app
from drake_screw.commands.listing import shipped

ROOT = Path(__file__).parents[2]
COMMAND = Path(sys.executable).with_name("drake-screw")
LEAVES = (
    "my_run/run.json",
    "my_run/report.html",
    "failing.html",
    "mine/run.json",
    "looks.html",
    "plan.csv",
    "outcomes.csv",
)


def commands(page: str = "README.md") -> list[str]:
    """Lines of a page's shell blocks, joined where they are continued, without `make`."""
    text = (ROOT / page).read_text()
    blocks = re.findall(r"^```sh\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)
    lines = "".join(blocks).replace("\\\n", " ").splitlines()
    return [line.split("  #")[0].strip() for line in lines if not line.startswith("make")]


def succeeds(line: str, folder: Path) -> str:
    """What a line of a shell prints in a folder; it ends with 0."""
    done = subprocess.run(line, shell=True, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{line}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def serves(line: str, folder: Path) -> None:
    """A line that serves a page until Ctrl-C tells where it is, and ends without a traceback."""
    command = shlex.split(line)
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as going:
        assert going.stdout is not None
        said = ""
        for said in going.stdout:
            if "http://" in said:
                break
        assert "http://" in said, f"{line}: no page"
        going.send_signal(signal.SIGINT)
        rest = going.stdout.read()
    assert going.returncode in (0, 130), rest
    assert "Traceback" not in rest


@pytest.mark.slow
def test_getting_started_ends_with_an_own_recording_looked_at(tmp_path: Path) -> None:
    if not COMMAND.exists():
        pytest.skip(f"the command is not installed beside {sys.executable}")
    for line in commands("docs/getting_started.md")[1:]:  # after the environment is activated
        output = succeeds(line.replace("drake-screw", str(COMMAND), 1), tmp_path)
        if line.startswith("cat"):
            x, y = (float(row.split(",")[3]) for row in output.splitlines()[:2])
            assert (x, y) == pytest.approx((1.08, 0.78), abs=0.005)  # what the page says next
    assert "log" in (tmp_path / "mine.html").read_text()
    assert (tmp_path / "covered" / "run.json").is_file()


@pytest.mark.slow
def test_commands_in_their_order(tmp_path: Path) -> None:
    if not COMMAND.exists():
        pytest.skip(f"the command is not installed beside {sys.executable}")
    (tmp_path / "places.csv").write_text("x,y\n0.9,0.3\n0.75,-0.1\n")
    listed = commands()
    assert len(listed) >= 10
    for line in listed:
        do = serves if "--live" in line else succeeds
        do(line.replace("drake-screw", str(COMMAND)), tmp_path)
    missing = [name for name in LEAVES if not (tmp_path / name).is_file()]
    assert missing == []
    for entry in re.findall(r"^      (\S+)", (ROOT / "README.md").read_text(), re.MULTILINE):
        assert (tmp_path / "my_run" / entry).exists(), entry


@pytest.mark.parametrize("page", ["README.md", "docs/index.md", "docs/getting_started.md"])
def test_every_command_can_be_read(page: str) -> None:
    """Its verb, arguments and options; and shipped scenarios and robots by their names."""
    group = typer.main.get_command(app)
    assert isinstance(group, typer.core.TyperGroup)
    names = {entry.name for entry in shipped().scenarios}
    names |= {entry.name for entry in shipped().models}
    for line in commands(page):
        program, verb, *words = shlex.split(line)
        if page != "README.md" and program in (".", "cp", "cat"):
            continue
        assert program == "drake-screw"
        given = group.commands[verb].make_context(verb, words).params
        for name in (given.get("scenario"), given.get("robot")):
            assert name is None or Path(name).suffix or name in names, line


def test_shell_blocks_are_all_read() -> None:
    verbs = {line.split()[1] for line in commands() if line.startswith("drake-screw")}
    assert {
        "run",
        "report",
        "inspect",
        "check",
        "look",
        "execute",
        "export",
        "evaluate",
        "select",
        "init",
        "list",
    } <= verbs
