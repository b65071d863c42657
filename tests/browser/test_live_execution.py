"""An execution on a page: the bowl is dragged while the arm approaches, and it pours there."""

from __future__ import annotations

import re

import pytest

from tests.browser.conftest import program

SERVE = """
import sys
from drake_screw.web.execution_page import execute_live
print("well:", execute_live(sys.argv[1], instance=(0.85, 0.3), announce=print))
"""
HAND, BOWL = "station/baxter/left_hand", "station/bowl/bowl"


def reached(headline: str) -> int:
    """The segment, from 1, that an execution is in; beyond the last one when it is done."""
    found = re.search(r"running in segment (\d+)", headline)
    return int(found[1]) if found else 99 if headline == "done" else 0


@pytest.mark.slow
def test_a_bowl_that_is_dragged_is_poured_into_where_it_comes_to_rest(
    browser, finished_run
) -> None:
    with program(SERVE, finished_run) as (url, _):
        browser.open(url)
        browser.until(lambda: browser.text("#start") == "start")
        assert browser.text("#mode") == "Start when you are ready."
        browser.click("#start")
        browser.until(lambda: "followed" in browser.text("#mode"))
        browser.slide("#objects tr:nth-child(1) input", 0.91)
        browser.slide("#objects tr:nth-child(2) input", 0.36)
        browser.until(lambda: -browser.node(BOWL)["matrix"][2, 3] == pytest.approx(0.36, abs=1e-3))
        assert browser.text("#mode").startswith("The arm approaches")
        for segment in range(2, 8):
            browser.until(lambda s=segment: reached(browser.text("#headline")) >= s)
        assert browser.text("#headline") == "done"
        assert browser.text("#done") == "1 done"
        p_BH = browser.node(HAND)["matrix"][:3, 3] - browser.node(BOWL)["matrix"][:3, 3]
        assert (p_BH**2).sum() < 0.35**2
        assert browser.text("#outcome").startswith("planned with ")
        assert re.fullmatch(r"0\.910 m", browser.text("#objects tr:nth-child(1) td:nth-child(3)"))
        assert browser.text("#start") == "start again"
        browser.click("#start")
        browser.until(lambda: browser.text("#headline") in ("idle", "running in segment 1"))
        assert browser.complaints() == []
