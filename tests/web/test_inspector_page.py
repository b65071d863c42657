"""Looking at a finished run, without a browser."""

from __future__ import annotations

import csv
import json
import re
import shutil
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from drake_screw import cli
from drake_screw.acquisition import Finished
from drake_screw.commands.inspect_console import inspect_run, instance_table
from drake_screw.errors import DrakeScrewError, RunDirectoryError, ScenarioError
from drake_screw.planning import Cause
from drake_screw.runs.run import open_run
from drake_screw.visualization.lifetime import page_meshcat
from drake_screw.web.inspector_page import save_page
from drake_screw.web.inspector_panel import changed, tried_before
from drake_screw.web.inspector_scene import InspectorScene
from drake_screw.web.selection import after_message, select, steps
from tests.small_runs import finished_run

__all__ = ["finished_run"]


@pytest.fixture(scope="module")
def reader(finished_run):
    return open_run(finished_run).reader


@pytest.fixture
def copy(finished_run, tmp_path) -> Path:
    return Path(shutil.copytree(finished_run, tmp_path / "copy"))


def test_it_begins_at_the_suggested_instance(reader) -> None:
    selection = select(reader, 1)
    event = reader.event(1)
    assert np.array_equal(
        event.evaluation.coordinates[selection.instance], event.suggestion.coordinates
    )
    assert event.evaluation.failed[selection.instance]


def test_plans_end_as_the_run_found(reader) -> None:
    event = reader.event(1)
    for instance in np.flatnonzero(event.evaluation.failed)[::60]:
        for tried in reader.attempts(1, int(instance)):
            found = event.evaluation.outcomes[instance][tried.number]
            assert found.cause == tried.cause
            assert int(found.segment) == (-1 if tried.plan.success else tried.failed_segment)
            assert found.fraction == tried.plan.outcome.fraction
            assert len(tried.guides) == len(tried.status)


def test_the_best_demonstration_is_shown_first(reader) -> None:
    event = reader.event(1)
    success = event.evaluation.outcomes.success
    for instance in np.flatnonzero(success.any(axis=1))[:20]:
        assert success[instance, reader.best(1, int(instance))]


def test_steps_go_through_the_failing_instances_of_a_region(reader) -> None:
    selection = after_message(reader, select(reader, 0), {"region": 15})
    event, seen = reader.event(0), []
    for _ in range(5):
        assert event.evaluation.region[selection.instance] == 15
        assert event.evaluation.failed[selection.instance]
        seen.append(selection.instance)
        selection = after_message(reader, selection, {"step": "next"})
    assert len(set(seen)) == 5
    furthest = event.evaluation.outcomes[seen].furthest_segment
    assert (np.diff(furthest) >= 0).all()
    assert after_message(reader, selection, {"step": "previous"}).instance == seen[-1]
    assert after_message(reader, selection, {"step": "earliest"}).instance == seen[0]


def test_a_point_on_the_map_leads_to_the_nearest_failing_instance(reader) -> None:
    selection = select(reader, 0)
    event = reader.event(0)
    wanted = event.evaluation.coordinates[np.flatnonzero(event.evaluation.failed)[100], 0]
    moved = after_message(reader, selection, {"at": [float(wanted[0]), float(wanted[1])]})
    assert np.allclose(event.evaluation.coordinates[moved.instance, 0, :2], wanted[:2])


def test_any_other_demonstration_may_be_beside(reader) -> None:
    first = select(reader, 1)
    other = 1 - first.demonstration
    beside = after_message(reader, first, {"against": other})
    assert beside.drawn == {0, 1}
    assert after_message(reader, first, {"against": first.demonstration}) == first
    swapped = after_message(reader, beside, {"demonstration": other})
    assert (swapped.demonstration, swapped.against) == (other, first.demonstration)
    assert after_message(reader, beside, {"against": None}) == first
    moved = after_message(reader, beside, {"step": "next"})
    assert moved.demonstration != moved.against


