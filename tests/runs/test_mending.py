"""A run of which something was lost is carried on to the same end."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drake_screw.acquisition import RoundStarted
from drake_screw.errors import RunDirectoryError
from drake_screw.holding import holding
from drake_screw.runs.run import open_run, resumable
from tests.small_runs import finished_run

__all__ = ["finished_run"]


def truncate(folder: Path) -> None:
    file = folder / "round_02/instances.npz"
    file.write_bytes(file.read_bytes()[:300])


def remove_round(folder: Path) -> None:
    shutil.rmtree(folder / "round_02")


def remove_demonstration(folder: Path) -> None:
    (second,) = folder.glob("demonstrations/02_*")
    shutil.rmtree(second)


@pytest.mark.parametrize("harm", [truncate, remove_demonstration])
def test_what_is_lost_is_found_again(
    finished_run: Path, tmp_path: Path, harm: Callable[[Path], None], caplog
) -> None:
    folder = shutil.copytree(finished_run, tmp_path / "run")
    harm(folder)
    run = resumable(open_run(folder))
    started = [e.round for e in run.events() if isinstance(e, RoundStarted)]
    assert started == [0, 1]
    assert "dropped, to be found again: " in caplog.text
    assert "round 2" in caplog.text
    assert ("demonstration demo_02" in caplog.text) == (harm is remove_demonstration)
    before, after = (json.loads((f / "run.json").read_text()) for f in (finished_run, folder))
    for name in ("status", "reason", "rounds", "demonstrations", "certificate"):
        assert after[name] == before[name], name
    one, other = (np.load(f / "round_02/instances.npz") for f in (finished_run, folder))
    for name in one.files:
        np.testing.assert_array_equal(one[name], other[name])


def test_a_whole_run_that_ended_is_not_resumed(finished_run: Path) -> None:
    with pytest.raises(RunDirectoryError, match="this run has ended"):
        resumable(open_run(finished_run))


def test_one_process_at_a_time(finished_run: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(finished_run, tmp_path / "run")
    remove_round(folder)
    record = (folder / "run.json").read_bytes()
    run = open_run(folder)
    with holding(folder, "run"), pytest.raises(RunDirectoryError, match="another process is at"):
        next(run.events())
    assert (folder / "run.json").read_bytes() == record


def test_what_another_process_did_meanwhile_is_known(finished_run: Path, tmp_path: Path) -> None:
    """It was opened before the other one had ended."""
    folder = shutil.copytree(finished_run, tmp_path / "run")
    remove_round(folder)
    late = open_run(folder)
    for _ in open_run(folder).events():
        pass
    written = (folder / "round_02/instances.npz").stat().st_mtime_ns
    for _ in late.events():
        pass
    assert (folder / "round_02/instances.npz").stat().st_mtime_ns == written
    assert len(json.loads((folder / "run.json").read_text())["rounds"]) == 2
