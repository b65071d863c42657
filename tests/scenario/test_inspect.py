"""Looking at a finished run, without a browser."""

from __future__ import annotations

import csv
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from drake_screw.errors import RunDirectoryError, ScenarioError
from drake_screw.planning import Cause
from drake_screw.scenario.choice import changed, choose, steps
from drake_screw.scenario.inspect import inspect, instance_table
from drake_screw.scenario.inspection import open_inspection
from tests.small_runs import finished_run

__all__ = ["finished_run"]


@pytest.fixture(scope="module")
def inspection(finished_run):
    return open_inspection(finished_run)


@pytest.fixture
def copy(finished_run, tmp_path) -> Path:
    return Path(shutil.copytree(finished_run, tmp_path / "copy"))


def test_it_begins_at_the_suggested_instance(inspection) -> None:
    choice = choose(inspection, 1)
    event = inspection.event(1)
    assert np.array_equal(event.evaluation.x_y_yaw[choice.instance], event.suggestion.x_y_yaw)
    assert event.evaluation.failed[choice.instance]


def test_plans_end_as_the_run_found(inspection) -> None:
    event = inspection.event(1)
    agree = 0
    for instance in np.flatnonzero(event.evaluation.failed)[::60]:
        for tried in inspection.attempts(1, int(instance)):
            found = event.evaluation.outcomes[instance][tried.number]
            same = int(found.segment) == tried.failed_segment and found.cause == tried.cause
            close = abs(float(found.fraction) - float(tried.plan.outcome.fraction)) < 0.02
            agree += bool(same and close)
            assert len(tried.guides) == len(tried.status)
    total = 2 * len(np.flatnonzero(event.evaluation.failed)[::60])
    assert agree >= 0.9 * total


def test_the_best_demonstration_is_shown_first(inspection) -> None:
    event = inspection.event(1)
    success = event.evaluation.outcomes.success
    for instance in np.flatnonzero(success.any(axis=1))[:20]:
        assert success[instance, inspection.best(1, int(instance))]


def test_steps_go_through_the_failing_instances_of_a_region(inspection) -> None:
    choice = changed(inspection, choose(inspection, 0), {"region": 15})
    event, seen = inspection.event(0), []
    for _ in range(5):
        assert event.evaluation.region[choice.instance] == 15
        assert event.evaluation.failed[choice.instance]
        seen.append(choice.instance)
        choice = changed(inspection, choice, {"step": "next"})
    assert len(set(seen)) == 5
    furthest = event.evaluation.outcomes[seen].furthest_segment
    assert (np.diff(furthest) >= 0).all()
    assert changed(inspection, choice, {"step": "previous"}).instance == seen[-1]
    assert changed(inspection, choice, {"step": "earliest"}).instance == seen[0]


def test_a_point_on_the_map_leads_to_the_nearest_failing_instance(inspection) -> None:
    choice = choose(inspection, 0)
    event = inspection.event(0)
    wanted = event.evaluation.x_y_yaw[np.flatnonzero(event.evaluation.failed)[100], 0]
    moved = changed(inspection, choice, {"at": [float(wanted[0]), float(wanted[1])]})
    assert np.allclose(event.evaluation.x_y_yaw[moved.instance, 0, :2], wanted[:2])


@pytest.mark.parametrize(
    "message",
    [
        {},
        {"round": 7},
        {"round": "1"},
        {"step": "sideways"},
        {"demonstration": -1},
        {"demonstration": 9},
        {"at": [1.0]},
        {"region": 999},
        {"region": "x"},
    ],
)
def test_nonsense_changes_nothing(inspection, message) -> None:
    choice = choose(inspection, 1)
    assert changed(inspection, choice, message) == choice


def test_a_round_without_failures_offers_no_earliest(inspection, monkeypatch) -> None:
    event = inspection.event(0)
    fine = np.flatnonzero(~event.evaluation.failed)
    part = replace(
        event.evaluation,
        x_y_yaw=event.evaluation.x_y_yaw[fine],
        region=event.evaluation.region[fine],
        outcomes=event.evaluation.outcomes[fine],
    )
    other = open_inspection(inspection.run.directory.path)
    monkeypatch.setattr(other, "event", lambda round: replace(event, evaluation=part))
    choice = choose(other, 0)
    assert part.outcomes.any_success[choice.instance]
    assert set(steps(other, choice)) <= {"previous", "next"}


