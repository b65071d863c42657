"""The command as a user meets it, in this process and, once, as a program of its own."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from drake_screw import cli
from drake_screw.assembly.setup import Setup
from drake_screw.scenario.loader import load_scenario

QUICK = ["--set", "coverage.epsilon=0.15", "--set", "coverage.beta=0.7"]
NAIVE = ["--set", "coverage.strategy=naive_pac"]


@pytest.fixture
def command(monkeypatch, capsys, tmp_path):
    """Runs ``drake-screw ARGS`` in an empty folder; returns exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")

    def run(*args: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["drake-screw", *map(str, args)])
        with pytest.raises(SystemExit) as end:
            cli.main()
        out = capsys.readouterr()
        return int(end.value.code or 0), out.out, out.err

    return run


@pytest.fixture(scope="module")
def library(tmp_path_factory) -> Path:
    """Three recordings by the simulated teacher, written as the robot would write them."""
    from drake_screw.acquisition import Suggestion
    from drake_screw.demonstrations import write_recording

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


@pytest.fixture
def places(tmp_path) -> Path:
    file = tmp_path / "places.csv"
    file.write_text("x,y\n0.8,0.1\n0.9,0.3\n1.07,-0.23\n")
    return file


def test_run_leaves_a_certified_run(command, tmp_path):
    code, out, err = command("run", "pouring", *QUICK, "--seed", 3)
    assert (code, err) == (0, "")
    assert "certificate" in out
    (path,) = (tmp_path / "runs" / "pouring").iterdir()
    assert out.rstrip().endswith(str(path.relative_to(tmp_path)))
    record = json.loads((path / "run.json").read_text())
    assert record["status"] == "certified"
    assert record["strategy"] == "eprocess"
    assert record["seed"] == 3
    certificate = record["certificate"]
    assert certificate["certified"]
    assert certificate["fresh_instances"] == sum(record["rounds"][-1]["samples"])
    attempts = sum(r["verdict"]["attempted"] for r in record["rounds"])
    assert certificate["attempt"] == attempts
    assert certificate["delta_of_attempt"] == 0.05 / (attempts * (attempts + 1))
    assert f"attempt {attempts} to certify" in " ".join(out.split())
    assert len(record["demonstrations"]) == record["rounds"][-1]["demonstrations"]
    last = record["rounds"][-1]
    assert len(last["samples"]) == len(last["failure_rates"]) == 16
    assert max(last["failure_rates"]) < 1 - 0.7
    assert last["failure_rates"][last["weakest_region"]] == max(last["failure_rates"])
    for k in range(len(record["rounds"])):
        folder = path / f"round_{k + 1:02d}"
        for name in ("regions.csv", "instances.npz", "heat_map.png", "heat_map.svg"):
            assert (folder / name).stat().st_size > 0
    for name in ("scenario.yaml", "run.log", "meshcat.html", "rounds.png"):
        assert (path / name).stat().st_size > 0
    assert not list(path.rglob("*.part"))


def test_a_run_ends_with_1_when_the_budget_does(command):
    code, out, _ = command(
        "run", "pouring", *QUICK, *NAIVE, "--set", "demonstrations.budget=1", "--output", "here"
    )
    record = json.loads(Path("here/run.json").read_text())
    assert code == 1
    assert record["status"] == "insufficient"
    assert "budget of 1" in out
    assert record["certificate"]["certified"] is False
    worst = max(record["rounds"][-1]["failure_rates"])
    assert record["certificate"]["coverage"] == pytest.approx(max(0, 1 - 0.15 - worst))


def test_recordings_are_asked_and_run_out(command, library):
    code, out, _ = command(
        "run", "pouring", "--demonstrations", library, "--output", "here",
        "--set", "coverage.beta=0.98", "--set", "coverage.epsilon=0.015",
        "--set", "regions.grid.x=1", "--set", "regions.grid.y=1",
    )  # fmt: skip
    record = json.loads(Path("here/run.json").read_text())
    names = [d["name"] for d in record["demonstrations"]]
    assert sorted(names) == sorted(set(names))
    assert set(names) <= {p.name for p in library.iterdir()}
    assert code == (0 if record["status"] == "certified" else 1)
    if code == 1:
        assert "all 3 recordings are used" in " ".join(out.split()).lower()


