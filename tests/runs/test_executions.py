"""Executing and exporting plans of a run: what the commands of these names do."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drake_screw.acquisition import Suggestion
from drake_screw.errors import DrakeScrewError, PluginError, RunDirectoryError, ScenarioError
from drake_screw.runs.executions import execute
from drake_screw.runs.run import new_run, open_run
from drake_screw.runs.trajectory import write_trajectory
from drake_screw.scenario.loader import load_scenario

PLACE = (0.85, 0.3)
OUTSIDE = (1.6, 0.3)


def contents(folder: Path) -> dict[str, bytes]:
    return {str(f.relative_to(folder)): f.read_bytes() for f in folder.rglob("*") if f.is_file()}


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    """A run that has one demonstration by the simulated teacher, and one region."""
    scenario = load_scenario("pouring", ["regions.grid={x: 1}", "objects.0.symmetry=null"])
    run = new_run(scenario, tmp_path_factory.mktemp("runs") / "run")
    at = np.array([[*PLACE, 0.0]])
    lesson = run.setup.teacher.demonstrate(
        Suggestion(0, at), number=0, used=(), rng=np.random.default_rng(1)
    )
    assert lesson.recording is not None
    recording = replace(lesson.recording, name="shown")
    run.directory.add_demonstration(0, recording, "", scenario.robot.parked)
    return run.directory.path


@pytest.fixture(scope="module")
def executed(run) -> tuple[str, Path, dict[str, bytes]]:
    """The summary of an execution, its folder, and the run's files before it."""
    before = contents(run)
    text = str(execute(run, instance=PLACE, workers=1))
    (folder,) = (run / "executions").iterdir()
    return text, folder, before


def test_an_instance_is_executed_and_reported(executed) -> None:
    text, folder, _ = executed
    assert "1 instance, 1 executed" in text
    assert "done                       1 of 1" in text
    assert text.endswith(f"written to {folder}")
    assert sorted(f.name for f in folder.iterdir()) == [
        "executions.csv",
        "executions.html",
        "summary.txt",
    ]
    (row,) = csv.DictReader((folder / "executions.csv").open())
    assert (row["demonstration"], row["status"]) == ("shown", "done")
    assert row["contacts"] == row["outside_limits"] == ""
    assert float(row["velocity_over_limit"]) <= 1.0
    assert float(row["tracking_mm"]) < 5.0
    assert float(row["tracking_mrad"]) < 20.0
    assert float(row["final_mm"]) < 2.0
    assert float(row["final_mrad"]) < 10.0


def test_objects_can_be_pushed_and_are_not(run, tmp_path) -> None:
    told = []
    done = execute(
        run,
        instance=PLACE,
        workers=1,
        free_objects=True,
        tell=lambda step: told.append((step.done, step.total)),
    )
    assert told == [(0, 1), (1, 1)]
    text, summary = str(done), done.summary
    assert "pushed an object           0" in text
    assert "objects moved              at most 0.00 mm, 0.00 mrad" in text
    assert (summary.executed, summary.pushed, summary.off_the_way) == (1, 0, 0)
    (row,) = csv.DictReader((done.folder / "executions.csv").open())
    name, moved = row["moved_mm"].split()
    assert name == "bowl"
    assert float(moved) < 0.01
    assert (done.folder / "executions.html").stat().st_size > 100_000


def test_the_runs_own_files_stay_as_they_are(run, executed) -> None:
    _, _, before = executed
    after = contents(run)
    assert {name: after[name] for name in before} == before
    assert all(name.startswith("executions/") for name in after.keys() - before.keys())


@pytest.mark.slow
def test_fresh_instances_are_drawn_until_enough_are_executed(run, executed) -> None:
    """The one demonstration does not solve the whole area; what it does not is told."""
    text = str(execute(run, per_region=1, workers=1))
    first = text.splitlines()[0]
    drawn, done = int(first.split()[0]), int(first.split()[2])
    assert done == 1
    assert text.count("no plan: ") == drawn - done


def test_an_instance_without_a_plan_is_told_with_its_reason(run) -> None:
    text = str(execute(run, instance=OUTSIDE, workers=1))
    assert "1 instance, 0 executed" in text
    assert "no plan: with shown, " in text
    assert "segment" in text


@pytest.mark.parametrize("format", ["baxter-csv", "ros-trajectory", "npz"])
def test_a_plan_is_exported(run, tmp_path, format) -> None:
    file = tmp_path / "plan"
    text = str(write_trajectory(run, PLACE, format, file))
    assert text.startswith("planned with shown: ")
    assert text.endswith(f"written to {file}")
    assert file.stat().st_size > 1000
    assert list(tmp_path.iterdir()) == [file]


def test_exports_start_where_the_scenario_does(run, tmp_path) -> None:
    write_trajectory(run, PLACE, "npz", tmp_path / "plan.npz")
    with np.load(tmp_path / "plan.npz") as data:
        np.testing.assert_allclose(data["q"][0], open_run(run).setup.workcell.start)
        assert data["t"][-1] > 1.0


def test_an_instance_by_name_is_that_of_the_numbers(run, tmp_path) -> None:
    for name, instance in ("one", PLACE), ("other", {"bowl": (*PLACE, 0.0)}):
        write_trajectory(run, instance, "npz", tmp_path / name)
    assert (tmp_path / "one").read_bytes() == (tmp_path / "other").read_bytes()
    with pytest.raises(ScenarioError, match="no object 'bowll'") as error:
        execute(run, instance={"bowll": PLACE}, workers=1)
    assert "Did you mean 'bowl'?" in str(error.value)


def test_an_export_where_there_is_no_plan_says_why(run, tmp_path) -> None:
    with pytest.raises(ScenarioError, match="no demonstration gives a plan there"):
        write_trajectory(run, OUTSIDE, "npz", tmp_path / "plan.npz")
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_format_names_those_there_are(run, tmp_path) -> None:
    with pytest.raises(PluginError, match="Did you mean 'baxter-csv'") as error:
        write_trajectory(run, PLACE, "baxter_csv", tmp_path / "plan")
    assert "ros-trajectory" in str(error.value)


def test_an_export_into_nowhere_is_refused(run, tmp_path) -> None:
    with pytest.raises(RunDirectoryError, match="cannot be written"):
        write_trajectory(run, PLACE, "npz", tmp_path / "missing" / "plan.npz")


def test_known_demonstrations_have_the_runs_names(run) -> None:
    (demonstration,) = open_run(run).demonstrations
    assert demonstration.name == "shown"


def test_a_run_without_demonstrations_says_so(tmp_path) -> None:
    run = new_run(load_scenario("pouring"), tmp_path / "run").directory.path
    with pytest.raises(RunDirectoryError, match="no demonstrations yet"):
        execute(run)
    assert not (run / "executions").exists()


def test_what_is_no_run_is_refused(tmp_path) -> None:
    with pytest.raises(DrakeScrewError, match="not a run directory"):
        execute(tmp_path)
