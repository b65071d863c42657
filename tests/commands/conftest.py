"""The command as a user meets it, in this process, and what it is given."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drake_screw import cli, load_scenario, new_run
from drake_screw.acquisition import Suggestion
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import write_recording

Command = Callable[..., tuple[int, str, str]]

CHANGES = ["objects.0.symmetry=null", "coverage.epsilon=0.15", "coverage.beta=0.7"]
QUICK = [word for change in CHANGES for word in ("--set", change)]
NAIVE = ["--set", "coverage.strategy=naive_pac"]


@pytest.fixture
def command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Command:
    """Runs ``drake-screw ARGS`` in an empty folder; returns exit code, stdout and stderr.

    That the arm's code has to be compiled depends on the tests before, and is left out.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")

    def run(*args: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["drake-screw", *map(str, args)])
        with pytest.raises(SystemExit) as end:
            cli.main()
        out = capsys.readouterr()
        err = [line for line in out.err.splitlines(True) if not line.startswith("compiling the")]
        return int(end.value.code or 0), out.out, "".join(err)

    return run


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three recordings by the simulated teacher, written as the robot would write them."""
    setup = Setup(load_scenario("pouring"))
    folder = tmp_path_factory.mktemp("library")
    for number, (x, y) in enumerate([(0.8, 0.1), (0.95, 0.35), (0.85, 0.6)]):
        place = np.array([[x, y, 0.0]])
        lesson = setup.teacher.demonstrate(
            Suggestion(int(setup.regions.index(place)), place),
            number=number,
            used=(),
            rng=np.random.default_rng(number),
        )
        assert lesson.recording is not None, lesson.remark
        write_recording(lesson.recording, folder / lesson.recording.name)
    return folder


@pytest.fixture(scope="session")
def certified(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small run of scenario pouring with a certificate; copy it where it would change."""
    folder = tmp_path_factory.mktemp("certified") / "run"
    for _ in new_run(load_scenario("pouring", CHANGES), folder).events():
        pass
    return folder


@pytest.fixture
def places(tmp_path: Path) -> Path:
    file = tmp_path / "places.csv"
    file.write_text("x,y\n0.8,0.1\n0.9,0.3\n1.07,-0.23\n")
    return file