def strip(record: dict) -> dict:
    times = ("started", "finished")
    return {k: v for k, v in record.items() if k not in times}


def test_an_interrupted_run_resumes_to_the_same_result(command, monkeypatch):
    from drake_screw.acquisition import Evaluator

    command("run", "scooping", *QUICK, "--seed", 1, "--output", "whole")
    original = Evaluator.evaluate

    def interrupted(self, round, demonstrations, attempt):
        if round == 1:
            raise KeyboardInterrupt
        return original(self, round, demonstrations, attempt)

    with monkeypatch.context() as patch:
        patch.setattr(Evaluator, "evaluate", interrupted)
        code, out, _ = command("run", "scooping", *QUICK, "--seed", 1, "--output", "parts")
    assert code == 130
    assert "--resume parts" in out
    stopped = json.loads(Path("parts/run.json").read_text())
    assert stopped["status"] == "interrupted"
    assert len(stopped["rounds"]) == 1
    code, _, _ = command("run", "--resume", "parts")
    whole, parts = (json.loads(Path(p, "run.json").read_text()) for p in ("whole", "parts"))
    assert code == 0
    assert strip(whole) == strip(parts)
    for file in Path("whole").rglob("*.npz"):
        a, b = np.load(file), np.load(Path("parts") / file.relative_to("whole"))
        assert all(np.array_equal(a[name], b[name]) for name in a.files)
    code, _, err = command("run", "--resume", "parts")
    assert code == 2
    assert "has ended" in err


def test_report_draws_again(command):
    command("run", "pouring", *QUICK, "--output", "here")
    for file in [*Path("here").rglob("*.png"), Path("here/meshcat.html")]:
        file.unlink()
    record = Path("here/run.json").read_text()
    code, out, _ = command("report", "here")
    assert code == 0
    assert "certificate" in out
    assert Path("here/meshcat.html").exists()
    assert Path("here/round_01/heat_map.png").exists()
    assert Path("here/run.json").read_text() == record


def test_evaluate_writes_a_code_for_each_instance_and_demonstration(command, library, places):
    code, out, _ = command(
        "evaluate", "pouring", "--demonstrations", library, "--instances", places,
        "--output", "out.csv",
    )  # fmt: skip
    assert code == 0
    rows = [line.split(",") for line in Path("out.csv").read_text().splitlines()]
    assert rows[0] == ["x", "y", "demo_01", "demo_02", "demo_03"]
    assert [row[:2] for row in rows[1:]] == [["0.8", "0.1"], ["0.9", "0.3"], ["1.07", "-0.23"]]
    cells = [cell for row in rows[1:] for cell in row[2:]]
    assert all(re.fullmatch(r"0:0|[1-9]:([1-7]|n|c)", cell) for cell in cells)
    assert rows[1][2] == "0:0", "a demonstration solves the place it was given at"
    assert "3 instances x 3 demonstrations" in out


def test_another_model_needs_only_the_arm(command, library, places, shared):
    calibrated = shared / "reference" / "baxter_left_calibrated.sdf"
    code, _, err = command(
        "evaluate", "pouring", "--demonstrations", library, "--instances", places,
        "--output", "out.csv", "--model", calibrated,
    )  # fmt: skip
    assert (code, err) == (0, "")
    assert Path("out.csv").read_text().count("0:0") >= 2


@pytest.mark.parametrize("task", ["pouring", "scooping"])
def test_evaluate_agrees_with_the_outcomes_of_another_planner(command, shared, task, tmp_path):
    lines = (shared / "reference" / f"outcomes_{task}.csv").read_text().splitlines()
    theirs = [line.split(",") for line in lines]
    places = tmp_path / "places.csv"
    places.write_text("\n".join(",".join(row[:2]) for row in theirs) + "\n")
    code, _, _ = command(
        "evaluate", task, "--demonstrations", shared / "demos" / task, "--instances", places,
        "--output", "out.csv", "--model", shared / "reference" / "baxter_left_calibrated.sdf",
    )  # fmt: skip
    assert code == 0
    ours = [line.split(",") for line in Path("out.csv").read_text().splitlines()]
    assert ours[0] == theirs[0]
    a, b = (np.array([row[2:] for row in rows[1:]]) for rows in (ours, theirs))
    assert ((a == "0:0") == (b == "0:0")).mean() >= 0.994
    both = (a != "0:0") & (b != "0:0")
    segment = [np.array([c.split(":")[0] for c in codes[both]]) for codes in (a, b)]
    assert (segment[0] == segment[1]).mean() >= 0.97


