"""``--instance``: objects by their names on the command line; just numbers for a single one."""

from __future__ import annotations

import csv
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from drake_screw import new_run
from drake_screw.acquisition import Suggestion
from drake_screw.runs import executions, trajectory
from tests.commands.conftest import Command
from tests.commands.test_help import python
from tests.small_runs import two_objects

AT = np.array([[0.85, 0.3, 0.0], [0.75, -0.4, 0.2]])
BOWL, CUP = "bowl=0.9,0.35", "cup=0.72,-0.4,-0.3"
NAMED = {"bowl": (0.9, 0.35), "cup": (0.72, -0.4, -0.3)}


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of two objects, of which one may be turned, with one demonstration."""
    folder = tmp_path_factory.mktemp("two") / "run"
    run = new_run(two_objects(["regions={adaptive: {}}"]), folder)
    lesson = run.setup.teacher.demonstrate(
        Suggestion(0, AT), number=0, used=(), rng=np.random.default_rng(1)
    )
    assert lesson.recording is not None, lesson.remark
    run.directory.add_demonstration(0, lesson.recording, "", run.setup.scenario.robot.parked)
    return folder


def test_two_objects_are_exported(command: Command, two: Path) -> None:
    code, out, _ = command(
        "export", two, "--instance", BOWL, CUP, "--output", "one.npz", "--format", "npz"
    )
    assert code == 0
    assert out.startswith("planned with demo_01")
    assert "outside" not in out
    trajectory.write_trajectory(two, [*NAMED["bowl"], 0.0, *NAMED["cup"]], "npz", "two.npz")
    trajectory.write_trajectory(two, NAMED | {"bowl": (0.85, 0.3)}, "npz", "moved.npz")
    one, same, moved = (np.load(f"{name}.npz") for name in ("one", "two", "moved"))
    np.testing.assert_array_equal(one["q"], same["q"])
    assert np.abs(one["q"][-1] - moved["q"][-1]).max() > 0.01, "the plan is of this place"


def test_two_objects_are_executed(command: Command, two: Path) -> None:
    code, out, _ = command("execute", two, "--instance", CUP, BOWL, "--workers", 1)
    assert code == 0
    assert "done                       1 of 1" in out
    (file,) = (two / "executions").glob("*/executions.csv")
    (row,) = csv.DictReader(file.open())
    place = [float(row[f"{name}.{axis}"]) for name in NAMED for axis in ("x", "y", "yaw")]
    assert place == [*NAMED["bowl"], 0.0, *NAMED["cup"]]
    assert (row["demonstration"], row["status"], row["contacts"]) == ("demo_01", "done", "")


@pytest.mark.parametrize(
    ("words", "message", "remedy"),
    [
        ([BOWL], "no place is given for 'cup', and it varies", "Give bowl=X,Y cup=X,Y,YAW, with"),
        ([BOWL, "cup=0.7,-0.4"], "no yaw is given for 'cup', and it varies", "cup=X,Y,YAW, with"),
        ([BOWL, CUP, "cub=1,2"], "no object 'cub' in this scenario", "Did you mean 'cup'?"),
        (["bowl.x=0.9", "bowl.y=0.3"], "no object 'bowl.x'", "Did you mean 'bowl'?"),
        (["bowl=0.9", CUP], "'bowl' is given 1 number, expected x, y and perhaps yaw", "Give bowl"),
        (
            ["bowl=0.9,nan", CUP],
            "y of 'bowl' is nan, expected a number from -1000 to 1000",
            "X and Y in m",
        ),
        (["0.9", "0.3"], "an instance of 2 numbers, and there are 2 objects", "Give bowl=X,Y cup"),
    ],
)
def test_what_is_no_instance_of_two_objects_says_what_is(
    command: Command, two: Path, words: list[str], message: str, remedy: str
) -> None:
    code, out, err = command("export", two, "--instance", *words, "--output", "plan.csv")
    assert (code, out) == (2, "")
    assert message in err
    assert remedy in err
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize(
    ("words", "message", "remedy"),
    [
        ([BOWL, CUP, BOWL], "'bowl' is given twice", "Give each object once."),
        (["bowl=0.9,b"], "bowl=0.9,b: 'b' is not a number", "Give bowl=X,Y or bowl=X,Y,YAW"),
        (["bowl=0.9,", "0.3"], "bowl=0.9,: a number is missing", "without a space in it"),
        (["bowl="], "bowl=: a number is missing", "Give bowl=X,Y"),
        ([BOWL, "cup"], "expected OBJECT=X,Y or OBJECT=X,Y,YAW, found 'cup'", "without a space"),
        ([BOWL, "0.7", "0.1"], "expected OBJECT=X,Y or OBJECT=X,Y,YAW, found '0.7'", "Give"),
        (["=0.9,0.3"], "expected OBJECT=X,Y or OBJECT=X,Y,YAW, found '=0.9,0.3'", "Give"),
        (["0.9,0.3"], "--instance 0.9,0.3: '0.9,0.3' is not a number", "X Y will do for"),
        (["0.9", "O.3"], "--instance 0.9 O.3: 'O.3' is not a number", "Give OBJECT=X,Y"),
        (["0.9", "0.3", "0.0", "1"], "expected x, y and perhaps yaw of a single object", "Give"),
        ([], "--instance is given no place", "Give OBJECT=X,Y"),
    ],
)
@pytest.mark.parametrize("verb", ["export", "execute"])
def test_words_that_are_no_places_are_refused_before_the_run_is_read(
    command: Command, verb: str, words: list[str], message: str, remedy: str
) -> None:
    output = ["--output", "x"] if verb == "export" else []
    code, out, err = command(verb, "nowhere", "--instance", *words, *output)
    assert (code, out) == (2, "")
    assert err.startswith("error: ")
    assert message in err
    assert remedy in err
    assert list(Path().iterdir()) == []


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What export and execute would be asked for, each time: the run and the instance."""
    asked: list[Any] = []

    def write(run: Path, instance: Any, format: str, output: Path) -> str:
        asked.append((str(run), instance, str(output)))
        return ""

    def execute(run: Path, *, instance: Any, **others: Any) -> SimpleNamespace:
        asked.append((str(run), instance))
        return SimpleNamespace(summary=SimpleNamespace(flawless=1))

    monkeypatch.setattr(trajectory, "write_trajectory", write)
    monkeypatch.setattr(executions, "execute", execute)
    return asked


