"""How jobs are cut into lots, and how many of these are under way."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import pytest

from drake_screw.sharing import SharingError, WorkerLost, crew, share_out
from drake_screw.sharing.lots import Lots


class Lost(Exception):
    pass


class Here:
    """An executor that carries a call out when it is next looked at."""

    width, lot_seconds = 3, 0.25

    def __init__(self, tries: int = 3, fails: Callable[[list[int]], bool] = lambda jobs: False):
        self.tries, self.fails = tries, fails
        self.under_way: list[tuple[Future, Any, tuple]] = []
        self.sent: list[list[int]] = []
        self.most = 0

    def submit(self, call: Callable[..., Any], *arguments: Any) -> Future:
        future: Future = Future()
        self.under_way.append((future, call, arguments))
        self.sent.append(list(arguments[-1]))
        self.most = max(self.most, len(self.under_way))
        if len(self.under_way) == 2 * self.width:
            self.finish(1)
        return future

    def watch(self) -> None:
        if not any(future.done() for future, _, _ in self.under_way):
            self.finish(1)

    def finish(self, count: int) -> None:
        for future, call, arguments in self.under_way[:count]:
            if self.fails(arguments[-1]):
                future.set_exception(Lost())
            else:
                future.set_result(call(*arguments))
        del self.under_way[:count]

    def lost(self, error: Exception) -> SharingError | None:
        return WorkerLost("lost") if isinstance(error, Lost) else None

    def close(self, *, at_once: bool = False) -> None:
        self.closed = True


@pytest.fixture(autouse=True)
def looks_often(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crew, "_LOOK", 0.01)


def nothing() -> None:
    return None


def double(_: None, job: int) -> int:
    return 2 * job


def test_few_lots_are_under_way_however_many_jobs_there_are() -> None:
    here = Here()
    done = dict(share_out(double, range(30_000), build=nothing, workers=here))
    assert done == {job: 2 * job for job in range(30_000)}
    assert here.most == 2 * here.width
    assert here.closed
    assert sorted(job for lot in here.sent for job in lot) == list(range(30_000))
    assert len(here.sent) < 1000  # such short jobs go many to a lot


@pytest.mark.parametrize("seconds", [0.001, 0.02, 3.0])
def test_a_lot_takes_a_quarter_second_or_is_a_single_job(seconds: float) -> None:
    lots = Lots(10_000)
    assert len(lots.take(4, 0.25).places) == 1
    for _ in range(5):
        lot = lots.take(4, 0.25)
        lots.took(lot, seconds * len(lot.places))
    jobs = len(lots.take(4, 0.25).places)
    assert jobs == max(1, int(0.25 / seconds))


def test_the_last_lots_are_small_so_that_all_have_some() -> None:
    lots = Lots(41)
    first = lots.take(4, 0.25)
    lots.took(first, 1e-6)
    sizes = []
    while lots:
        sizes.append(len(lots.take(4, 0.25).places))
    assert sum(sizes) == 40
    assert sizes[0] == 10
    assert sizes[-1] == 1


def test_a_lost_lot_is_sent_again_job_by_job() -> None:
    tried: dict[int, int] = {}

    def fails(jobs: list[int]) -> bool:
        if len(jobs) > 1 and 20 in jobs:
            return True
        if jobs == [20]:
            tried[20] = tried.get(20, 0) + 1
            return tried[20] == 1
        return False

    here = Here(fails=fails)
    done = dict(share_out(double, range(500), build=nothing, workers=here))
    assert done == {job: 2 * job for job in range(500)}
    assert tried == {20: 2}


def test_a_job_that_ends_whoever_does_it_is_sent_as_often_as_said() -> None:
    for tries in (1, 3):
        here = Here(tries, fails=lambda jobs: 2 in jobs)
        with pytest.raises(WorkerLost):
            dict(share_out(double, range(5), build=nothing, workers=here))
        assert sum(2 in lot for lot in here.sent) == tries


def test_whoever_stops_asking_has_the_rest_cancelled() -> None:
    here = Here()
    answers = share_out(double, range(100), build=nothing, workers=here)
    for _ in range(7):
        next(answers)
    under_way = [future for future, _, _ in here.under_way]
    assert under_way
    answers.close()
    assert all(future.cancelled() for future in under_way)
    assert here.closed