def test_check_tells_what_would_run(command):
    code, out, _ = command("check", "pouring", *NAIVE)
    assert code == 0
    assert "K = 16" in out
    assert "32,308 in each region, 516,928 a round" in out
    assert re.search(r"about [\d,]+ s a round", out)
    code, out, _ = command("check", "pouring")
    assert code == 0
    assert "strategy   eprocess" in out
    assert "1,440 in a first round where nothing fails (90 in each region)" in " ".join(out.split())


def test_a_run_can_be_looked_at_exported_and_executed(command):
    command("run", "pouring", *QUICK, "--output", "here", "-q")
    code, out, _ = command("inspect", "here", "--html", "page.html", "--round", 1)
    assert code == 0
    assert Path("page.html").stat().st_size > 1e6
    assert Path("page.csv").exists()
    code, _, _ = command("export", "here", "--instance", 0.85, 0.2, "--output", "plan.csv")
    assert code == 0
    assert Path("plan.csv").read_text().startswith("time,left_s0")
    code, out, _ = command("execute", "here", "--instance", 0.85, 0.2, "--workers", 1)
    assert code == 0
    assert re.search(r"done +1 of 1", out)
    code, out, _ = command("report", "here")
    assert code == 0
    assert Path("here/report.html").stat().st_size > 1e4


def test_a_study_can_be_small(command, library):
    code, out, _ = command(
        "study", "pouring", "--demonstrations", library, "--regions", "1,2", "--runs", 2,
        "--workers", 1, "--output", "study", *QUICK,
    )  # fmt: skip
    assert code == 0
    assert len(Path("study/runs.csv").read_text().splitlines()) == 5
    assert "study directory: study" in out


VERBS = ["run", "evaluate", "check", "report", "study", "inspect", "execute", "export"]


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help_with_an_example(command, verb):
    code, out, _ = command(verb, "--help")
    assert code == 0
    assert f"drake-screw {verb}" in out.split("Example:")[1]


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
def test_bad_recordings_are_refused_with_their_place(command, library, tmp_path, change, expected):
    spoilt = spoil(library, tmp_path / "spoilt", change)
    code, out, err = command("run", "pouring", "--demonstrations", spoilt)
    assert code == 2
    assert re.search(expected, err)
    assert (out, Path("runs").exists()) == ("", False)


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
        (["run", "pouring", "--demonstrations", "nowhere"], "no such folder"),
        (["run", "pouring", "--set", "coverage.options.rope=1"], "rope"),
        (["run"], "no scenario"),
        (["run", "--resume", "nowhere"], "not a run directory"),
        (["run", "pouring", "--host", "0.0.0.0"], "this run has none"),
        (["run", "pouring", "--meshcat", "--port", "99999"], "cannot serve on localhost"),
        (["run", "pouring", "--set", "meshcat=2"], "meshcat"),
        (["run", "pouring", "--resume", "nowhere"], "--resume goes alone"),
        (["report", "nowhere"], "not a run directory"),
        (["fly"], "No such command"),
    ],
)
def test_wrong_input_ends_with_2_and_one_message(command, args, expected):
    code, _, err = command(*args)
    assert code == 2
    assert expected in err
    assert "Traceback" not in err
    assert not Path("runs").exists()


@pytest.mark.skipif(os.getuid() == 0, reason="root may write everywhere")
def test_an_unwritable_output_is_refused_as_a_user(command, tmp_path):
    tmp_path.chmod(0o500)
    code, _, err = command("run", "pouring", "--output", tmp_path / "sub")
    assert (code, "cannot be written" in err) == (2, True)


def test_an_output_that_cannot_be_made_is_refused(command):
    Path("file").write_text("in the way")
    code, _, err = command("run", "pouring", "--output", "file/sub")
    assert code == 2
    assert "cannot be written" in err
    code, _, err = command("run", "pouring", "--output", "file")
    assert code == 2
    assert "exists already" in err
    assert Path("file").read_text() == "in the way"


def test_the_installed_program_runs_from_anywhere(tmp_path):
    program = Path(sys.executable).with_name("drake-screw")
    done = subprocess.run(
        [program, "check", "scooping"], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "scooping" in done.stdout
