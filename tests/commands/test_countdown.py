"""How far long work is, and how long it will yet take."""

from __future__ import annotations

import io
import logging
import re

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


def test_parts_are_told_in_percent_and_nothing_of_what_is_soon_done(caplog) -> None:
    caplog.set_level(logging.INFO, "drake_screw")
    clock = Clock()
    with Countdown(Console(file=io.StringIO()), clock) as countdown:
        for part in (0.1, 0.2, 0.6, 1.0):
            countdown(Step("reading log.csv", part, 1.0))
            clock.now += 6.0
        countdown(Step("comparing"))
    assert [record.getMessage() for record in caplog.records] == [
        "reading log.csv 60%, about 10 s left"
    ]


def test_another_step_has_a_pace_of_its_own(caplog) -> None:
    caplog.set_level(logging.INFO, "drake_screw")
    clock = Clock()
    with Countdown(Console(file=io.StringIO()), clock) as countdown:
        countdown(Step("slow", 0, 4))
        clock.now = 100.0
        countdown(Step("quick", 0, 4))
        clock.now = 120.0
        countdown(Step("quick", 2, 4))
    assert caplog.records[-1].getMessage() == "quick 2 of 4, about 20 s left"


def test_on_a_terminal_every_step_is_seen_and_nothing_is_left() -> None:
    shown = io.StringIO()
    with Countdown(Console(file=shown, force_terminal=True, width=80)) as countdown:
        countdown(Step("reading the run"))
        countdown._live.refresh()
        countdown(Step("drawing pictures", 1, 3))
        countdown._live.refresh()
    text = shown.getvalue()
    assert "reading the run" in text
    assert re.search(r"drawing pictures.*1 of 3", text)
    assert text.endswith("\x1b[2K")  # the line is cleared
