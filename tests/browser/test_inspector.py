"""The inspector as it is seen and clicked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from drake_screw.runs.run import open_run
from drake_screw.screws import sclerp_position
from drake_screw.visualization.attempt import DONE, FAILED
from drake_screw.visualization.palette import STATUS_COLORS
from drake_screw.web.inspector_page import save_page
from drake_screw.web.report_page import write_report
from drake_screw.web.selection import select
from tests.browser.conftest import Browser, program

HAND = "workcell/baxter/left_hand"
SERVE = """
import sys
from pathlib import Path
from rich.console import Console
from drake_screw.commands.inspect_console import inspect_run
inspect_run(Path(sys.argv[1]), Console(width=200), round=1)
"""


@pytest.fixture(scope="module")
def reader(finished_run):
    return open_run(finished_run).reader


@pytest.fixture(scope="module")
def page(reader, tmp_path_factory) -> Path:
    """The second round's suggested instance, with both demonstrations."""
    return save_page(reader, select(reader, 1), tmp_path_factory.mktemp("page") / "p.html")


@pytest.fixture
def opened(browser, page, reader) -> None:
    """The page as it opens; it is loaded once, and put back for each test."""
    if browser.driver.current_url != page.as_uri():
        browser.open(page.as_uri())
        browser.until(lambda: browser.text("#headline"))
    for box, checked in {"arm": 1, "ghost": 1, "dots": 0}.items():
        toggle(browser, f"#{box}-shown", bool(checked))
    toggle(browser, "#all-axes", False)
    best = select(reader, 1).demonstration + 1
    browser.click(f"#demonstrations li:nth-child({best})")


def toggle(browser: Browser, box: str, checked: bool) -> None:
    """Click a check box unless it is as wanted."""
    if browser.ask("return document.querySelector(arguments[0]).checked", box) != checked:
        browser.click(box)


def near(screen: np.ndarray, at: tuple[int, int], color: str, *, reach: int = 5) -> bool:
    """Whether a colour's hue is seen near a pixel: lights make it brighter or darker."""
    x, y = at
    patch = screen[y - reach : y + reach + 1, x - reach : x + reach + 1].reshape(-1, 3)
    want = np.array(to_rgb(color)) - np.mean(to_rgb(color))
    have = patch - patch.mean(axis=1, keepdims=True)
    size = np.linalg.norm(have, axis=1)
    agree = have @ want / np.maximum(size * np.linalg.norm(want), 1e-9)
    return bool(((agree > 0.93) & (size > 0.12)).any())


def test_screw_segments_have_their_colours_where_they_are(browser, opened, reader) -> None:
    selection = select(reader, 1)
    tried = reader.attempt(1, selection.instance, selection.demonstration)
    for box in ("#arm-shown", "#ghost-shown"):
        browser.click(box)
    screens = browser.screen()
    for segment, status in enumerate(tried.status):
        if status not in (DONE, FAILED):
            continue
        end = float(tried.plan.outcome.fraction) if status == FAILED else 1.0
        s = np.linspace(0.2, 0.8, 5) * end
        track = sclerp_position(tried.starts[segment], tried.guides[segment], s)
        if np.linalg.norm(track[-1] - track[0]) < 0.05:
            continue
        seen = [near(screens, browser.pixel(p), STATUS_COLORS[status]) for p in track]
        assert sum(seen) >= 3, (segment, status, seen)
    assert FAILED in tried.status


def test_the_ghost_stands_where_the_plan_failed(browser, opened, reader) -> None:
    selection = select(reader, 1)
    ghost = f"attempts/{selection.demonstration + 1:02d}/ghost"
    assert browser.node(ghost)["seen"]
    last = int(browser.ask("return document.querySelector('#slider').max"))
    browser.slide("#slider", last)
    arm, copy = browser.node(HAND), browser.node(f"{ghost}/baxter/left_hand")
    assert np.allclose(arm["matrix"], copy["matrix"], atol=1e-3)
    browser.click("#ghost-shown")
    assert not browser.node(ghost)["seen"]


