"""A Dask scheduler and workers as processes of their own, such as can be killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Self

from drake_screw.sharing.cluster import Cluster

ROOT = Path(__file__).parents[2]


class DaskProcesses:
    """A scheduler and some workers on this machine; a context manager, which ends them.

    Attributes:
        address: of the scheduler.
    """

    def __init__(self, folder: Path, *, nanny: bool = False) -> None:
        self._folder, self._nanny = folder, nanny
        self._workers: list[subprocess.Popen[str]] = []
        file = folder / "scheduler.json"
        self._scheduler = self._start(
            "dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
            "--dashboard-address", ":0", "--scheduler-file", str(file),
        )  # fmt: skip
        late = time.monotonic() + 60
        while not file.is_file():
            assert time.monotonic() < late, "the scheduler does not start"
            time.sleep(0.05)
        time.sleep(0.1)
        self.address: str = json.loads(file.read_text())["address"]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for process in (*self._workers, self._scheduler):
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()

    def start_workers(self, count: int) -> None:
        """Start some more workers, of one thread each."""
        nanny = "--nanny" if self._nanny else "--no-nanny"
        for _ in range(count):
            worker = self._start(
                "dask_worker", self.address, "--nthreads", "1", nanny, "--no-dashboard",
                "--local-directory", str(self._folder),
            )  # fmt: skip
            self._workers.append(worker)

    @staticmethod
    def wait_for_workers(joined: Cluster, count: int) -> None:
        """Wait until there are so many."""
        late = time.monotonic() + 60
        while joined.width != count:
            assert time.monotonic() < late, f"{joined.width} workers"
            time.sleep(0.2)
            joined.watch()

    def kill_worker(self, number: int) -> None:
        """Kill one as the operating system does when memory runs out."""
        os.killpg(self._workers[number].pid, signal.SIGKILL)

    def kill_scheduler(self) -> None:
        """Kill the scheduler."""
        os.killpg(self._scheduler.pid, signal.SIGKILL)

    def _start(self, program: str, *arguments: str) -> subprocess.Popen[str]:
        with (self._folder / f"{program}_{len(self._workers)}.log").open("w") as log:
            return subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.{program}", *arguments],
                stdout=log,
                stderr=log,
                text=True,
                start_new_session=True,
                env={**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"},
            )
