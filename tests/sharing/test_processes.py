"""Work shared out among processes."""

from __future__ import annotations

import logging
import os
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from drake_screw.sharing import Crew, WorkerLost, share_out


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


def end_twice(tool: Path, job: int) -> int:
    """Ends its process at job 5, at the first two tries."""
    marks = [tool / f"{job}.{number}" for number in range(2)]
    left = [mark for mark in marks if not mark.exists()]
    if job == 5 and left:
        left[0].touch()
        os._exit(1)
    return 10 * job


def test_jobs_of_a_killed_process_are_done_once_more(tmp_path, caplog) -> None:
    done = dict(share_out(end_twice, range(12), build=partial(Path, tmp_path), workers=2))
    assert done == {job: 10 * job for job in range(12)}
    assert len(list(tmp_path.iterdir())) == 2
    assert "was killed; all are started again" in caplog.text


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


BUSY = """
import sys, time
from drake_screw.sharing import share_out
from tests.sharing.test_processes import say_and_wait, tool
from functools import partial

if __name__ == "__main__":
    list(share_out(say_and_wait, range(2), build=partial(tool, 0), workers=2))
"""


def say_and_wait(tool: list[int], job: int) -> None:
    print(os.getpid(), flush=True)
    time.sleep(60)


def test_processes_end_with_the_one_they_work_for(tmp_path) -> None:
    """However that one ends."""
    script = tmp_path / "busy.py"
    script.write_text(BUSY)
    root = str(Path(__file__).parents[2])
    main = subprocess.Popen(
        [sys.executable, str(script)],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": root},
    )
    assert main.stdout is not None
    workers = [int(main.stdout.readline()) for _ in range(2)]
    main.kill()
    main.wait()
    late = time.monotonic() + 30
    while any(map(alive, workers)):
        assert time.monotonic() < late
        time.sleep(0.05)


def alive(process: int) -> bool:
    """A process that has ended and that nobody has asked about, a zombie, is not."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"
