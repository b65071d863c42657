"""The one place that shares work out: jobs to processes, each of which builds what it needs once.

Drake's plants do not travel between processes. So what travels is how to build what the work needs,
and the jobs; the answers come back as they are finished. The processes are this machine's or
those of a cluster, which makes no difference to any answer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from typing import Any, Generic, Self, TypeVar

from drake_screw.sharing.at_work import Need, carry_out
from drake_screw.sharing.executor import Executor
from drake_screw.sharing.lots import Lot, Lots
from drake_screw.sharing.processes import Processes, processors

_Tool = TypeVar("_Tool")
_Job = TypeVar("_Job")
_Answer = TypeVar("_Answer")

Workers = int | Executor | None
"""How many processes of this machine, as many as it has processors if None; or a cluster."""

_AHEAD = 2
"""Lots under way for each process: the one it is at, and the next one."""

_LOOK = 1.0  # s, until it is looked at who is there, where nothing is finished


def share_out(
    work: Callable[[_Tool, _Job], _Answer],
    jobs: Sequence[_Job],
    *,
    build: Callable[[], _Tool],
    workers: Workers = None,
) -> Iterator[tuple[int, _Answer]]:
    """Do jobs in several processes.

    Args:
        work: does one job with what `build` makes; a function of a module.
        jobs: what to do; they and the answers are pickled.
        build: makes what the work needs, once in each process; pickled, so a function of a module,
            or a `functools.partial` of one.
        workers: processes of this machine, or a cluster. With 1, or a single job that no cluster
            is there for, everything is done in this one.

    Yields:
        The place of each job in `jobs` and its answer, as they are finished, in any order.

    Raises:
        SharingError: processes were killed, again and again at the same job, or a cluster is lost.
            Whatever a job raises ends the work, too.
    """
    if workers is None or isinstance(workers, int):
        workers = min(workers or processors(), len(jobs))
    with Crew(build, workers) as crew:
        yield from crew.share(work, jobs)


class Crew(Generic[_Tool]):
    """Processes that stay for several shares of jobs; a context manager, which lets them go.

    It waits for the jobs that they are at, unless it is interrupted.

    Args:
        build: makes what the work needs, once in each process; as for `share_out`.
        workers: as for `share_out`.
    """

    def __init__(self, build: Callable[[], _Tool], workers: Workers = None) -> None:
        self._build = build
        self._executor: Executor | None = None
        self._tools: list[_Tool] = []
        if workers is None or isinstance(workers, int):
            count = processors() if workers is None else workers
            self._executor = Processes(count) if count > 1 else None
        else:
            self._executor = workers

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if self._executor is not None:
            self._executor.close(at_once=kind is KeyboardInterrupt)

    def share(
        self, work: Callable[[_Tool, _Job], _Answer], jobs: Sequence[_Job]
    ) -> Iterator[tuple[int, _Answer]]:
        """Do jobs; takes, yields and raises what `share_out` does."""
        if len(jobs) == 0:
            return
        if self._executor is not None:
            yield from _shared(self._executor, Need.of(self._build), work, jobs)
            return
        if not self._tools:
            self._tools.append(self._build())
        for place, job in enumerate(jobs):
            yield place, work(self._tools[0], job)


def _shared(
    executor: Executor, need: Need, work: Callable[[Any, Any], Any], jobs: Sequence[Any]
) -> Iterator[tuple[int, Any]]:
    """Lots are sent as others are finished, so that few are under way however many there are."""
    lots = Lots(len(jobs))
    under_way: dict[Future[tuple[list[Any], float]], Lot] = {}
    try:
        while lots or under_way:
            shares = _AHEAD * max(1, executor.width)
            while lots and len(under_way) < shares:
                lot = lots.take(shares, executor.lot_seconds)
                chosen = [jobs[place] for place in lot.places]
                under_way[executor.submit(carry_out, need, work, chosen)] = lot
            for future in wait(under_way, _LOOK, FIRST_COMPLETED).done:
                lot = under_way.pop(future)
                answered = _answered(executor, future, lot)
                if answered is None:
                    lots.put_back(lot)
                    continue
                answers, seconds = answered
                lots.took(lot, seconds)
                yield from zip(lot.places, answers, strict=True)
            executor.watch()
    finally:
        for future in under_way:
            future.cancel()


def _answered(
    executor: Executor, future: Future[tuple[list[Any], float]], lot: Lot
) -> tuple[list[Any], float] | None:
    """What became of a lot; None where it is to be sent again."""
    error: BaseException | None = None
    try:
        return future.result()
    except Exception as raised:
        error = raised
        lost = executor.lost(raised)
        if lost is None:
            raise
    if lot.tries + 1 < executor.tries:
        return None
    raise lost from error