def test_the_slider_moves_the_arm_and_the_table(browser, opened, reader) -> None:
    selection = select(reader, 1)
    tried = reader.attempt(1, selection.instance, selection.demonstration)
    places, margins = [], []
    for index in (0, 30, 60):
        browser.slide("#slider", index)
        places.append(browser.node(HAND)["matrix"][:3, 3])
        margins.append(browser.text("#joints tbody tr:nth-child(4) td:last-child"))
    assert np.linalg.norm(places[1] - places[0]) > 0.02
    assert np.linalg.norm(places[2] - places[1]) > 0.02
    assert len(set(margins)) == 3
    assert margins[0] == f"{tried.margin[0, 3]:.3f} rad"


def test_play_runs_to_the_end(browser, opened) -> None:
    last = int(browser.ask("return document.querySelector('#slider').max"))
    browser.slide("#slider", last - 3)
    browser.click("#play")
    browser.until(lambda: browser.text("#play") == "play")
    assert int(browser.ask("return document.querySelector('#slider').value")) == last


def test_a_page_shows_each_demonstration_by_itself(browser, opened) -> None:
    for number in (1, 2):
        browser.click(f"#demonstrations li:nth-child({number})")
        assert browser.text("#headline").startswith(f"Demonstration {number} ")
        assert browser.node(f"attempts/{number:02d}")["seen"]
        assert not browser.node(f"attempts/{3 - number:02d}")["seen"]
    assert not browser.driver.find_element("css selector", "#steps").is_displayed()
    assert browser.complaints() == []


def test_the_screws_at_the_slider_and_at_the_failure_show_their_axes(
    browser, opened, reader
) -> None:
    selection = select(reader, 1)
    tried = reader.attempt(1, selection.instance, selection.demonstration)
    axes = [f"attempts/{tried.number + 1:02d}/axes/{i:02d}" for i in range(1, 6)]

    def shown() -> set[int]:
        nodes = [browser.node(path) for path in axes]
        return {i for i, node in enumerate(nodes) if node and node["seen"]}

    browser.slide("#slider", 0)
    assert shown() == {0, tried.failed_segment}
    browser.click("#all-axes")
    assert shown() == set(range(5))


def test_the_live_page(browser, finished_run, reader) -> None:
    with program(SERVE, finished_run) as (url, _):
        browser.open(url)
        browser.until(lambda: browser.text("#headline"))
        browser.until(lambda: browser.node("attempts/01/segments/01"))
        assert "suggested place" in browser.text("#which")
        assert "instances" in browser.text("#map-words")
        browser.click("[data-step=earliest]")
        browser.until(lambda: "failing, 1 of" in browser.text("#which"))
        before = browser.text("#where-it-is")
        browser.click("[data-step=next]")
        browser.until(lambda: "failing, 2 of" in browser.text("#which"))
        assert browser.text("#where-it-is") != before
        browser.slide("#slider", 0)
        start = browser.node(HAND)["matrix"][:3, 3]
        browser.slide("#slider", 80)
        assert np.linalg.norm(browser.node(HAND)["matrix"][:3, 3] - start) > 0.05
        browser.select("#region", 15)
        browser.until(lambda: "in this region" in browser.text("#which"))
        browser.select("#round", 1)
        browser.until(lambda: "2 demonstrations" in browser.text("#round-headline"))
        browser.click("#demonstrations li:nth-child(1)")
        browser.until(lambda: browser.text("#headline").startswith("Demonstration 1 "))
        browser.until(lambda: (browser.node("attempts/01/segments/01") or {}).get("seen"))
        assert browser.node("attempts/02") is None
        here = browser.text("#where-it-is")
        browser.ask("arguments[0].scrollTop = 0", browser.driver.find_element("id", "panel"))
        browser.click("#map svg")
        browser.until(lambda: browser.text("#where-it-is") != here)
        assert browser.complaints() == []


def test_the_report_stands_alone(browser, reader, tmp_path) -> None:
    report = write_report(reader, tmp_path)
    browser.open(report.as_uri())
    pictures = "return [...document.images].map((i) => i.naturalWidth)"
    assert len(browser.ask(pictures)) == 3
    assert all(width > 500 for width in browser.ask(pictures))
    assert browser.ask("return document.querySelectorAll('svg.chart').length") == 2
    links = browser.ask("return [...document.links].map((a) => a.getAttribute('href'))")
    assert all((tmp_path / link).is_file() for link in links)
    browser.click("#round-1 a")
    browser.until(lambda: browser.text("#headline").startswith("Demonstration 1 fails"))
