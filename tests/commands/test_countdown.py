"""How far long work is, and how long it will yet take."""

from __future__ import annotations

import io
import logging

from rich.console import Console

from drake_screw.commands.countdown import Countdown, Pace
from drake_screw.steps import Step


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


def test_the_rest_is_expected_to_go_as_it_went() -> None:
    clock = Clock()
    pace = Pace(clock)
    assert pace.of(0, 4) == "0 of 4"
    clock.now = 30.0
    assert pace.of(1, 4) == "1 of 4, about 1.5 min left"
    clock.now = 45.0
    assert pace.of(3, 4) == "3 of 4, about 15 s left"


def test_what_was_done_before_does_not_count_as_fast_work() -> None:
    """A round that is carried on begins with 90 of 100; and the next lot begins anew."""
    clock = Clock()
    pace = Pace(clock)
    pace.of(90, 100)
    clock.now = 10.0
    assert pace.of(95, 100) == "95 of 100, about 10 s left"
    assert pace.of(0, 50) == "0 of 50"
    clock.now = 20.0
    assert pace.of(25, 50) == "25 of 50, about 10 s left"


def test_without_a_terminal_there_is_a_line_now_and_then(caplog) -> None:
    caplog.set_level(logging.INFO, "drake_screw")
    clock = Clock()
    with Countdown(Console(file=io.StringIO()), clock, at_once=True) as countdown:
        for done in range(5):
            countdown(Step("executed", done, 4))
            clock.now += 6.0
    assert [record.getMessage() for record in caplog.records] == [
        "executed 0 of 4",
        "executed 2 of 4, about 12 s left",
    ]
