"""Studies: the grids, the runs, and that interruptions and workers make no difference."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from drake_screw.acquisition import Finished, RoundFinished, Suggestion, acquire
from drake_screw.assembly.setup import Setup
from drake_screw.commands.study_console import show_study
from drake_screw.demonstrations import write_recording
from drake_screw.errors import RunDirectoryError, ScenarioError
from drake_screw.planning import connection
from drake_screw.scenario.loader import load_scenario
from drake_screw.studies.experiment import Experiment, numbers_of_regions, run_seed, split
from drake_screw.studies.hidden_failures import EACH, find_hidden_failures
from drake_screw.studies.study import (
    RUNS,
    STUDY,
    SUMMARY,
    Study,
    new_study,
    open_study,
)
from drake_screw.tasks import ObjectArea, WorkArea

TABLE = WorkArea((ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), 0.0),))
REGIONS, COUNT = (1, 4), 4


@pytest.fixture(scope="module")
def scenario(tmp_path_factory):
    """Pouring with a low goal, asked of three recordings by the simulated teacher."""
    setup = Setup(load_scenario("pouring"))
    folder = tmp_path_factory.mktemp("library")
    for number, (x, y) in enumerate([(0.8, 0.1), (0.95, 0.35), (0.85, 0.6)]):
        place = np.array([[x, y, 0.0]])
        lesson = setup.teacher.demonstrate(
            Suggestion(0, place), number=number, used=(), rng=np.random.default_rng(number)
        )
        assert lesson.recording is not None, lesson.remark
        write_recording(lesson.recording, folder / f"demo_{number}")
    changes = ["coverage.beta=0.7", "coverage.epsilon=0.15", "seed=5"]
    return load_scenario(
        "pouring", [*changes, "teacher={kind: recorded}", f"teacher.folder={folder}"]
    )


@pytest.fixture(scope="module")
def finished(scenario, tmp_path_factory):
    study = new_study(scenario, REGIONS, COUNT, tmp_path_factory.mktemp("studies") / "whole")
    assert len(list(study.carry_out(1))) == len(REGIONS) * COUNT
    return study


def rows(file: Path) -> list[dict[str, str]]:
    with file.open() as lines:
        return list(csv.DictReader(lines))


@pytest.mark.parametrize(
    ("K", "counts"),
    [(1, (1, 1)), (2, (1, 2)), (4, (2, 2)), (8, (2, 4)), (16, (4, 4)), (6, (2, 3)), (7, (1, 7))],
)
def test_factors_go_to_the_axes_in_turn_the_longest_first(K, counts) -> None:
    regions = split(TABLE, K)
    assert regions.K == K
    assert tuple(regions.counts[0]) == (*counts, 1)


def test_yaws_are_split_last_and_fixed_axes_never() -> None:
    cup = ObjectArea("cup", (0.5, 0.0, -3.0), (0.5, 0.3, 3.0), 0.0)
    regions = split(WorkArea((*TABLE.objects, cup)), 16)
    assert regions.counts.tolist() == [[2, 2, 1], [1, 2, 2]]


def test_a_work_area_without_room_cannot_be_split() -> None:
    fixed = WorkArea((ObjectArea("bowl", (1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.0),))
    assert split(fixed, 1).K == 1
    for area, K in ((fixed, 2), (TABLE, 0), (TABLE, -4)):
        with pytest.raises(ScenarioError, match="cannot be split"):
            split(area, K)


def test_every_run_has_a_seed_of_its_own() -> None:
    seeds = {run_seed(s, K, i) for s in (0, 1) for K in (0, 1, 2, 16) for i in range(50)}
    assert len(seeds) == 2 * 4 * 50


def test_a_run_of_a_study_is_the_ordinary_run_with_its_seed_and_grid(scenario) -> None:
    kept = Experiment(scenario).run(4, 1)
    changes = ["coverage.beta=0.7", "coverage.epsilon=0.15", "regions={grid: {x: 2, y: 2}}"]
    changes += ["teacher={kind: recorded}", f"teacher.folder={scenario.teacher.folder}"]
    setup = Setup(load_scenario("pouring", [*changes, f"seed={kept.seed}"]))
    events = list(
        acquire(
            setup.evaluator().evaluate,
            setup.teacher,
            setup.learn,
            setup.regions,
            initial=1,
            budget=12,
            seed=kept.seed,
            first=setup.first,
        )
    )
    end = events[-1]
    rounds = [e for e in events if isinstance(e, RoundFinished)]
    assert isinstance(end, Finished)
    assert (kept.status, kept.names) == (end.status, tuple(d.name for d in end.demonstrations))
    assert kept.rounds == len(rounds)
    assert kept.samples == sum(e.verdict.total_samples for e in rounds)


def test_what_a_study_leaves(finished) -> None:
    table = rows(finished.path / RUNS)
    places = [(int(row["K"]), int(row["run"])) for row in table]
    assert places == [(K, i) for K in REGIONS for i in range(COUNT)]
    assert len({row["seed"] for row in table}) == len(table)
    for row in table:
        names = row["names"].split(";")
        assert len(names) == int(row["demonstrations"]) == len(set(names))
        assert int(row["rounds"]) >= 1
        assert int(row["samples"]) >= 16 * int(row["K"])
    for row in rows(finished.path / SUMMARY):
        same = [r for r in table if r["K"] == row["K"] and r["status"] == "certified"]
        alike = [r for r in same if r["demonstrations"] == row["demonstrations"]]
        assert int(row["runs"]) == len(alike) > 0
        assert float(row["probability"]) == pytest.approx(len(alike) / COUNT)
        assert int(row["max"]) == max(int(r["demonstrations"]) for r in same)
        assert int(row["not_certified"]) == COUNT - len(same)
    for name in ("distributions", "hidden_pocket"):
        assert (finished.path / f"{name}.png").stat().st_size > 0
        assert (finished.path / f"{name}.svg").stat().st_size > 0
    record = json.loads((finished.path / STUDY).read_text())
    assert (record["status"], record["regions"], record["runs"]) == ("finished", [1, 4], COUNT)
    assert not list(finished.path.glob(".*.part"))


@pytest.mark.slow
def test_an_interrupted_study_resumes_to_the_same_result(scenario, finished, tmp_path) -> None:
    path = tmp_path / "parts"
    running = new_study(scenario, REGIONS, COUNT, path).carry_out(1)
    for _ in range(3):
        next(running)
    running.close()
    assert json.loads((path / STUDY).read_text())["status"] == "interrupted"
    assert not (path / SUMMARY).exists()
    assert len(rows(path / RUNS)) == 3
    with (path / RUNS).open("a") as lines:
        lines.write("4,3,123,certif")
    resumed = open_study(path)
    assert len(list(resumed.carry_out(1))) == len(REGIONS) * COUNT - 3
    for name in (RUNS, SUMMARY, "distributions.svg", "hidden_pocket.svg"):
        assert (path / name).read_bytes() == (finished.path / name).read_bytes(), name
    assert list(open_study(path).carry_out(1)) == []


@pytest.mark.slow
def test_workers_make_no_difference(scenario, finished, tmp_path) -> None:
    study = new_study(scenario, REGIONS, COUNT, tmp_path / "shared")
    found = list(study.carry_out(2))
    assert sorted(found, key=lambda run: (run.K, run.run)) == list(study.finished_runs())
    assert (study.path / RUNS).read_bytes() == (finished.path / RUNS).read_bytes()


def test_hidden_failures_are_of_the_demonstrations_that_few_regions_certified(finished) -> None:
    runs = finished.finished_runs()
    found = find_hidden_failures(finished.experiment, runs)
    names = [run.names for run in runs if run.K == 1 and run.certified]
    assert len(found) == len(names) > 0
    assert [p.worst for p in found] == sorted(p.worst for p in found)
    for one in found:
        assert tuple(d.name for d in one.fine.demonstrations) in names
        assert one.coarse.verdict.certified
        assert one.fine.verdict.samples.tolist() == [EACH] * 4
        whole = one.fine.verdict.estimates.mean()
        assert whole <= one.worst
        assert one.fine.verdict.certified == (one.fine.verdict.coverage >= 0.7)
    few = [run for run in runs if run.K == 4]
    assert find_hidden_failures(finished.experiment, few) == ()


def test_the_terminal_shows_every_K(finished) -> None:
    console = Console(record=True, width=120)
    show_study(finished, console, workers=1)
    lines = console.export_text().splitlines()
    for K in REGIONS:
        certified = sum(r.certified for r in finished.finished_runs() if r.K == K)
        assert any(line.split()[:3] == [str(K), str(COUNT), str(certified)] for line in lines)
    assert str(finished.path) in "".join(lines)


def test_lists_of_regions() -> None:
    assert numbers_of_regions("1,2, 16") == (1, 2, 16)
    for text in ("", "1,,2", "four", "1.5"):
        with pytest.raises(ScenarioError, match="not a list"):
            numbers_of_regions(text)


def test_bad_requests_write_nothing(scenario, tmp_path) -> None:
    for regions, runs in (((), 3), ((1,), 0), ((1, 0), 3)):
        with pytest.raises(ScenarioError):
            new_study(scenario, regions, runs, tmp_path / "none")
    asking = load_scenario("pouring", ["teacher={kind: interactive}"])
    with pytest.raises(ScenarioError, match="would be asked in every run"):
        new_study(asking, (1,), 3, tmp_path / "none")
    assert not (tmp_path / "none").exists()
    (tmp_path / "file").write_text("in the way")
    for output in (tmp_path, tmp_path / "file", tmp_path / "file" / "sub"):
        with pytest.raises(RunDirectoryError):
            new_study(scenario, (1,), 1, output)


STUDY_OF = '{{"format": 1, "hashes": {{"model": "x"}}, "regions": {}, "runs": {}}}'


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        (STUDY, None, "not a study directory"),
        (STUDY, "{", "damaged"),
        (STUDY, "{}", "damaged"),
        (STUDY, "[" * 100_000, "damaged"),
        (STUDY, STUDY_OF.format("[[1]]", 2), "damaged: regions and runs are not whole numbers"),
        (STUDY, STUDY_OF.format("[1]", "true"), "damaged: regions and runs are not whole numbers"),
        (RUNS, f"{'x' * 140_000},b\n", "damaged: field larger than"),
        (RUNS, "a,b\n", "unknown columns"),
        (RUNS, "", "damaged"),
    ],
)
def test_damaged_studies_are_refused(scenario, tmp_path, name, text, message) -> None:
    path = new_study(scenario, (1,), 1, tmp_path / "study").path
    if text is None:
        (path / name).unlink()
    else:
        (path / name).write_text(text)
    with pytest.raises(RunDirectoryError, match=message):
        list(open_study(path).carry_out(1))


@pytest.mark.parametrize(
    ("before", "said"),
    [(True, r"study.*begun with OMPL.*not installed now"), (False, r"begun without OMPL")],
)
def test_a_study_goes_on_only_where_the_arm_is_led_around_as_before(
    scenario, tmp_path, monkeypatch, before, said
) -> None:
    monkeypatch.setattr(connection, "available", lambda: before)
    planner = scenario.planner.model_copy(update={"approach": "free", "collision": True})
    free = scenario.model_copy(update={"planner": planner})
    path = new_study(free, (1,), 1, tmp_path / "study").path
    stored = (path / STUDY).read_text()
    assert json.loads(stored)["led_around"] is before
    monkeypatch.setattr(connection, "available", lambda: not before)
    with pytest.raises(RunDirectoryError, match=said) as error:
        list(open_study(path).carry_out(1))
    assert "begin the study again" in str(error.value.remedy).lower()
    assert (path / STUDY).read_text() == stored


def test_a_finished_study_or_one_from_before_ompl_was_noted_is_opened_anyway(
    finished, monkeypatch
) -> None:
    assert finished.record["led_around"] is None
    planner = finished.scenario.planner.model_copy(update={"approach": "free", "collision": True})
    free = finished.scenario.model_copy(update={"planner": planner})
    for before, runs in ((True, COUNT), (None, COUNT + 1)):
        monkeypatch.setattr(connection, "available", lambda: False)
        record = finished.record | {"led_around": before, "runs": runs}
        study = Study(finished.path, free, record)
        monkeypatch.setattr("drake_screw.studies.study.shared_runs", lambda *_: iter(()))
        monkeypatch.setattr(Study, "_conclude", lambda _: None)
        monkeypatch.setattr(Study, "_save", lambda *_: None)
        assert list(study.carry_out(1)) == []


def test_a_study_is_not_carried_on_with_another_robot(scenario, tmp_path) -> None:
    path = new_study(scenario, (1,), 1, tmp_path / "study").path
    record = json.loads((path / STUDY).read_text())
    record["hashes"]["model"] = "0" * 64
    (path / STUDY).write_text(json.dumps(record))
    with pytest.raises(RunDirectoryError, match="has changed"):
        open_study(path)
