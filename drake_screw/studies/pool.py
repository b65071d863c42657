"""Sharing the runs of a study out among processes.

A Drake plant does not travel between processes, so each builds its own from the scenario's text.
"""

from __future__ import annotations

import logging
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path

from drake_screw.errors import RunDirectoryError
from drake_screw.scenario.loader import load_scenario
from drake_screw.studies.experiment import Experiment, StudyRun

_own: list[Experiment] = []
"""The one experiment of a process that was started here."""


def results(
    experiment: Experiment, scenario: Path, missing: Sequence[tuple[int, int]], workers: int | None
) -> Iterator[StudyRun]:
    """Carry out runs in several processes.

    Args:
        experiment: of this process.
        scenario: file of the same scenario, for the others.
        missing: K and number of each run.
        workers: how many processes; with 1, this one. As many as processors if None.

    Yields:
        The runs as they are finished, in any order.

    Raises:
        RunDirectoryError: a process was killed.
    """
    compiled = experiment.setup.batch_planner.compiled
    here = len(missing) if workers == 1 else int(not compiled)  # Compile the arm's code only once.
    for K, run in missing[:here]:
        yield experiment.run(K, run)
    if here >= len(missing):
        return
    pool = ProcessPoolExecutor(workers, get_context("spawn"), _begin, (scenario,))
    with pool:
        with _ctrl_c_held():
            jobs = [pool.submit(_carry_out, K, run) for K, run in missing[here:]]
        try:
            for job in as_completed(jobs):
                yield job.result()
        except BrokenProcessPool as error:
            raise RunDirectoryError(
                "a process of this study was killed; memory may have run out",
                remedy="Carry it on with --resume and fewer --workers.",
                file=scenario.parent,
            ) from error
        finally:
            pool.shutdown(cancel_futures=True)


def _begin(scenario: Path) -> None:
    logging.getLogger("drake").setLevel(logging.WARNING)
    _own.append(Experiment(load_scenario(scenario)))


def _carry_out(K: int, run: int) -> StudyRun:
    return _own[0].run(K, run)


@contextmanager
def _ctrl_c_held() -> Iterator[None]:
    """Processes started meanwhile never see Ctrl-C: they end when this one tells them to."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
