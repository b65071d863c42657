"""How far long work is, and how long the rest will take."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from drake_screw.steps import Step

_log = logging.getLogger(__name__)

QUIET = 10.0
"""s, at least, between two lines."""


class Pace:
    """How fast work goes, and when it is time to say so again.

    Args:
        clock: s, from any beginning.
        at_once: whether there is something to say at the beginning; else not before `QUIET`.
    """

    def __init__(
        self, clock: Callable[[], float] = time.monotonic, *, at_once: bool = True
    ) -> None:
        self._clock, self._told = clock, -QUIET if at_once else clock()
        self._first: tuple[float, float, float] = 0, 0, clock()

    def of(self, done: float, total: float) -> str:
        """How far it is: "3 of 16, about 4 min left"; "19 %, ..." where the total is 1.0.

        The clock starts with another total, or when less is done than at first.
        """
        first, of, began = self._first
        if of != total or done <= first:
            self._first = first, of, began = done, total, self._clock()
        left = time_left(done - first, total - first, self._clock() - began)
        far = f"{done:.0%}" if isinstance(total, float) else f"{done:,} of {total:,}"
        return far + (left and f", {left}")

    def start(self) -> None:
        """Something else begins."""
        self._first = 0, 0, self._clock()

    def due(self) -> bool:
        """Whether enough time has gone by since it last was; then it is not for a while."""
        now = self._clock()
        if now - self._told < QUIET:
            return False
        self._told = now
        return True


class Countdown:
    """Shows what is done, how far it is and an estimate of the time left.

    To be used as a context manager, in which the line is alive. Where the console is no terminal,
    lines go to the log instead, now and then, of work whose end is known.

    Args:
        console: to write to.
        clock: s, from any beginning.
        at_once: whether the first line in the log comes at once.
    """

    def __init__(
        self,
        console: Console,
        clock: Callable[[], float] = time.monotonic,
        *,
        at_once: bool = False,
    ) -> None:
        self._terminal, self._pace = console.is_terminal, Pace(clock, at_once=at_once)
        self._live = shown_progress(console)
        self._bar = self._live.add_task("starting", total=None, detail="")
        self._words = ""

    def __enter__(self) -> Countdown:
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def detail(self, words: str, text: str) -> None:
        """What is done, and how far it is in words of its own; not in the log."""
        self._begin(words)
        self._live.update(self._bar, detail=text)

    @contextmanager
    def aside(self) -> Iterator[None]:
        """A context in which it is not shown, since somebody is asked something."""
        self._live.stop()
        try:
            yield
        finally:
            self._live.start()

    def __call__(self, step: Step) -> None:
        """A step has begun, or so much of it is done."""
        self._begin(step.words)
        if step.total is None:
            return
        how_far = self._pace.of(step.done, step.total)
        self._live.update(self._bar, completed=step.done, total=step.total, detail=how_far)
        if not self._terminal and step.done < step.total and self._pace.due():
            _log.info("%s %s", step.words, how_far)

    def _begin(self, words: str) -> None:
        if words != self._words:
            self._words = words
            self._pace.start()
            self._live.reset(self._bar, total=None, description=words, detail="")


def shown_progress(console: Console, *, hidden: bool = False) -> Progress:
    """A line that is alive where the console is a terminal: what is done, a bar, `detail`, time."""
    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=12),
        TextColumn("{task.fields[detail]}", markup=False),
        TimeElapsedColumn(),
        console=console,
        transient=True,
        disable=hidden or not console.is_terminal,
    )


def time_left(done: float, total: float, elapsed: float) -> str:
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
    if seconds < 5400.0:
        return f"about {seconds / 60.0:.1f} min left"
    return f"about {seconds / 3600.0:.1f} h left"
