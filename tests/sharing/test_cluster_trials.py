"""Workers of a cluster that die."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest

from drake_screw.sharing import WorkerLost, share_out
from drake_screw.sharing.cluster import ClusterError, cluster
from tests.sharing.dask_processes import DaskProcesses
from tests.sharing.test_processes import end, end_twice, tool


@pytest.mark.slow
def test_jobs_of_dead_workers_are_done_by_others(tmp_path: Path) -> None:
    marks = tmp_path / "marks"
    marks.mkdir()
    with DaskProcesses(tmp_path) as dask:
        dask.start_workers(3)
        with cluster(dask.address) as joined:
            dask.wait_for_workers(joined, 3)
            done = dict(share_out(end_twice, range(40), build=partial(Path, marks), workers=joined))
            dask.wait_for_workers(joined, 1)
    assert done == {job: 10 * job for job in range(40)}
    assert len(list(marks.iterdir())) == 2


@pytest.mark.slow
def test_a_job_that_ends_every_worker_is_told_of(tmp_path: Path) -> None:
    with DaskProcesses(tmp_path, nanny=True) as dask:  # which starts a worker anew
        dask.start_workers(2)
        with (
            cluster(dask.address) as joined,
            pytest.raises(WorkerLost, match=r"ended 4 workers that tried them; the last one"),
        ):
            list(share_out(end, range(8), build=partial(tool, 0), workers=joined))


@pytest.mark.slow
def test_when_all_workers_are_gone_that_is_said(tmp_path: Path) -> None:
    with DaskProcesses(tmp_path) as dask:
        dask.start_workers(1)
        with (
            cluster(dask.address, patience=3.0) as joined,
            pytest.raises(ClusterError, match=r"all workers .* are gone"),
        ):
            list(share_out(end, range(8), build=partial(tool, 0), workers=joined))
