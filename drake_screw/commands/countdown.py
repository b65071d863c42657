"""How far long work is, and how long the rest will take."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

_log = logging.getLogger(__name__)

QUIET = 10.0
"""s, at least, between two lines."""


class Pace:
    """How fast work goes, and when it is time to say so again.

    Args:
        clock: s, from any beginning.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._told = clock, -QUIET
        self._first: tuple[int, int, float] = 0, 0, clock()

    def of(self, done: int, total: int) -> str:
        """How far it is: "3 of 16, about 4 min left".

        The clock starts with another total, or when less is done than at first.
        """
        first, of, began = self._first
        if of != total or done <= first:
            self._first = first, of, began = done, total, self._clock()
        left = time_left(done - first, total - first, self._clock() - began)
        return f"{done:,} of {total:,}" + (left and f", {left}")

    def due(self) -> bool:
        """Whether enough time has gone by since it last was; then it is not for a while."""
        now = self._clock()
        if now - self._told < QUIET:
            return False
        self._told = now
        return True


class Countdown:
    """Shows progress and an estimate of the time left.

    To be used as a context manager, in which the bar is alive. Where the console is no terminal,
    lines go to the log instead.

    Args:
        what: is being done, in words: "executed".
        console: to write to.
        clock: s, from any beginning.
    """

    def __init__(
        self, what: str, console: Console, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._what, self._terminal, self._pace = what, console.is_terminal, Pace(clock)
        self._live = Progress(
            TextColumn(what),
            BarColumn(),
            TextColumn("{task.fields[how_far]}"),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._bar = self._live.add_task(what, total=None, how_far="")

    def __enter__(self) -> Countdown:
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def __call__(self, done: int, total: int) -> None:
        """So many are done of so many."""
        how_far = self._pace.of(done, total)
        self._live.update(self._bar, completed=done, total=total, how_far=how_far)
        if not self._terminal and done < total and self._pace.due():
            _log.info("%s %s", self._what, how_far)


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
