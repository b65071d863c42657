"""The workers of a Dask scheduler, on this machine or on others, that work is shared out on.

Dask brings the jobs there and gives those of a worker that died to another one. A worker needs the
files that the work reads at the same paths as here, and the same versions of all that a result
depends on; both are looked at before it does its first job.
"""

from __future__ import annotations

import asyncio
import logging
import pickle
import socket
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, TypeVar
from urllib.parse import urlsplit

from drake_screw.errors import DrakeScrewError, counted, extra
from drake_screw.sharing.executor import SharingError, WorkerLost
from drake_screw.versions import environment

if TYPE_CHECKING:
    from distributed import Client

PATIENCE = 60.0
"""s, that a cluster without workers is waited for."""

_LOT = 0.25  # s, for a lot of jobs at least
_LOTS = 50.0  # in a second, for all workers together, that scheduler and client easily deal with
_ANSWER = 10.0  # s, for a scheduler to answer
_LOOK = 1.0  # s, between looks at who is there
_EXAMPLE = "tcp://HOST:8786"
_SHARED = "Every worker needs the files that are read at the same paths, in a shared folder say."
_ALIKE = "Start the workers with the same environment as here, one in a shared folder say."

_Result = TypeVar("_Result")
_log = logging.getLogger(__name__)


class ClusterError(SharingError):
    """A cluster that cannot be used, or not any more."""


class Cluster:
    """An `Executor` of a Dask scheduler's workers, each of whose threads does jobs by itself.

    Args:
        client: connected to it.
        address: of the scheduler, for messages.
        patience: s, that its workers are waited for when there are none.
    """

    tries = 1  # Dask itself has given a call to others before it says that workers were lost

    def __init__(self, client: Client, address: str, patience: float = PATIENCE) -> None:
        self._client, self._address, self._patience = client, address, patience
        self._executor = client.get_executor(pure=False)
        self._threads, self._looked, self._met = 0, 0.0, False
        self._alone_since: float | None = None
        self._look()

    @property
    def width(self) -> int:
        """See `Executor.width`: threads of all workers."""
        return self._threads

    @property
    def lot_seconds(self) -> float:
        """See `Executor.lot_seconds`; so many that a scheduler of many workers keeps up."""
        return max(_LOT, self._threads / _LOTS)

    def submit(self, call: Callable[..., _Result], *arguments: Any) -> Future[_Result]:
        """See `Executor.submit`."""
        sent = pickle.dumps(_Call(environment(), call, *arguments))
        try:
            future: Future[_Result] = self._executor.submit(pickle.loads, sent)
        except Exception as error:
            raise self._gone() from error
        return future

    def watch(self) -> None:
        """See `Executor.watch`."""
        if time.monotonic() - self._looked > _LOOK:
            self._look()

    def lost(self, error: Exception) -> SharingError | None:
        """See `Executor.lost`."""
        from distributed import KilledWorker

        if isinstance(error, CancelledError):
            return self._gone()
        if isinstance(error, KilledWorker):
            tried = counted(error.allowed_failures + 1, "worker")
            return WorkerLost(
                f"the same jobs ended {tried} that tried them; the last one was "
                f"{error.last_worker.address}",
                remedy="Memory may have run out: give workers more of it (dask worker "
                "--memory-limit), or start fewer on a machine. What they said last may tell.",
            )
        if isinstance(error, ModuleNotFoundError) or "Can't get attribute" in str(error):
            return ClusterError(
                f"a worker at {self._address} does not have drake_screw as it is here: {error}",
                remedy=_ALIKE,
            )
        return None

    def close(self, *, at_once: bool = False) -> None:
        """See `Executor.close`; the cluster stays for other work."""

    def _look(self) -> None:
        """Who is there now; it is waited for if nobody is."""
        self._looked = time.monotonic()
        try:
            self._threads = sum(self._client.nthreads().values())
        except Exception as error:
            raise self._gone() from error
        if self._threads:
            self._alone_since, self._met = None, True
        elif self._alone_since is None:
            self._alone_since = self._looked
            _log.warning(
                "no workers at %s; waiting %.0f s for one: dask worker %s --nthreads 1",
                self._address, self._patience, self._address,
            )  # fmt: skip
        elif self._looked - self._alone_since > self._patience:
            start = f"dask worker {self._address} --nthreads 1 --nworkers auto"
            if self._met:
                raise ClusterError(
                    f"all workers of the scheduler {self._address} are gone; jobs may have ended "
                    "them, for want of memory say",
                    remedy=f"See what they said last, and start some: {start}",
                )
            raise ClusterError(
                f"no workers at the scheduler {self._address}", remedy=f"Start some: {start}"
            )

    def _gone(self) -> ClusterError:
        return ClusterError(
            f"the scheduler at {self._address} is lost",
            remedy="See whether it still runs, and what it said last; start it again: dask "
            "scheduler",
        )