def test_the_round_before_is_told(reader) -> None:
    before, event = reader.event(0), reader.event(1)
    worst = [np.nanmax(each.verdict.estimates) for each in (before, event)]
    assert changed(before, event).endswith(f"worst region {worst[0]:.1%} → {worst[1]:.1%}")
    outcomes = event.evaluation.outcomes
    first, both = outcomes.success[:, 0], outcomes.success.any(axis=1)
    row = int(np.flatnonzero(~first & both)[0])
    assert tried_before(outcomes[row], before).startswith("; this instance fails")
    row = int(np.flatnonzero(first)[0])
    assert tried_before(outcomes[row], before).startswith("; this instance succeeds")


@pytest.mark.parametrize(
    "message",
    [
        {},
        {"against": 9},
        {"against": "1"},
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
def test_nonsense_changes_nothing(reader, message) -> None:
    selection = select(reader, 1)
    assert after_message(reader, selection, message) == selection


def test_a_round_without_failures_offers_no_earliest(reader, monkeypatch) -> None:
    event = reader.event(0)
    fine = np.flatnonzero(~event.evaluation.failed)
    part = replace(
        event.evaluation,
        coordinates=event.evaluation.coordinates[fine],
        region=event.evaluation.region[fine],
        outcomes=event.evaluation.outcomes[fine],
    )
    other = open_run(reader.directory.path).reader
    monkeypatch.setattr(other, "event", lambda round: replace(event, evaluation=part))
    selection = select(other, 0)
    assert part.outcomes.any_success[selection.instance]
    assert set(steps(other, selection)) <= {"previous", "next"}


def test_the_command_tells_every_demonstration(finished_run, tmp_path) -> None:
    console = Console(width=200, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
    page = tmp_path / "deep" / "page.html"
    inspect_run(finished_run, console, round=2, html=page)
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


def test_the_table_names_segment_and_joint(reader) -> None:
    event = reader.event(0)
    limit = event.evaluation.outcomes.cause[:, 0] == Cause.JOINT_LIMIT
    attempts = reader.attempts(0, int(np.flatnonzero(limit)[0]))
    console = Console(width=160, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
    console.print(instance_table(attempts))
    text = console.export_text()
    assert "joint limit" in text
    assert attempts[0].arm.joint_names[attempts[0].failed_joint] in text
    assert attempts[0].margin[-1].min() == pytest.approx(0.0, abs=1e-9)


def test_rounds_and_instances_that_do_not_exist(finished_run) -> None:
    console = Console(quiet=True)
    with pytest.raises(ScenarioError, match=r"no round 3\n.*1 to 2"):
        inspect_run(finished_run, console, round=3, html=Path("never.html"))
    with pytest.raises(ScenarioError, match="no instance -1"):
        inspect_run(finished_run, console, instance=-1, html=Path("never.html"))


def test_a_run_without_rounds(copy) -> None:
    record = json.loads((copy / "run.json").read_text())
    (copy / "run.json").write_text(json.dumps(record | {"rounds": []}))
    with pytest.raises(RunDirectoryError, match="this run ended before its first round"):
        open_run(copy).reader.check_round(None)


def test_a_run_of_another_version(copy) -> None:
    record = json.loads((copy / "run.json").read_text())
    (copy / "run.json").write_text(json.dumps(record | {"format": 99}))
    with pytest.raises(RunDirectoryError, match="format 99"):
        open_run(copy)


def damage_instances(folder: Path) -> None:
    file = folder / "round_02" / "instances.npz"
    file.write_bytes(file.read_bytes()[:-200])


def empty_instances(folder: Path) -> None:
    (folder / "round_02" / "instances.npz").write_bytes(b"")


def spoil_instances(folder: Path) -> None:
    file = folder / "round_02" / "instances.npz"
    data = bytearray(file.read_bytes())
    data[5000:5200] = bytes(200)
    file.write_bytes(bytes(data))


def shorten_a_column(folder: Path) -> None:
    file = folder / "round_02" / "instances.npz"
    with np.load(file) as data:
        arrays = {name: data[name] for name in data.files}
    np.savez(file, **arrays | {"region": arrays["region"][:5]})


def damage_suggestion(folder: Path) -> None:
    record = json.loads((folder / "run.json").read_text())
    del record["rounds"][1]["next_demonstration"]["objects"]["bowl"]
    (folder / "run.json").write_text(json.dumps(record))


def remove_instances(folder: Path) -> None:
    (folder / "round_02" / "instances.npz").unlink()


def swap_rounds(folder: Path) -> None:
    shutil.copy(folder / "round_01" / "instances.npz", folder / "round_02" / "instances.npz")


@pytest.mark.parametrize(
    "damage",
    [
        damage_instances,
        empty_instances,
        spoil_instances,
        shorten_a_column,
        damage_suggestion,
        remove_instances,
        swap_rounds,
    ],
)
def test_a_damaged_round(copy, damage) -> None:
    damage(copy)
    with pytest.raises(RunDirectoryError, match="round 2"):
        select(open_run(copy).reader, 1)


def rewritten(**changes: object):
    def change(folder: Path) -> None:
        record = json.loads((folder / "run.json").read_text())
        (folder / "run.json").write_text(json.dumps(record | changes))

    return change


def without(name: str):
    def change(folder: Path) -> None:
        record = json.loads((folder / "run.json").read_text())
        del record[name]
        (folder / "run.json").write_text(json.dumps(record))

    return change


def cut(name: str, kept: int):
    def change(folder: Path) -> None:
        (folder / name).write_bytes((folder / name).read_bytes()[:kept])

    return change


def removed(name: str):
    def change(folder: Path) -> None:
        (folder / name).unlink()

    return change


def without_a_demonstration(folder: Path) -> None:
    record = json.loads((folder / "run.json").read_text())
    record["demonstrations"].pop()
    (folder / "run.json").write_text(json.dumps(record))


def with_other_regions(folder: Path) -> None:
    text = (folder / "scenario.yaml").read_text()
    assert "{x: 4, y: 4}" in text
    (folder / "scenario.yaml").write_text(text.replace("{x: 4, y: 4}", "{x: 2, y: 4}"))


@pytest.mark.parametrize(
    ("damage", "expected"),
    [
        (removed("run.json"), "has no run.json"),
        (cut("run.json", 0), r"run\.json: damaged"),
        (cut("run.json", 500), r"run\.json: damaged"),
        (rewritten(format=2), r"format 2; .* format 1\n.*drake-screw \d"),
        (rewritten(format="x"), "no number of its format"),
        (without("rounds"), "no 'rounds'"),
        (without("hashes"), "no 'hashes'"),
        (rewritten(rounds=["a", "b"]), "of round 1 is 'a'"),
        (rewritten(demonstrations=[{}]), "demonstration 1 is incomplete"),
        (rewritten(status="happy"), "no run has the status 'happy'"),
        (rewritten(certificate=3), "'certificate' is 3"),
        (rewritten(hashes={"model": "0"}), "has changed since this run"),
        (removed("scenario.yaml"), r"scenario\.yaml: damaged: the file is missing"),
        (cut("scenario.yaml", 0), r"scenario\.yaml: damaged: the file is empty"),
        (cut("scenario.yaml", 300), r"scenario\.yaml:\d+: damaged: not valid YAML"),
        (with_other_regions, "does not fit the scenario beside it"),
        (without_a_demonstration, "damaged: (demonstration 2 is missing|it ends as)"),
        (damage_instances, "round 2 is damaged"),
        (empty_instances, "round 2 is damaged"),
        (spoil_instances, "round 2 is damaged"),
        (shorten_a_column, "columns are not equally long"),
        (remove_instances, "round 2 is damaged: the file is missing"),
    ],
)
@pytest.mark.parametrize("verb", ["inspect", "report"])
def test_a_damaged_directory_gives_one_message(
    copy, verb, damage, expected, monkeypatch, capsys
) -> None:
    damage(copy)
    before = sorted(copy.rglob("*"))
    options = ["--html", str(copy.parent / "page.html")] if verb == "inspect" else []
    monkeypatch.setattr(sys, "argv", ["drake-screw", verb, str(copy), *options])
    with pytest.raises(SystemExit) as end:
        cli.main()
    out, err = capsys.readouterr()
    assert end.value.code == 2
    assert re.search(expected, err), err
    assert err.count("error: ") == 1
    assert out == ""
    assert "Traceback" not in err
    assert sorted(copy.rglob("*")) == before


def test_a_run_is_told_again_as_it_ended(finished_run) -> None:
    *_, last = open_run(finished_run).replay()
    record = json.loads((finished_run / "run.json").read_text())
    assert (last.status, last.reason) == (record["status"], record["reason"])


def test_half_a_million_instances_are_thinned_and_open_quickly(reader, monkeypatch) -> None:
    event = reader.event(1)
    evaluation = event.evaluation
    repeat = np.resize(np.arange(len(evaluation.region)), 516_928)
    large = replace(
        evaluation,
        coordinates=evaluation.coordinates[repeat],
        region=evaluation.region[repeat],
        outcomes=evaluation.outcomes[repeat],
    )
    other = open_run(reader.directory.path).reader
    monkeypatch.setattr(other, "event", lambda round: replace(event, evaluation=large))
    begun = time.process_time()
    scene = InspectorScene(other, page_meshcat("localhost"))
    state = scene.show(select(other, 1), live=True)
    assert time.process_time() - begun < 5.0
    assert state["map_words"].endswith(
        "2,000 of 516,928 instances, drawn at random (in 3-D: 6,000)"
    )
    assert len(json.dumps(state)) < 500_000
    assert len(scene.meshcat.StaticHtml()) < 10e6


def test_a_page_is_not_overwritten_by_its_numbers(reader, tmp_path) -> None:
    selection = select(reader, 1)
    for name in ("page.json", "page.csv"):
        with pytest.raises(DrakeScrewError, match="its own numbers"):
            save_page(reader, selection, tmp_path / name)
    (tmp_path / "file").touch()
    with pytest.raises(DrakeScrewError, match="cannot be written"):
        save_page(reader, selection, tmp_path / "file" / "page.html")
    assert [file.name for file in tmp_path.iterdir()] == ["file"]
    (tmp_path / "page.json").mkdir()
    with pytest.raises(DrakeScrewError, match=r"page\.json: cannot be written: it is a folder"):
        save_page(reader, selection, tmp_path / "page.html")
    assert not (tmp_path / "page.html").exists()


def test_a_run_is_not_overwritten_by_the_numbers_of_a_page(reader, copy) -> None:
    before = (copy / "run.json").read_bytes()
    with pytest.raises(DrakeScrewError, match=r"run\.json: cannot be written: a run or a study"):
        save_page(reader, select(reader, 1), copy / "run.html")
    assert (copy / "run.json").read_bytes() == before
    assert not (copy / "run.html").exists()


def test_whoever_stops_listening_at_the_end_leaves_a_finished_run(finished_run, tmp_path) -> None:
    copy = shutil.copytree(finished_run, tmp_path / "copy")
    ended = json.loads((copy / "run.json").read_text())["status"]
    run = open_run(copy)
    for event in run.events():
        if isinstance(event, Finished):
            break
    assert json.loads((copy / "run.json").read_text())["status"] == ended


def test_new_rounds_of_a_running_run_are_found(copy) -> None:
    record = json.loads((copy / "run.json").read_text())
    early = record | {"status": "running", "rounds": record["rounds"][:1]}
    (copy / "run.json").write_text(json.dumps(early))
    reader = open_run(copy).reader
    assert reader.rounds == 1
    assert not reader.refresh()
    (copy / "run.json").write_text(json.dumps(record))
    assert reader.refresh()
    assert reader.event(1).round == 1