@pytest.mark.parametrize(
    "args",
    [
        ["run", "--instance", BOWL, CUP, "--output", "x"],
        ["run", "--output", "x", "--instance", BOWL, CUP],
        ["--instance", BOWL, CUP, "--output", "x", "run"],
        ["--output", "x", "--instance", BOWL, CUP, "run"],
        ["--instance", BOWL, CUP, "run", "--output", "x"],
        ["--output", "x", "--instance", BOWL, CUP, "--", "run"],
        ["run", "--instance", BOWL, "--output", "x", "--instance", CUP],
        ["run", f"--instance={BOWL}", CUP, "--output=x"],
    ],
)
def test_words_belong_to_the_option_up_to_the_next_and_the_run_may_be_last(
    command: Command, given: list[Any], args: list[str]
) -> None:
    assert command("export", *args)[0] == 0
    assert given == [("run", NAMED, "x")]


@pytest.mark.parametrize(
    ("words", "numbers"),
    [
        (["0.9", "0.3"], (0.9, 0.3)),
        (["0.9", "-0.3"], (0.9, -0.3)),
        (["-.9", "-3e-1", "-0.5"], (-0.9, -0.3, -0.5)),
    ],
)
def test_a_single_object_is_given_by_two_or_three_numbers(
    command: Command, given: list[Any], words: list[str], numbers: tuple[float, ...]
) -> None:
    assert command("execute", "run", "--instance", *words, "--workers", 1)[0] == 0
    assert command("execute", "--instance", *words, "run")[0] == 0
    assert given == [("run", numbers)] * 2


def test_without_the_option_instances_are_drawn(command: Command, given: list[Any]) -> None:
    assert command("execute", "run")[0] == 0
    assert given == [("run", None)]


@pytest.mark.parametrize(("words", "incomplete"), [([BOWL, CUP], "--w"), ([], "")])
def test_shells_complete_behind_it(words: list[str], incomplete: str) -> None:
    line = ["drake-screw", "execute", "run", "--instance", *words]
    done = python(
        "import sys; sys.argv[0] = 'drake-screw'; from drake_screw.cli import main; main()",
        _DRAKE_SCREW_COMPLETE="complete_bash",
        COMP_WORDS=" ".join([*line, incomplete]),
        COMP_CWORD=str(len(line)),
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.split() == (["--workers"] if words else [])
