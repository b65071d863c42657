"""Finished runs side by side."""

from __future__ import annotations

import json
import shutil
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from drake_screw.acquisition import Evaluation
from drake_screw.errors import RunDirectoryError
from drake_screw.planning import Cause, Outcomes
from drake_screw.runs.common_regions import alike, region_table, same_area, same_boxes
from drake_screw.runs.comparison import Comparison, compare_runs, open_runs, same_recording
from drake_screw.runs.run import Run
from drake_screw.runs.shared_instances import common_rows, shared_instances
from drake_screw.tasks import ObjectArea, WorkArea
from drake_screw.tasks.regions import grid_regions
from drake_screw.web.compare_page import compare_page
from tests.small_runs import finished_run

__all__ = ["finished_run"]


def shorter(run: Path, copy: Path) -> Path:
    """The run as it would be with a budget of 1: without its second demonstration and round."""
    shutil.copytree(run, copy)
    record = json.loads((copy / "run.json").read_text())
    for name in ("demonstrations", "rounds"):
        record[name] = record[name][:1]
    record["certificate"]["demonstrations"] = 1
    (copy / "run.json").write_text(json.dumps(record))
    text = (copy / "scenario.yaml").read_text()
    assert "budget: 2" in text
    (copy / "scenario.yaml").write_text(text.replace("budget: 2", "budget: 1"))
    return copy


@pytest.fixture(scope="module")
def runs(finished_run: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Run]:
    folder = tmp_path_factory.mktemp("compared")
    twin = Path(shutil.copytree(finished_run, folder / "twin"))
    return open_runs([finished_run, shorter(finished_run, folder / "shorter"), twin])


@pytest.fixture(scope="module")
def comparison(runs: list[Run]) -> Comparison:
    return compare_runs(runs)


def test_differences_of_scenarios_and_certificates(comparison: Comparison) -> None:
    assert [(d.key, d.values) for d in comparison.scenario] == [
        ("demonstrations.budget", (2, 1, 2))
    ]
    assert [(d.key, d.values) for d in comparison.certificates] == [("demonstrations", (2, 1, 2))]
    assert comparison.made_with == ()


def test_the_same_recordings_are_found(comparison: Comparison) -> None:
    found = [[lesson.also_in for lesson in run.demonstrations] for run in comparison.runs]
    assert found == [[(2, 3), (3,)], [(1, 3)], [(1, 2), (1,)]]


def test_a_recording_of_another_place_is_another(runs: list[Run]) -> None:
    recording = runs[0].reader.recording(0)
    assert same_recording(recording, replace(recording, name="other"))
    moved = recording.X_WO.copy()
    moved[0, 0, 3] += 1e-12
    assert not same_recording(recording, replace(recording, X_WO=moved))
    assert not same_recording(recording, replace(recording, q=recording.q[:-1]))


def test_regions_hold_what_run_json_has(comparison: Comparison, runs: list[Run]) -> None:
    (table,) = comparison.regions
    assert table.runs == (1, 2, 3)
    last = [run.directory.record.rounds[-1] for run in runs]
    for row in table.regions:
        j = row.region
        assert row.samples == tuple(r.verdict.samples[j] for r in last)
        assert row.failures == tuple(r.verdict.failures[j] for r in last)
        assert row.at_most == tuple(r.verdict.upper[j] for r in last)
        assert row.failure_rate == tuple(r.failure_rates[j] for r in last)
        expected = row.at_least[0] > row.at_most[1] or row.at_least[1] > row.at_most[0]
        assert row.apart == expected
    assert any(row.apart for row in table.regions)
    assert not all(row.apart for row in table.regions)


def test_of_many_regions_those_are_shown_that_tell_most(comparison: Comparison) -> None:
    (table,) = comparison.regions
    assert table.telling(16) == table.regions
    differ = [row.region for row in table.regions if row.apart]
    shown = [row.region for row in table.telling(len(differ) + 1)]
    assert sorted(shown[:-1]) == differ
    rest = [row for row in table.regions if not row.apart]
    assert max(table.regions[shown[-1]].failure_rate) == max(max(r.failure_rate) for r in rest)


def test_a_run_without_a_round_measured_nothing(finished_run: Path, tmp_path: Path) -> None:
    early = Path(shutil.copytree(finished_run, tmp_path / "early"))
    record = json.loads((early / "run.json").read_text())
    record |= {"rounds": [], "demonstrations": [], "reason": "no plan"}
    stated = record["certificate"]
    kept = ("beta", "epsilon", "delta", "collisions_checked", "strategy", "guarantee")
    record["certificate"] = {name: stated[name] for name in kept} | {
        "certified": False, "demonstrations": 0, "regions": 16, "reason": "no plan",
    }  # fmt: skip
    (early / "run.json").write_text(json.dumps(record))
    runs = open_runs([early, finished_run])
    found = compare_runs(runs)
    assert (found.runs[0].success, found.runs[0].outcomes) == (None, {})
    assert (found.regions, found.shared) == ((), ())
    assert found.notes[0].startswith("Run 1 ended before a first round")
    page = compare_page(runs, found)
    assert page.count("<img") == 1
    assert "run 2, round 2" in page


def test_success_is_the_mean_of_equal_regions(comparison: Comparison, runs: list[Run]) -> None:
    for compared, run in zip(comparison.runs, runs, strict=True):
        rates = run.directory.record.rounds[-1].failure_rates
        assert compared.success == pytest.approx(1.0 - np.mean(rates))
        assert compared.success_in_weakest == pytest.approx(1.0 - max(rates))
        assert sum(compared.outcomes.values()) == compared.instances