def test_the_command_tells_every_demonstration(finished_run, tmp_path) -> None:
    console = Console(width=200, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
    page = tmp_path / "deep" / "page.html"
    inspect(finished_run, console, round=2, html=page)
    text = console.export_text()
    assert "round 2, instance" in text
    assert re.search(r"demonstration 1 (fails|succeeds) in", text)
    assert re.search(r"demonstration 2 (fails|succeeds) in", text)
    record = json.loads(page.with_suffix(".json").read_text())
    assert [a["demonstration"] for a in record["attempts"]] == [0, 1]
    with page.with_suffix(".csv").open() as file:
        rows = list(csv.DictReader(file))
    last = [row for row in rows if row["demonstration"] == "0"][-1]
    for name, end in record["attempts"][0]["end"].items():
        assert float(last[name]) == pytest.approx(end["angle"], abs=1e-6)
        assert float(last[f"{name}_margin"]) == pytest.approx(end["margin"], abs=1e-6)
    assert not re.search(r"<(script|img|link|iframe)[^>]*\s(src|href)\s*=", page.read_text())


def test_the_table_names_segment_and_joint(inspection) -> None:
    event = inspection.event(0)
    limit = event.evaluation.outcomes.cause[:, 0] == Cause.JOINT_LIMIT
    attempts = inspection.attempts(0, int(np.flatnonzero(limit)[0]))
    console = Console(width=160, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
    console.print(instance_table(attempts))
    text = console.export_text()
    assert "joint limit" in text
    assert attempts[0].arm.joint_names[attempts[0].failed_joint] in text
    assert attempts[0].margin[-1].min() == pytest.approx(0.0, abs=1e-9)


def test_rounds_and_instances_that_do_not_exist(finished_run) -> None:
    console = Console(quiet=True)
    with pytest.raises(ScenarioError, match=r"no round 3\n.*1 to 2"):
        inspect(finished_run, console, round=3, html=Path("never.html"))
    with pytest.raises(ScenarioError, match="no instance -1"):
        inspect(finished_run, console, instance=-1, html=Path("never.html"))


def test_a_run_without_rounds(copy) -> None:
    record = json.loads((copy / "run.json").read_text())
    (copy / "run.json").write_text(json.dumps(record | {"rounds": []}))
    with pytest.raises(RunDirectoryError, match="no round of this run is finished"):
        open_inspection(copy)


def test_a_run_of_another_version(copy) -> None:
    record = json.loads((copy / "run.json").read_text())
    (copy / "run.json").write_text(json.dumps(record | {"format": 99}))
    with pytest.raises(RunDirectoryError, match="format 99"):
        open_inspection(copy)


def damage_instances(folder: Path) -> None:
    file = folder / "round_02" / "instances.npz"
    file.write_bytes(file.read_bytes()[:-200])


def damage_suggestion(folder: Path) -> None:
    record = json.loads((folder / "run.json").read_text())
    del record["rounds"][1]["next_demonstration"]["objects"]["bowl"]
    (folder / "run.json").write_text(json.dumps(record))


def remove_instances(folder: Path) -> None:
    (folder / "round_02" / "instances.npz").unlink()


def swap_rounds(folder: Path) -> None:
    shutil.copy(folder / "round_01" / "instances.npz", folder / "round_02" / "instances.npz")


@pytest.mark.parametrize(
    "damage", [damage_instances, damage_suggestion, remove_instances, swap_rounds]
)
def test_a_damaged_round(copy, damage) -> None:
    damage(copy)
    with pytest.raises(RunDirectoryError, match="round 2"):
        choose(open_inspection(copy), 1)


def test_new_rounds_of_a_running_run_are_found(copy) -> None:
    record = json.loads((copy / "run.json").read_text())
    early = record | {"status": "running", "rounds": record["rounds"][:1]}
    (copy / "run.json").write_text(json.dumps(early))
    inspection = open_inspection(copy)
    assert inspection.rounds == 1
    assert not inspection.refresh()
    (copy / "run.json").write_text(json.dumps(record))
    assert inspection.refresh()
    assert inspection.event(1).round == 1
