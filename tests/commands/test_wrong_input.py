"""Wrong input ends with exit code 2 and one message, and leaves nothing behind."""

from __future__ import annotations

import errno
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.commands.conftest import Command
from tests.small_runs import finished_run

__all__ = ["finished_run"]


def spoil(library: Path, to: Path, change) -> Path:
    shutil.copytree(library, to)
    file = to / "demo_02" / "joint_angles.csv"
    lines = file.read_text().splitlines()
    file.write_text("\n".join(change(lines)) + "\n")
    return to


def in_degrees(lines):
    rows = [line.split(",") for line in lines[1:]]
    return [lines[0], *(",".join([r[0], *(str(float(v) * 57.3) for v in r[1:])]) for r in rows)]


def with_nan(lines):
    cells = lines[50].split(",")
    return [*lines[:50], ",".join([cells[0], "nan", *cells[2:]]), *lines[51:]]


def reversed_time(lines):
    return [lines[0], *reversed(lines[1:])]


def without_column(lines):
    return [",".join(line.split(",")[:3] + line.split(",")[4:]) for line in lines]


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (in_degrees, r"joint_angles\.csv:\d+: .*look like degrees"),
        (with_nan, r"joint_angles\.csv:51: not a finite number: left_s0"),
        (reversed_time, r"joint_angles\.csv:3: time runs backwards"),
        (without_column, r"joint_angles\.csv:1: no column 'left_e0'"),
    ],
)
def test_bad_recordings_are_refused_with_their_place(
    command, library, tmp_path, change, expected
) -> None:
    spoilt = spoil(library, tmp_path / "spoilt", change)
    code, out, err = command("run", "pouring", "--demonstrations", spoilt)
    assert code == 2
    assert re.search(expected, err)
    assert (out, Path("runs").exists()) == ("", False)


RUN = ["run", "pouring"]
EVALUATE = ["evaluate", "pouring", "--demonstrations", "nowhere"]


@pytest.mark.parametrize(
    ("args", "expected"),
    [
        (["run", "puring"], "Did you mean 'pouring'"),
        (["run", "missing.yaml"], "missing.yaml"),
        (["run", "pouring", "--set", "coverage.betta=0.9"], "Did you mean 'beta'"),
        (["run", "pouring", "--set", "coverage.epsilon=0.05"], "epsilon"),
        (["run", "pouring", "--set", "robot.end_effector=left_hnd"], "Did you mean 'left_hand'"),
        (["run", "pouring", "--set", "robot.joints.0=left_s9"], "no joint 'left_s9'"),
        (["run", "pouring", "--set", "objects.0.x=[3.0, 4.0]"], "out of reach"),
        (["run", "pouring", "--set", "robot.start.1=1.5"], "outside its limits"),
        (["run", "pouring", "--model", "nothing.sdf"], "nothing.sdf"),
        (["run", "pouring", "--demonstrations", "nowhere"], "no such file or folder"),
        (["run", "pouring", "--set", "coverage.options.rope=1"], "rope"),
        (["run"], "no scenario"),
        (["run", "--resume", "nowhere"], "not a run directory"),
        (["run", "pouring", "--host", "0.0.0.0"], "this run has none"),
        (["run", "pouring", "--meshcat", "--port", "99999"], "cannot serve on localhost"),
        (["run", "pouring", "--set", "meshcat=2"], "meshcat"),
        (["run", "pouring", "--resume", "nowhere"], "--resume goes alone"),
        (["report", "nowhere"], "not a run directory"),
        (["fly"], "No such command"),
        (["runn", "pouring"], "run"),
        ([*RUN, "--set", "nonsense"], "expected key.path=value"),
        ([*RUN, "--set", "seed=[1"], "seed=[1"),
        ([*RUN, "--seed", "seven"], "--seed"),
        ([*RUN, "--demonstrations", "places.csv"], "places.csv"),
        ([*RUN, "--meshcat", "--host", "192.0.2.1"], "cannot serve on 192.0.2.1"),
        ([*RUN, "--json", "nowhere/result.json"], "there is no folder 'nowhere'"),
        ([*RUN, "--json", "."], "it is a folder"),
        (["run", "."], "is a folder"),
        (["study", "pouring", "--regions", "1,x"], "not a list of numbers of regions"),
        (["study", "pouring", "--regions", "999983"], "999,983 regions; a grid has 1 to 4,096"),
        (["study", "pouring", "--runs", "100000000000"], "years of one processor"),
        (["study", "pouring", "--scheduler", "tcp:/x"], "'tcp:/x' is not the address"),
        (["study", "pouring", "--scheduler", "tcp://localhost:1"], "nothing answers there"),
        (
            ["study", "pouring", "--scheduler", "tcp://localhost:1", "--workers", "2"],
            "--workers are processes of this machine",
        ),
        (["execute", ".", "--scheduler", "tcp://localhost:1"], "nothing answers there"),
        (["execute", ".", "--live", "--scheduler", "tcp://x:1"], "no use for --scheduler"),
        (["check", "a" * 5000], "no scenario 'aaa"),
        (["report", "a" * 5000], "File name too long"),
        (["study"], "no scenario"),
        (["study", "--resume", "nowhere"], "not a study directory"),
        (["check", "places.csv"], "places.csv"),
        (["check", "pouring", "--model", "places.csv"], "places.csv"),
        (["inspect", "nowhere"], "not a run directory"),
        (["inspect", "places.csv"], "not a run directory"),
        (["execute", "."], "not a run directory"),
        (["execute", ".", "--per-region", "0"], "per-region"),
        (
            ["execute", ".", "--per-region", "2", "--instance", "0.9", "0.3"],
            "Leave out --per-region to execute that one, or --instance",
        ),
        (["execute", ".", "--graphviz", "--json", "x.json"], "--graphviz executes nothing"),
        (["execute", ".", "--live", "--json", "x.json"], "no use for --json"),
        (["execute", ".", "--live", "--per-region", "3"], "no use for --per-region"),
        (["execute", ".", "--live", "--port", "99999"], "cannot serve on localhost, port 99999"),
        (["export", "nowhere", "--instance", "0.9", "0.3", "--output", "x"], "not a run directory"),
        (["export", "nowhere", "--instance", "0.9", "--output", "x"], "Give OBJECT=X,Y"),
        ([*EVALUATE, "--instances", "places.csv", "--output", "x.csv"], "nowhere"),
    ],
)
def test_wrong_input_ends_with_2_and_one_message(
    command: Command, places: Path, args: list[str], expected: str
) -> None:
    code, out, err = command(*args)
    assert (code, out) == (2, "")
    assert expected in err
    assert "Traceback" not in err
    assert list(Path().iterdir()) == [Path("places.csv")]


