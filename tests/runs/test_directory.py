"""A run's folder, where the operating system refuses."""

from __future__ import annotations

import shutil

import pytest

from drake_screw.errors import DrakeScrewError, RunDirectoryError
from drake_screw.runs.pictures import draw_run
from drake_screw.runs.run import open_run
from drake_screw.web.report_page import write_report
from tests.small_runs import finished_run

__all__ = ["finished_run"]


@pytest.fixture
def run(finished_run, tmp_path):
    return open_run(shutil.copytree(finished_run, tmp_path / "run"))


@pytest.mark.parametrize("name", ["run.json", "run.log", "round_01", "rounds.png"])
def test_what_cannot_be_written_is_named(run, name) -> None:
    rounds = [run.reader.event(i) for i in range(run.reader.rounds)]
    directory, place = run.directory, run.directory.path / name
    if name == "round_01":  # a file where a folder would be replaced
        shutil.rmtree(place)
        place.touch()
    else:
        place.unlink()
        place.mkdir()
    writes = {
        "run.json": directory.save,
        "run.log": lambda: directory.log("words"),
        "round_01": lambda: directory.add_round(rounds[0], lambda event, stem: None),
        "rounds.png": lambda: draw_run(run.setup, rounds, directory.path),
    }
    with pytest.raises(RunDirectoryError, match=r"cannot be written: .* a directory") as caught:
        writes[name]()
    assert caught.value.file in (place, directory.path)
    assert "--resume" in str(caught.value)


def test_a_report_that_cannot_be_written_is_named(run) -> None:
    page = run.directory.path / "report.html"
    page.unlink(missing_ok=True)
    page.mkdir()
    with pytest.raises(DrakeScrewError, match=r"report\.html: cannot be written: Is a directory"):
        write_report(run.reader)