@contextmanager
def cluster(address: str, patience: float = PATIENCE) -> Iterator[Cluster]:
    """A context with the workers of a scheduler.

    Args:
        address: of the scheduler, ``tcp://host:port``; with ``tls://`` by what Dask's own
            configuration says.
        patience: s, to wait for workers where there are none.

    Raises:
        ClusterError: there is no such scheduler, it has no workers, or one of them differs from
            this machine in a version that results depend on.
    """
    with extra("cluster", "sharing work out on a cluster needs Dask", ClusterError):
        from distributed import Client
    _check_address(address)
    quiet = [logging.getLogger(name) for name in ("distributed", "distributed.client")]
    levels = [logger.level for logger in quiet]
    for logger in quiet:
        logger.setLevel(logging.CRITICAL)  # what goes wrong is said by what is raised here
    try:
        _check_scheduler(address)
        try:
            client = Client(address, timeout=_ANSWER, set_as_default=False, name="drake-screw")
        except OSError as error:
            raise _no_scheduler(address) from error
        try:
            joined = Cluster(client, address, patience)
            while joined.width == 0:
                time.sleep(_LOOK / 2)
                joined.watch()
            _check_workers(client.run(environment, on_error="return"))
            yield joined
        finally:
            with suppress(Exception):
                client.close(timeout=2)
    finally:
        for logger, level in zip(quiet, levels, strict=True):
            logger.setLevel(level)


def _check_address(address: str) -> None:
    """Raises ClusterError if nothing listens there."""
    try:
        parts = urlsplit(address)
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if not host or not port or parts.scheme not in ("tcp", "tls"):
        raise ClusterError(
            f"'{address}' is not the address of a scheduler; expected one such as {_EXAMPLE}",
            remedy="Give the address that `dask scheduler` printed at its start.",
        )
    try:
        socket.create_connection((host, port), timeout=_ANSWER).close()
    except (OSError, UnicodeError) as error:
        if isinstance(error, OSError) and not isinstance(error, socket.gaierror):
            why = f"nothing answers there ({error.strerror or error})"
            remedy = f"Start a scheduler on {host}: dask scheduler --port {port}"
        else:
            why, remedy = f"no host '{host}' is known", "Look at how its name is written."
        raise ClusterError(
            f"no scheduler can be reached at {address}: {why}", remedy=remedy
        ) from error


def _check_scheduler(address: str) -> None:
    """Raises ClusterError if what listens there is something else."""
    from distributed import rpc

    async def ask() -> str:
        async with rpc(address) as there:
            return str((await there.identity())["type"])

    async def ask_in_time() -> str:
        return await asyncio.wait_for(ask(), _ANSWER)

    try:
        with ThreadPoolExecutor(1) as apart:  # from an event loop that may run in this thread
            found = apart.submit(asyncio.run, ask_in_time()).result()
    except Exception as error:
        raise _no_scheduler(address) from error
    if found != "Scheduler":
        raise _no_scheduler(address)


def _no_scheduler(address: str) -> ClusterError:
    return ClusterError(
        f"what listens at {address} does not answer as a Dask scheduler does",
        remedy="Give the address that `dask scheduler` printed at its start (Scheduler at: ...), "
        "not that of its dashboard or of a worker.",
    )


def _check_workers(found: Mapping[str, Mapping[str, str] | Exception]) -> None:
    """Raises ClusterError for the first worker that differs from this machine."""
    for address, theirs in sorted(found.items()):
        if isinstance(theirs, Exception):
            raise ClusterError(
                f"worker {address} does not have drake_screw as it is here: {theirs}",
                remedy=_ALIKE,
            )
        _check_alike(address, theirs, environment())


def _check_alike(worker: str, theirs: Mapping[str, str], ours: Mapping[str, str]) -> None:
    unlike = [
        f"{name} is {theirs.get(name, 'not known')} there and {ours[name]} here"
        for name in ours
        if theirs.get(name) != ours[name]
    ]
    if unlike:
        raise ClusterError(
            f"worker {worker} differs from this machine: {'; '.join(unlike)}",
            remedy=f"Results depend on these. {_ALIKE}",
        )


class _Call:
    """A call that is made where it is unpickled.

    A worker that cannot import what is called lives, and says that; if Dask sent the function
    itself it would end.
    """

    def __init__(self, *arguments: Any) -> None:
        self._arguments = arguments

    def __reduce__(self) -> tuple[Any, ...]:
        return _there, self._arguments


def _there(ours: Mapping[str, str], call: Callable[..., _Result], *arguments: Any) -> _Result:
    """Carries a call out in a worker; what it cannot use there is said with its name."""
    from distributed import get_worker

    name = f"{get_worker().address} on {socket.gethostname()}"
    _check_alike(name, environment(), ours)
    try:
        return call(*arguments)
    except DrakeScrewError as error:
        place = "" if error.file is None else f"{error.file}: "
        raise ClusterError(
            f"worker {name} cannot do its part: {place}{error.message}",
            remedy=f"{error.remedy} {_SHARED}" if error.remedy else _SHARED,
        ) from error
