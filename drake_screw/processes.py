"""Work shared out among processes, each of which builds what it needs once.

Drake's plants do not travel between processes. So what travels is how to build what the work needs,
and the jobs; the answers come back as they are finished.
"""

from __future__ import annotations

import logging
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process, resource_tracker
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from threading import Thread
from typing import Any, Generic, Self, TypeVar

from drake_screw.errors import DrakeScrewError

_Tool = TypeVar("_Tool")
_Job = TypeVar("_Job")
_Answer = TypeVar("_Answer")


class WorkerLost(DrakeScrewError):
    """A process that shared the work was killed."""


_here: list[Any] = []
"""What this process built, if it was started here."""


def share_out(
    work: Callable[[_Tool, _Job], _Answer],
    jobs: Sequence[_Job],
    *,
    build: Callable[[], _Tool],
    workers: int | None = None,
) -> Iterator[tuple[int, _Answer]]:
    """Do jobs in several processes.

    Args:
        work: does one job with what `build` makes; a function of a module.
        jobs: what to do; they and the answers are pickled.
        build: makes what the work needs, once in each process; pickled, so a function of a module,
            or a `functools.partial` of one.
        workers: processes; as many as processors if None. With 1, or a single job, everything is
            done in this one.

    Yields:
        The place of each job in `jobs` and its answer, as they are finished, in any order.

    Raises:
        WorkerLost: a process was killed. Whatever a job raises ends the work, too.
    """
    with Crew(build, min(workers or processors(), len(jobs))) as crew:
        yield from crew.share(work, jobs)


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0))


class Crew(Generic[_Tool]):
    """Processes that stay for several lots of jobs; a context manager, which ends them.

    It waits for the jobs that they are at, unless it is interrupted.

    Args:
        build: makes what the work needs, once in each process; as for `share_out`.
        workers: processes; as many as processors if None. With 1 everything is done in this one.
    """

    def __init__(self, build: Callable[[], _Tool], workers: int | None = None) -> None:
        self._build, self._workers = build, processors() if workers is None else workers
        self._pool: ProcessPoolExecutor | None = None
        self._processes: set[BaseProcess] = set()
        self._tools: list[_Tool] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if self._pool is None:
            return
        if kind is KeyboardInterrupt:  # nobody waits for jobs that are half done
            for process in self._processes:
                process.terminate()
        self._pool.shutdown(cancel_futures=True)

    def share(
        self, work: Callable[[_Tool, _Job], _Answer], jobs: Sequence[_Job]
    ) -> Iterator[tuple[int, _Answer]]:
        """Do jobs; takes, yields and raises what `share_out` does."""
        if len(jobs) == 0:
            return
        if self._workers <= 1:
            if not self._tools:
                self._tools.append(self._build())
            for place, job in enumerate(jobs):
                yield place, work(self._tools[0], job)
            return
        if self._pool is None:
            _begin_tracker()
            context = get_context("spawn")
            self._pool = ProcessPoolExecutor(self._workers, context, _begin, (self._build,))
        before = set(active_children())
        with _ctrl_c_held():
            places = {self._pool.submit(_work, work, job): place for place, job in enumerate(jobs)}
        self._processes |= set(active_children()) - before
        try:
            for done in as_completed(places):
                yield places[done], done.result()
        except BrokenProcessPool as error:
            raise WorkerLost(
                "a process that shared the work was killed; memory may have run out",
                remedy="Give fewer --workers.",
            ) from error
        finally:
            for future in places:
                future.cancel()


def _begin(build: Callable[[], Any]) -> None:
    """Sets a process up; what Drake warns of has been told by the one that it works for."""
    Thread(target=_end_with, args=(parent_process(),), daemon=True).start()
    logging.getLogger("drake").addFilter(lambda record: record.levelno >= logging.ERROR)
    _here.append(build())


def _end_with(parent: BaseProcess | None) -> None:
    """Ends this process when the one that it works for has ended, however it did."""
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


def _begin_tracker() -> None:
    """Starts the process that removes semaphores which are left behind, without a word of it.

    They are left by a process that ends at once, as at the second Ctrl-C, and that is no fault.
    """
    before = os.environ.get("PYTHONWARNINGS")
    quiet = "ignore:resource_tracker:UserWarning"
    os.environ["PYTHONWARNINGS"] = quiet if before is None else f"{before},{quiet}"
    try:
        resource_tracker.ensure_running()
    finally:
        del os.environ["PYTHONWARNINGS"]
        if before is not None:
            os.environ["PYTHONWARNINGS"] = before


def _work(work: Callable[[Any, Any], Any], job: Any) -> Any:
    return work(_here[0], job)


@contextmanager
def _ctrl_c_held() -> Iterator[None]:
    """Processes started meanwhile never see Ctrl-C: they end when this one does."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
