"""What work is shared out on, and what may go wrong with it."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, Protocol, TypeVar

from drake_screw.errors import DrakeScrewError

_Result = TypeVar("_Result")


class SharingError(DrakeScrewError):
    """Work could not be shared out to its end."""


class WorkerLost(SharingError):
    """A process that shared the work was killed, more than once."""


class Executor(Protocol):
    """Processes that carry out calls, several at a time.

    Attributes:
        tries: how often a call whose process was lost is made before that is an error.
    """

    tries: int

    @property
    def width(self) -> int:
        """How many calls are carried out at a time, as things are; processes come and go."""
        ...

    @property
    def lot_seconds(self) -> float:
        """How long a lot of jobs is to take: far longer than sending it, and little to lose."""
        ...

    def submit(self, call: Callable[..., _Result], *arguments: Any) -> Future[_Result]:
        """Have a function of a module called; it and its arguments are pickled."""
        ...

    def watch(self) -> None:
        """Called every second or so while calls are awaited.

        Raises:
            SharingError: nobody is left who could carry them out.
        """
        ...

    def lost(self, error: Exception) -> SharingError | None:
        """What became of a process whose call ended so; None where the error is the call's own."""
        ...

    def close(self, *, at_once: bool = False) -> None:
        """Nothing more will be submitted by this crew.

        Args:
            at_once: do not wait for calls under way; nobody needs what comes of them.
        """
        ...
