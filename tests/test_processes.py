"""Work shared out among processes."""

from __future__ import annotations

import logging
import os
from functools import partial

import pytest

from drake_screw.processes import Crew, WorkerLost, share_out


def tool(start: int) -> list[int]:
    return [start, os.getpid()]


def add(tool: list[int], job: int) -> tuple[int, int]:
    tool[0] += 0
    return tool[0] + job, tool[1]


def fail(tool: list[int], job: int) -> int:
    if job == 3:
        raise ValueError("job 3")
    return job


def end(tool: list[int], job: int) -> int:
    os._exit(1)


@pytest.mark.parametrize("workers", [1, 2])
def test_every_job_is_done_once_and_keeps_its_place(workers: int) -> None:
    jobs = list(range(20))
    done = dict(share_out(add, jobs, build=partial(tool, 100), workers=workers))
    assert {place: total for place, (total, _) in done.items()} == {j: 100 + j for j in jobs}
    processes = {process for _, process in done.values()}
    assert len(processes) <= workers
    assert (os.getpid() in processes) == (workers == 1)


@pytest.mark.parametrize("workers", [1, 2])
def test_a_crew_stays_for_several_lots(workers: int) -> None:
    with Crew(partial(tool, 100), workers) as crew:
        lots = [dict(crew.share(add, range(first, first + 6))) for first in (0, 6)]
        with pytest.raises(ValueError, match="job 3"):
            list(crew.share(fail, range(8)))
        lots.append(dict(crew.share(add, [7])))
    assert [{j: total for j, (total, _) in lot.items()} for lot in lots] == [
        {j: 100 + j for j in range(6)},
        {j: 106 + j for j in range(6)},
        {0: 107},
    ]
    processes = {process for lot in lots for _, process in lot.values()}
    assert len(processes) <= workers
    assert (os.getpid() in processes) == (workers == 1)


def test_nothing_is_built_for_no_work() -> None:
    assert list(share_out(add, [], build=lambda: pytest.fail("built"), workers=2)) == []


@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_of_a_job_ends_the_work(workers: int) -> None:
    with pytest.raises(ValueError, match="job 3"):
        list(share_out(fail, range(8), build=partial(tool, 0), workers=workers))


def test_a_killed_process_is_told_with_a_remedy() -> None:
    with pytest.raises(WorkerLost, match="was killed") as error:
        list(share_out(end, range(4), build=partial(tool, 0), workers=2))
    assert "--workers" in str(error.value)


def warns(tool: list[int], job: int) -> int:
    logger = logging.getLogger("drake")
    logger.warning("a link has no mass")
    logger.error("the model cannot be read")
    return job


def test_what_drake_warns_of_is_not_said_again_by_each_process(capfd) -> None:
    list(share_out(warns, range(4), build=partial(tool, 0), workers=2))
    said = capfd.readouterr().err
    assert "cannot be read" in said
    assert "no mass" not in said