def test_only_rounds_of_the_same_number_share_instances(comparison: Comparison) -> None:
    other, twin = comparison.shared
    assert (other.instances, other.lines) == (0, ())
    assert (twin.first, twin.second) == (1, 3)
    assert twin.instances == comparison.runs[0].instances
    assert twin.both == comparison.runs[0].outcomes["success"]
    assert twin.only_first == twin.only_second == 0
    assert twin.neither == twin.instances - twin.both
    assert "runs 1 and 2 have no instance in common" in " ".join(comparison.notes)


def evaluation(x: list[float], success: list[bool]) -> Evaluation:
    coordinates = np.zeros((len(x), 1, 3))
    coordinates[:, 0, 0] = x
    cause = np.where(success, Cause.SUCCESS, Cause.JOINT_LIMIT).astype(np.uint8)[:, None]
    zeros = np.zeros(cause.shape, dtype=np.int64)
    others = {f.name: zeros for f in fields(Outcomes) if f.name not in ("cause", "fraction")}
    outcomes = Outcomes(cause=cause, fraction=zeros.astype(float), **others)
    return Evaluation(coordinates, np.zeros(len(x), dtype=np.int64), outcomes)


def test_what_runs_made_of_instances_they_share() -> None:
    one = evaluation([0.1, 0.2, 0.3, 0.4, 0.5], [True, True, False, False, True])
    other = evaluation([0.5, 0.4, 0.9, 0.2, 0.3], [False, False, True, True, True])
    assert common_rows(one.coordinates, other.coordinates).tolist() == [
        [1, 3], [2, 4], [3, 1], [4, 0],
    ]  # fmt: skip
    found = shared_instances(1, one, 4, other)
    assert (found.instances, found.both, found.neither) == (4, 1, 1)
    assert (found.only_first, found.example_only_first) == (1, (4, 0))
    assert (found.only_second, found.example_only_second) == (1, (2, 4))
    assert "instance 4 of the last round of run 1, which is 0 of run 4" in found.lines[1]


def bowl(y: float, overlap=None) -> WorkArea:
    return WorkArea((ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, y, 0.0), z=0.0),), overlap)


def test_areas_are_the_same_where_draws_are() -> None:
    apart = bowl(0.8, lambda X_WO: np.zeros(len(X_WO), dtype=bool))
    assert same_area(bowl(0.8), bowl(0.8), same_objects=False)
    assert not same_area(bowl(0.8), bowl(0.7), same_objects=True)
    assert not same_area(bowl(0.8), apart, same_objects=True)
    assert same_area(apart, apart, same_objects=True)
    assert not same_area(apart, apart, same_objects=False)


def test_other_regions_are_not_put_side_by_side(runs: list[Run]) -> None:
    event = runs[0].reader.event(0)
    area = event.regions.area
    coarse = replace(event, regions=grid_regions(area, {"x": 2, "y": 8}))
    assert coarse.regions.K == event.regions.K
    rounds = {1: event, 2: coarse, 4: event}
    assert alike(rounds, same_boxes) == [(1, 4), (2,)]
    assert region_table((1, 4), rounds).runs == (1, 4)


def test_what_cannot_be_compared_is_said(finished_run: Path, tmp_path: Path) -> None:
    wider = Path(shutil.copytree(finished_run, tmp_path / "wider"))
    text = (wider / "scenario.yaml").read_text()
    assert "1.0796" in text
    (wider / "scenario.yaml").write_text(text.replace("1.0796", "1.0896"))
    record = json.loads((wider / "run.json").read_text())
    record["certificate"]["collisions_checked"] = False
    record["certificate"]["beta"] = 0.9
    (wider / "run.json").write_text(json.dumps(record))
    found = compare_runs(open_runs([finished_run, wider]))
    assert (found.regions, found.shared) == ((), ())
    words = "\n".join(found.notes)
    assert "Work areas differ (run 1; run 2)" in words
    assert "Runs 1 and 2 have regions that no other run has" in words
    assert "Success does not mean the same in all runs (collisions_checked" in words
    assert "not of the same claim: beta differ" in words


def test_refused_before_anything_is_compared(finished_run: Path, tmp_path: Path) -> None:
    with pytest.raises(RunDirectoryError, match=r"nothing to compare .* with"):
        open_runs([finished_run])
    with pytest.raises(RunDirectoryError, match="given twice"):
        open_runs([finished_run, finished_run / ".." / finished_run.name])
    with pytest.raises(RunDirectoryError, match="13 runs are too many"):
        open_runs([finished_run / str(i) for i in range(13)])
    with pytest.raises(RunDirectoryError, match="not a run directory"):
        open_runs([finished_run, tmp_path])
    going_on = Path(shutil.copytree(finished_run, tmp_path / "going_on"))
    record = json.loads((going_on / "run.json").read_text())
    record |= {"status": "interrupted", "certificate": None}
    (going_on / "run.json").write_text(json.dumps(record))
    with pytest.raises(RunDirectoryError, match=r"going_on: this run has not finished"):
        open_runs([finished_run, going_on])
    damaged = Path(shutil.copytree(finished_run, tmp_path / "damaged"))
    (damaged / "round_02" / "instances.npz").write_bytes(b"PK")
    with pytest.raises(RunDirectoryError, match="round 2 is damaged"):
        open_runs([finished_run, damaged])
