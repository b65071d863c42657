"""What a run of a study costs, and what it costs to share runs out: here, and on a Dask cluster.

    python benchmarks/cluster.py [--runs 20] [--lots 2000]

Prints processor seconds of a run with 16 regions (scenario pouring as shipped), what a worker
builds once and the memory it has then, and for each way of sharing out the waiting time and the
processor time of a lot with a job that does nothing, of all processes but the workers together.
Needs the extra `cluster`.
"""

from __future__ import annotations

import argparse
import logging
import resource
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

from drake_screw.scenario.loader import load_scenario
from drake_screw.sharing import Workers, lots, share_out
from drake_screw.sharing.cluster import cluster
from drake_screw.studies.experiment import Experiment

K = 16


def experiment() -> tuple[Experiment, float]:
    """What a worker builds, and the processor seconds that takes."""
    began = time.process_time()
    built = Experiment(load_scenario("pouring"))
    _ = built.setup.workcell, built.setup.teacher, built.setup.strategy
    return built, time.process_time() - began


def run(built: tuple[Experiment, float], number: int) -> tuple[float, float, float]:
    """Processor seconds of a run and of building; memory of the process, MB."""
    began = time.process_time()
    built[0].run(K, number)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return time.process_time() - began, built[1], memory


def nothing() -> None:
    """Nothing is needed for what is no work."""


def do_nothing(_: None, job: int) -> int:
    """No work."""
    return job


@contextmanager
def dask(count: int) -> Iterator[Workers]:
    """A scheduler in this process, and workers in others."""
    from distributed import LocalCluster

    logging.getLogger("distributed").setLevel(logging.ERROR)
    with (
        LocalCluster(
            n_workers=count, threads_per_worker=1, protocol="tcp", dashboard_address=":0"
        ) as local,
        cluster(local.scheduler_address) as joined,
    ):
        yield joined


@contextmanager
def processes(count: int) -> Iterator[Workers]:
    """Processes of this machine."""
    yield count


@contextmanager
def single_jobs() -> Iterator[None]:
    """A context in which lots are of one job each."""
    before, lots.MOST = lots.MOST, 1
    try:
        yield
    finally:
        lots.MOST = before


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--lots", type=int, default=2000)
    arguments = parser.parse_args()
    for number in range(2):  # whatever is compiled or read for the first time
        run(experiment(), number)
    ways: dict[str, Callable[[int], object]] = {"processes": processes, "dask": dask}
    for name, way in ways.items():
        with way(2) as workers:
            shared = share_out(run, range(arguments.runs), build=experiment, workers=workers)
            found = [answer for _, answer in shared]
            seconds = sorted(found)[1:-1]
            mean = sum(s for s, _, _ in seconds) / len(seconds)
            print(
                f"{name}: {mean:.2f} s of a processor a run, K = {K} ({seconds[0][0]:.2f} to "
                f"{seconds[-1][0]:.2f}), {max(b for _, b, _ in found):.1f} s to build, "
                f"{max(m for _, _, m in found):.0f} MB",
                flush=True,
            )
            once = partial(share_out, do_nothing, build=nothing, workers=workers)
            dict(once(range(10)))
            jobs = range(arguments.lots)
            waited, used = time.perf_counter(), time.process_time()
            with single_jobs():
                dict(once(jobs))
            waited, used = time.perf_counter() - waited, time.process_time() - used
            print(
                f"{name}: {1e3 * waited / arguments.lots:.2f} ms a lot, of which "
                f"{1e3 * used / arguments.lots:.2f} ms of a processor",
                flush=True,
            )


if __name__ == "__main__":
    main()
