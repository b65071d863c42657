"""Work shared out on a Dask cluster; here its workers are threads of this process."""

from __future__ import annotations

import re
import socket
import sys
import threading
import time
from collections.abc import Iterator
from functools import partial

import pytest
from distributed import LocalCluster

from drake_screw.errors import RecordingError
from drake_screw.sharing import Crew, share_out
from drake_screw.sharing import cluster as cluster_module
from drake_screw.sharing.cluster import Cluster, ClusterError, cluster
from drake_screw.versions import environment
from tests.sharing.test_processes import fail


@pytest.fixture(scope="module")
def scheduler() -> Iterator[LocalCluster]:
    with LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, protocol="tcp", dashboard_address=":0"
    ) as local:
        yield local


@pytest.fixture(scope="module")
def joined(scheduler: LocalCluster) -> Iterator[Cluster]:
    with cluster(scheduler.scheduler_address) as workers:
        yield workers


_built: list[tuple[int, int]] = []


def tool(start: int) -> int:
    _built.append((start, threading.get_ident()))
    return start


def add(tool: int, job: int) -> tuple[int, int]:
    return tool + job, threading.get_ident()


def no_recordings() -> None:
    raise RecordingError("no such file or folder", remedy="Look there.", file="/data/demos")


def rest(tool: int, job: int) -> None:
    time.sleep(0.05)


def test_every_job_is_done_once_by_workers_and_keeps_its_place(joined: Cluster) -> None:
    assert joined.width == 2
    done = dict(share_out(add, range(500), build=partial(tool, 100), workers=joined))
    assert {place: total for place, (total, _) in done.items()} == {j: 100 + j for j in range(500)}
    threads = {thread for _, thread in done.values()}
    assert threading.get_ident() not in threads


def test_lots_are_the_longer_the_more_workers_there_are(joined, monkeypatch) -> None:
    assert joined.lot_seconds == 0.25
    monkeypatch.setattr(joined, "_threads", 1000)
    assert joined.lot_seconds == 20.0


def test_what_jobs_need_is_built_once_in_a_thread_and_again_for_other_work(joined) -> None:
    _built.clear()
    with Crew(partial(tool, 1000), joined) as first, Crew(partial(tool, 2000), joined) as second:
        for crew, start in ((first, 1000), (second, 2000), (first, 1000)):
            totals = [total for _, (total, _) in crew.share(add, range(40))]
            assert sorted(totals) == [start + job for job in range(40)]
    assert len(_built) == len(set(_built))
    assert {start for start, _ in _built} == {1000, 2000}
    assert len(_built) <= 2 * joined.width


def test_an_error_of_a_job_ends_the_work_and_no_later_one(joined: Cluster) -> None:
    with pytest.raises(ValueError, match="job 3"):
        list(share_out(fail, range(8), build=partial(tool, 0), workers=joined))
    assert len(list(share_out(add, range(8), build=partial(tool, 0), workers=joined))) == 8


def test_what_cannot_be_sent_is_an_error_of_its_own(joined: Cluster) -> None:
    with pytest.raises(Exception, match="pickle"):
        list(share_out(add, [threading.Lock()], build=partial(tool, 0), workers=joined))


def test_what_a_worker_lacks_is_said_with_its_name(joined: Cluster) -> None:
    with pytest.raises(ClusterError) as error:
        list(share_out(add, range(8), build=no_recordings, workers=joined))
    said = str(error.value)
    assert re.match(r"worker tcp://\S+:\d+ on \S+ cannot do its part: /data/demos: no such", said)
    assert socket.gethostname() in said
    assert "Look there." in said
    assert "at the same paths" in said


def test_whoever_stops_asking_leaves_nothing_at_the_scheduler(scheduler, joined) -> None:
    before = set(scheduler.scheduler.tasks)
    answers = share_out(rest, range(1000), build=partial(tool, 0), workers=joined)
    next(answers)
    assert set(scheduler.scheduler.tasks) - before
    answers.close()
    late = time.monotonic() + 20
    while set(scheduler.scheduler.tasks) - before:
        assert time.monotonic() < late
        time.sleep(0.02)


def unlike() -> dict[str, str]:
    there = threading.current_thread() is not threading.main_thread()
    return environment() | ({"drake": "1.0.0"} if there else {})


def test_workers_with_other_versions_are_refused(scheduler, joined, monkeypatch) -> None:
    """When the cluster is joined, and those that come later with their first job."""
    monkeypatch.setattr(cluster_module, "environment", unlike)
    words = r"worker tcp://\S+.* differs from this machine: drake is 1\.0\.0 there and "
    with pytest.raises(ClusterError, match=words), cluster(scheduler.scheduler_address):
        pass
    with pytest.raises(ClusterError, match=words) as error:
        list(share_out(add, range(8), build=partial(tool, 0), workers=joined))
    assert "same environment" in str(error.value)


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("tcp:/x", "'tcp:/x' is not the address of a scheduler; expected one such as tcp://HOST"),
        ("localhost:8786", "is not the address"),
        ("http://localhost:8786", "is not the address"),
        ("tcp://localhost", "is not the address"),
        ("tcp://localhost:99999", "is not the address"),
        ("tcp://localhost:port", "is not the address"),
        ("tcp://no.such.host.invalid:8786", "no host 'no.such.host.invalid' is known"),
        ("tcp://" + "a" * 300 + ":8786", "is known"),
    ],
)
def test_wrong_addresses(address: str, words: str) -> None:
    with pytest.raises(ClusterError, match=words), cluster(address):
        pass


def test_a_closed_port_and_what_is_no_scheduler(scheduler, monkeypatch) -> None:
    monkeypatch.setattr(cluster_module, "_ANSWER", 0.5)
    with socket.create_server(("localhost", 0)) as silent:
        address = f"tcp://localhost:{silent.getsockname()[1]}"
        with pytest.raises(ClusterError, match="does not answer as a Dask"), cluster(address):
            pass
    with pytest.raises(ClusterError, match="nothing answers there") as error, cluster(address):
        pass
    assert "dask scheduler --port" in str(error.value)
    with (
        pytest.raises(ClusterError, match=r"not that of .* a worker"),
        cluster(scheduler.workers[0].worker_address),
    ):
        pass


def test_a_cluster_without_workers_is_waited_for(caplog) -> None:
    with (
        LocalCluster(n_workers=0, processes=False, protocol="tcp", dashboard_address=":0") as empty,
        pytest.raises(ClusterError, match="no workers at the scheduler") as error,
        cluster(empty.scheduler_address, patience=0.5),
    ):
        pass
    assert "dask worker tcp://" in str(error.value)
    assert "waiting" in caplog.text


def test_without_the_extra_its_command_is_said(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ClusterError) as error, cluster("tcp://localhost:8786"):
        pass
    assert "pip install 'drake-screw[cluster]'" in str(error.value)


def test_results_depend_on_what_is_compared() -> None:
    found = environment()
    assert {"python", "drake-screw", "drake", "numpy", "ompl", "source of drake-screw"} <= set(
        found
    )
    assert found["python"] == f"{sys.version_info[0]}.{sys.version_info[1]}"
