"""A run's files tell what happened, as the run itself did."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from drake_screw.acquisition import (
    DemonstrationAdded,
    DemonstrationRequested,
    Event,
    Finished,
    RoundFinished,
    RoundStarted,
)
from drake_screw.errors import RunDirectoryError
from drake_screw.planning import BatchPlanner
from drake_screw.runs.narration import describe
from drake_screw.runs.redrawing import redraw
from drake_screw.runs.run import Run, new_run, open_run
from drake_screw.scenario.loader import load_scenario
from tests.small_runs import CHANGES, finished_run

__all__ = ["finished_run"]


@pytest.fixture(scope="module")
def lived(tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, list[Event]]:
    """A run that starts from two demonstrations, and its events as they happened."""
    changes = [*CHANGES, "demonstrations.initial=2", "demonstrations.budget=3"]
    run = new_run(load_scenario("pouring", changes), tmp_path_factory.mktemp("runs") / "two")
    return run, list(run.events())


def edit(folder: Path, **changes: object) -> None:
    record = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps(record | changes))


def test_a_replay_has_the_events_of_the_run(lived) -> None:
    run, events = lived
    again = list(open_run(run.directory.path).replay())
    regions = run.setup.regions
    assert [type(event) for event in again] == [type(event) for event in events]
    assert [describe(event, regions) for event in again] == [
        describe(event, regions) for event in events
    ]
    for one, other in zip(events, again, strict=True):
        match one:
            case RoundStarted():
                assert one.round == other.round
                assert len(one.demonstrations) == len(other.demonstrations)
            case RoundFinished():
                np.testing.assert_array_equal(
                    one.evaluation.coordinates, other.evaluation.coordinates
                )
                np.testing.assert_array_equal(one.evaluation.region, other.evaluation.region)
                for name, value in vars(one.verdict).items():
                    np.testing.assert_array_equal(getattr(other.verdict, name), value)
                np.testing.assert_array_equal(
                    one.evaluation.outcomes.codes(), other.evaluation.outcomes.codes()
                )
            case DemonstrationRequested():
                assert (one.round, one.number) == (other.round, other.number)
                np.testing.assert_array_equal(
                    one.suggestion.coordinates, other.suggestion.coordinates
                )
                assert one.suggestion.segment == other.suggestion.segment
                assert one.suggestion.region == other.suggestion.region
            case DemonstrationAdded():
                assert (one.round, one.remark) == (other.round, other.remark)
                np.testing.assert_array_equal(one.recording.q, other.recording.q)
                np.testing.assert_array_equal(one.demonstration.X_OE, other.demonstration.X_OE)
            case Finished():
                assert (one.status, one.reason) == (other.status, other.reason)
                assert len(one.demonstrations) == len(other.demonstrations)


def test_nothing_is_planned_again_to_replay_and_draw(finished_run, tmp_path, monkeypatch) -> None:
    copy = shutil.copytree(finished_run, tmp_path / "copy")
    (copy / "rounds.png").unlink()

    def never(*_: object, **__: object) -> None:
        raise AssertionError("planned again")

    monkeypatch.setattr(BatchPlanner, "any_success", never)
    monkeypatch.setattr(BatchPlanner, "all_outcomes", never)
    run = open_run(copy)
    assert sum(isinstance(event, RoundFinished) for event in run.replay()) == 2
    redraw(run.reader)
    assert (copy / "rounds.png").stat().st_size > 0


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda record: {"rounds": record["rounds"][:1]}, "round 2 is missing"),
        (lambda record: {"rounds": []}, "round 1 is missing"),
        (lambda record: {"status": "certified"}, "it ends as 'insufficient' after 2 rounds"),
        (
            lambda record: {"demonstrations": record["demonstrations"][:1]},
            "demonstration 2 is missing",
        ),
    ],
)
def test_a_run_that_is_not_whole_is_not_replayed(finished_run, tmp_path, change, expected) -> None:
    copy = shutil.copytree(finished_run, tmp_path / "copy")
    edit(copy, **change(json.loads((copy / "run.json").read_text())))
    with pytest.raises(RunDirectoryError, match=expected):
        list(open_run(copy).replay())


def test_only_a_finished_run_is_replayed(finished_run, tmp_path) -> None:
    copy = shutil.copytree(finished_run, tmp_path / "copy")
    edit(copy, status="interrupted")
    with pytest.raises(RunDirectoryError, match="has not finished; its status is 'interrupted'"):
        list(open_run(copy).replay())


def test_a_run_whose_teacher_had_nothing_at_all_is_replayed(tmp_path) -> None:
    unreachable = ["teacher={kind: recorded}", f"teacher.folder={tmp_path / 'library'}"]
    source = new_run(
        load_scenario("pouring", [*CHANGES, "demonstrations.budget=1"]), tmp_path / "a"
    )
    list(source.events())
    shutil.copytree(tmp_path / "a" / "demonstrations", tmp_path / "library")
    changes = [*CHANGES, *unreachable, "demonstrations.initial=2"]
    run = new_run(load_scenario("pouring", changes), tmp_path / "b")
    *_, end = run.events()
    again = list(open_run(tmp_path / "b").replay())
    assert isinstance(again[-1], Finished)
    assert (again[-1].status, again[-1].reason) == (end.status, end.reason)
    assert again[-1].verdict is None
    assert len(again[-1].demonstrations) == len(end.demonstrations) == 1
    assert run.certificate is not None
    assert run.certificate.statement == ("No initial demonstration: the only recording is used.",)
