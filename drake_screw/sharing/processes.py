"""Processes of this machine that work is shared out on."""

from __future__ import annotations

import logging
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process, resource_tracker
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from threading import Thread
from typing import Any, TypeVar

from drake_screw.sharing.executor import SharingError, WorkerLost

_Result = TypeVar("_Result")
_log = logging.getLogger(__name__)


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0))


class Processes:
    """An `Executor` of processes that this one starts, and that end with it.

    Where one of them is killed all are started anew.

    Args:
        count: of processes.
    """

    tries, lot_seconds = 3, 0.25

    def __init__(self, count: int) -> None:
        self.width = count
        self._pool: ProcessPoolExecutor | None = None
        self._started: set[BaseProcess] = set()

    def submit(self, call: Callable[..., _Result], *arguments: Any) -> Future[_Result]:
        """See `Executor.submit`."""
        with _ctrl_c_held():
            if self._pool is not None:
                try:
                    return self._pool.submit(call, *arguments)
                except BrokenProcessPool:
                    _log.warning("a process that shares the work was killed; all are started again")
                    self._pool.shutdown()
            _begin_tracker()
            before = set(active_children())
            self._pool = ProcessPoolExecutor(self.width, get_context("spawn"), _begin)
            first = self._pool.submit(call, *arguments)
            self._started = set(active_children()) - before
            return first

    def watch(self) -> None:
        """See `Executor.watch`; a pool tells by itself what it lost."""

    def lost(self, error: Exception) -> SharingError | None:
        """See `Executor.lost`."""
        if not isinstance(error, BrokenProcessPool):
            return None
        return WorkerLost(
            "a process that shared the work was killed, and so it was whenever its jobs were done "
            "again; memory may have run out",
            remedy="Give fewer --workers.",
        )

    def close(self, *, at_once: bool = False) -> None:
        """See `Executor.close`."""
        if self._pool is None:
            return
        if at_once:
            for process in self._started:
                process.terminate()
        self._pool.shutdown(cancel_futures=True)


def _begin() -> None:
    """Sets a process up; what Drake warns of has been told by the one that it works for."""
    Thread(target=_end_with, args=(parent_process(),), daemon=True).start()
    logging.getLogger("drake").addFilter(lambda record: record.levelno >= logging.ERROR)


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


@contextmanager
def _ctrl_c_held() -> Iterator[None]:
    """Processes started meanwhile never see Ctrl-C: they end when this one does."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
