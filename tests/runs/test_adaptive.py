"""Scenarios whose regions refine themselves, from their text to their run directory."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from drake_screw.acquisition import Event, Finished, RoundFinished
from drake_screw.assembly.preview import preview
from drake_screw.runs.directory import RunDirectory
from drake_screw.runs.run import new_run, open_run
from drake_screw.scenario.loader import load_scenario
from tests.small_runs import two_objects

QUICK = ["objects.0.symmetry=null", "coverage.beta=0.7", "coverage.epsilon=0.15", "seed=1"]
ADAPTIVE = [*QUICK, "regions={adaptive: {smallest: 0.0625}}"]


def rounds(events: Iterator[Event]) -> list[RoundFinished]:
    return [event for event in events if isinstance(event, RoundFinished)]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[RoundFinished]]:
    """A run from its beginning to its end."""
    path = tmp_path_factory.mktemp("runs") / "whole"
    return path, rounds(new_run(load_scenario("pouring", ADAPTIVE), path).events())


def test_the_record_is_of_the_rounds_own_regions(whole) -> None:
    path, told = whole
    record = json.loads((path / "run.json").read_text())
    assert record["status"] == "certified"
    assert record["strategy"] == record["certificate"]["strategy"] == "certify_or_split"
    assert record["regions"] == "adaptive"
    assert len(told) == len(record["rounds"]) > 1
    for event, entry in zip(told, record["rounds"], strict=True):
        table = list(csv.DictReader((path / f"round_{event.round + 1:02d}/regions.csv").open()))
        assert len(table) == event.regions.K == len(entry["verdict"]["samples"])
        assert sum(entry["samples"]) == len(event.evaluation.region)
        for row, lower in zip(table, event.regions.bounds(np.arange(len(table)))[0], strict=True):
            assert float(row["y_min"]) == pytest.approx(lower[0, 1], abs=1e-5)
        if event.suggestion is not None:
            name = event.regions.name(event.verdict.region)
            assert entry["next_demonstration"]["region_name"] == name
            assert name in (path / "run.log").read_text()
    assert record["certificate"]["regions"] == told[-1].regions.K


@pytest.mark.slow
def test_an_interrupted_run_resumes_to_the_same_result(whole, tmp_path) -> None:
    path, told = whole
    events = new_run(load_scenario("pouring", ADAPTIVE), tmp_path / "parts").events()
    next(event for event in events if isinstance(event, RoundFinished))
    events.close()
    assert RunDirectory.open(tmp_path / "parts").record.status == "interrupted"
    again = rounds(open_run(tmp_path / "parts").events())
    assert len(again) == len(told)
    for one, other in zip(told, again, strict=True):
        np.testing.assert_array_equal(one.evaluation.coordinates, other.evaluation.coordinates)
        np.testing.assert_array_equal(one.regions.lower, other.regions.lower)
        assert one.verdict.claim == other.verdict.claim
    records = [json.loads((p / "run.json").read_text()) for p in (path, tmp_path / "parts")]
    assert records[0]["rounds"] == records[1]["rounds"]
    assert records[0]["certificate"] == records[1]["certificate"]
    for file in path.rglob("*.npz"):
        a, b = np.load(file), np.load(tmp_path / "parts" / file.relative_to(path))
        assert a.files == b.files
        assert all(np.array_equal(a[name], b[name]) for name in a.files)


def test_a_finished_run_is_told_again_with_its_cells(whole) -> None:
    path, told = whole
    again = rounds(open_run(path).replay())
    for one, other in zip(told, again, strict=True):
        for cell, stored in zip(one.evaluation.frontier, other.evaluation.frontier, strict=True):
            for name in ("depth", "epoch", "cleared", "n", "s"):
                assert getattr(cell, name) == getattr(stored, name)
            for name in ("lower", "upper", "points", "failed"):
                np.testing.assert_array_equal(getattr(cell, name), getattr(stored, name))


def test_a_scenario_with_two_objects_runs(tmp_path) -> None:
    changes = [*ADAPTIVE, "demonstrations.budget=2"]
    events = list(new_run(two_objects(changes), tmp_path / "two").events())
    finished = rounds(iter(events))
    assert isinstance(events[-1], Finished)
    assert finished
    for event in finished:
        places = event.evaluation.coordinates
        assert (np.ptp(places, axis=0) > 0.0).tolist() == [[1, 1, 0], [1, 0, 1]]
        np.testing.assert_array_equal(event.regions.index(places), event.evaluation.region)
    folder = tmp_path / "two" / "round_01"
    header = (folder / "regions.csv").read_text().split("\n")[0]
    assert "cup.yaw_min" in header
    assert (folder / "heat_map.png").stat().st_size > 0
    assert (tmp_path / "two" / "meshcat.html").stat().st_size > 0


def test_check_tells_what_adaptive_means() -> None:
    text = str(preview(load_scenario("pouring", ADAPTIVE)))
    assert "adaptive: the work area is halved along its 2 axes" in text
    assert "certify_or_split" in text
    assert "in a first round where nothing fails, otherwise as many as it takes" in text
