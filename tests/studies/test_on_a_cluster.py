"""Studies on a cluster: the table that one machine finds, whatever happens to the workers."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from distributed import LocalCluster

from drake_screw.errors import RunDirectoryError
from drake_screw.sharing.cluster import Cluster, cluster
from drake_screw.studies.experiment import Experiment
from drake_screw.studies.shared_runs import shared_runs
from drake_screw.studies.study import RUNS, STUDY, SUMMARY, Study, new_study, open_study
from tests.sharing.dask_processes import ROOT, DaskProcesses
from tests.studies.test_study import scenario

__all__ = ["scenario"]

REGIONS, COUNT = (1, 4), 12


@pytest.fixture(scope="module")
def joined() -> Iterator[Cluster]:
    with (
        LocalCluster(
            n_workers=1,
            threads_per_worker=2,
            processes=False,
            protocol="tcp",
            dashboard_address=":0",
        ) as local,
        cluster(local.scheduler_address) as workers,
    ):
        yield workers


@pytest.fixture(scope="module")
def alone(scenario, tmp_path_factory) -> Study:
    """The study as one process carries it out."""
    study = new_study(scenario, REGIONS, COUNT, tmp_path_factory.mktemp("studies") / "alone")
    list(study.carry_out(1))
    return study


def same(study: Path, alone: Study) -> None:
    for name in (RUNS, SUMMARY, "distributions.svg"):
        assert (study / name).read_bytes() == (alone.path / name).read_bytes(), name
    assert json.loads((study / STUDY).read_text())["status"] == "finished"


def test_threads_of_a_worker_find_what_one_process_finds(scenario, joined, tmp_path) -> None:
    experiment, jobs = Experiment(scenario), [(K, i) for K in (1, 2) for i in range(2)]
    found = list(shared_runs(experiment, jobs, joined, tmp_path))
    assert sorted(found, key=lambda run: (run.K, run.run)) == [experiment.run(*job) for job in jobs]


def test_a_worker_without_the_recordings_is_named(scenario, joined, tmp_path) -> None:
    study = new_study(scenario, (1,), 2, tmp_path / "study")
    assert study.experiment.setup.teacher is not None  # has read them
    folder = scenario.teacher.folder
    folder.rename(folder.with_name("elsewhere"))
    try:
        with pytest.raises(RunDirectoryError) as error:
            list(study.carry_out(joined))
    finally:
        folder.with_name("elsewhere").rename(folder)
    said = str(error.value)
    assert "worker tcp://" in said
    assert str(folder) in said
    assert "at the same paths" in said
    assert f"drake-screw study --resume {study.path}" in said
    assert json.loads((study.path / STUDY).read_text())["status"] == "interrupted"
    again = open_study(study.path).experiment
    assert [run.K for run in shared_runs(again, [(1, 0)], joined, study.path)] == [1]


def test_a_worker_with_other_recordings_or_another_model_is_refused(
    scenario, joined, tmp_path
) -> None:
    study = new_study(scenario, (1,), 2, tmp_path / "study")
    assert study.experiment.setup.teacher is not None
    file = next(iter(sorted(scenario.teacher.folder.glob("*/joint_angles.csv"))))
    lines = file.read_text().splitlines(keepends=True)
    file.write_text("".join(lines[:-1]))
    try:
        with pytest.raises(RunDirectoryError, match="recordings in this folder are not those"):
            list(study.carry_out(joined))
    finally:
        file.write_text("".join(lines))


def command(*arguments: object) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "drake_screw", "study", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"},
    )


def wait_for_runs(study: Path, count: int) -> None:
    late = time.monotonic() + 300
    while not (study / RUNS).is_file() or len((study / RUNS).read_text().splitlines()) <= count:
        assert time.monotonic() < late
        time.sleep(0.05)


@pytest.mark.slow
def test_a_study_outlives_a_worker(scenario, alone, tmp_path) -> None:
    study = new_study(scenario, REGIONS, COUNT, tmp_path / "shared").path
    with DaskProcesses(tmp_path) as dask:
        dask.start_workers(3)
        with command("--resume", study, "--scheduler", dask.address) as going:
            wait_for_runs(study, 3)
            dask.kill_worker(0)
            out, err = going.communicate(timeout=300)
    assert (going.returncode, err) == (0, "")
    assert "shared out on" in out
    same(study, alone)


@pytest.mark.slow
def test_a_study_whose_scheduler_is_lost_is_carried_on_anywhere(scenario, alone, tmp_path) -> None:
    study = new_study(scenario, REGIONS, COUNT, tmp_path / "shared").path
    with DaskProcesses(tmp_path) as dask:
        dask.start_workers(3)
        with command("--resume", study, "--scheduler", dask.address) as going:
            wait_for_runs(study, 3)
            dask.kill_scheduler()
            _, err = going.communicate(timeout=120)
    assert going.returncode == 2
    assert f"the scheduler at {dask.address} is lost; this study is not finished" in err
    assert f"drake-screw study --resume {study}" in err
    assert "Traceback" not in err
    assert json.loads((study / STUDY).read_text())["status"] == "interrupted"
    done = len((study / RUNS).read_text().splitlines()) - 1
    assert len(list(open_study(study).carry_out(2))) == len(REGIONS) * COUNT - done
    same(study, alone)
