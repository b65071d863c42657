"""How far long work is, and how long the rest will take."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

_log = logging.getLogger(__name__)

QUIET = 10.0
"""s, at least, between two lines."""


class Countdown:
    """Shows progress and an estimate of the time left.

    To be used as a context manager, in which the bar is alive. Where the console is no terminal,
    lines go to the log instead.

    Args:
        what: is being done, in words: "executions".
        console: to write to.
        clock: s, from any beginning.
    """

    def __init__(
        self, what: str, console: Console, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._what, self._clock, self._terminal = what, clock, console.is_terminal
        self._began = self._told = clock()
        self._live = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[left]}"),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._bar = self._live.add_task(what, total=None, left="")

    def __enter__(self) -> Countdown:
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def __call__(self, done: int, total: int) -> None:
        """So many are done of so many; with none the clock starts."""
        now = self._clock()
        if done == 0:
            self._began = now
        left = time_left(done, total, now - self._began)
        self._live.update(self._bar, completed=done, total=total, left=left)
        if not self._terminal and done < total and (done == 0 or now - self._told >= QUIET):
            self._told = now
            _log.info("%s: %d of %d%s", self._what, done, total, left and f", {left}")


def time_left(done: int, total: int, elapsed: float) -> str:
    """How long the rest will take if it goes on as it went; empty before anything is done.

    Args:
        done, total: how many are done, and how many there are.
        elapsed: s since the first one began.

    >>> time_left(8, 32, 30.0), time_left(31, 32, 62.0), time_left(0, 32, 5.0)
    ('about 1.5 min left', 'about 2 s left', '')
    """
    if done == 0:
        return ""
    seconds = elapsed * (total - done) / done
    if seconds < 60.0:
        return f"about {seconds:.0f} s left"
    return f"about {seconds / 60.0:.1f} min left"