@pytest.mark.parametrize(
    ("table", "expected"), [("nowhere.csv", "nowhere.csv"), (".", "cannot be read")]
)
def test_a_table_of_instances_that_is_none(
    command: Command, library: Path, table: str, expected: str
) -> None:
    given = ("evaluate", "pouring", "--demonstrations", library, "--instances", table)
    code, out, err = command(*given, "--output", "x.csv")
    assert (code, out) == (2, "")
    assert expected in err
    assert "Traceback" not in err
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize(
    ("verb", "args", "expected"),
    [
        ("run", ["--resume"], "has ended"),
        ("inspect", ["--round", "99", "--html", "x.html"], "no round 99"),
        ("inspect", ["--round", "one"], "--round"),
        ("inspect", ["--instance", "-3", "--html", "x.html"], "no instance -3"),
        ("inspect", ["--html", "x.csv"], "would be overwritten"),
        ("inspect", ["--port", "99999"], "cannot serve"),
        ("execute", ["--instance", "a", "b"], "'a' is not a number"),
        (
            "execute",
            ["--instance", "nan", "0.3"],
            "x of 'bowl' is nan, expected a number from -1000 to 1000",
        ),
        ("execute", ["--instance", "bowll=0.9,0.3"], "Did you mean 'bowl'? Objects: bowl"),
        (
            "export",
            ["--instance", "bowl=0.9,0.3", "--output", "x", "--format", "csv"],
            "no export format 'csv'",
        ),
        (
            "export",
            ["--instance", "5", "5", "--output", "x"],
            "no demonstration gives a plan there",
        ),
        ("export", ["--instance", "0.9", "0.3", "--output", "."], "cannot be written"),
        ("export", ["--instance", "0.9", "0.3", "--output", "no/x"], "cannot be written"),
        ("report", ["--json", "no/x.json"], "there is no folder 'no'"),
    ],
)
def test_wrong_wishes_of_a_run_leave_nothing(
    command: Command, certified: Path, verb: str, args: list[str], expected: str
) -> None:
    before = sorted(certified.rglob("*"))
    given = [args[0], str(certified), *args[1:]] if args[0] == "--resume" else [certified, *args]
    code, out, err = command(verb, *given)
    assert (code, out) == (2, "")
    assert expected in " ".join(err.split())
    assert "Traceback" not in err
    assert list(Path().iterdir()) == []
    assert sorted(certified.rglob("*")) == before


def test_an_output_that_is_taken_is_refused(command: Command, certified: Path) -> None:
    for verb in ("run", "study"):
        code, out, err = command(verb, "pouring", "--output", certified, "--json", "x.json")
        assert (code, out) == (2, "")
        assert "exists already" in err
    assert list(Path().iterdir()) == []


def test_a_folder_that_was_removed_around_one_is_told(tmp_path: Path) -> None:
    (tmp_path / "gone").mkdir()
    command = f"rmdir ../gone; exec '{sys.executable}' -m drake_screw check pouring"
    done = subprocess.run(
        ["sh", "-c", command], cwd=tmp_path / "gone", capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        "error: the folder that you are in does not exist any more\n"
        "  Change to one that does: cd FOLDER\n"
    )


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (("report", "run"), r"run/round_01: cannot be written: Read-only file system\n  Free some"),
        (
            ("execute", "run", "--instance", "0.9", "0.3"),
            r"run/executions: cannot be written: Read-only file system\n  Executions are written",
        ),
    ],
)
def test_a_run_on_a_file_system_that_is_read_only_says_so(
    command, finished_run, tmp_path, monkeypatch, words, place
) -> None:
    shutil.copytree(finished_run, tmp_path / "run")

    def refuse(*_: object, **__: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(Path, "write_bytes", refuse)
    monkeypatch.setattr(Path, "mkdir", refuse)
    code, _, err = command(*words)
    assert code == 2
    assert re.search(rf"^error: {place}", err), err
    assert err.count("error:") == 1


def test_an_option_that_a_strategy_does_not_have_is_told_with_the_scenario(command) -> None:
    code, _, err = command("check", "pouring", "--set", "coverage.options.x=1")
    assert code == 2
    assert re.match(r"error: \S+pouring\.yaml: no option 'x' in bandit 'eprocess'\n", err)
