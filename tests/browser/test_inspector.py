"""The inspector as it is seen and clicked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from rich.console import Console

from drake_screw.commands.inspect_console import inspect_run
from drake_screw.runs.run import new_run, open_run
from drake_screw.scenario.loader import load_scenario
from drake_screw.screws import sclerp_position
from drake_screw.visualization.attempt import DONE, FAILED
from drake_screw.visualization.inspector import SAMPLES
from drake_screw.visualization.palette import STATUS_COLORS
from drake_screw.web.inspector_page import save_page
from drake_screw.web.report_page import write_report
from drake_screw.web.selection import select
from tests.browser.conftest import Browser, program

Y_UP = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1.0]])
"""Takes poses in W to the scene's world, which has y up."""
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


def test_a_saved_page_opens_with_the_arm_where_the_slider_says(browser, page, reader) -> None:
    selection = select(reader, 1)
    tried = reader.attempt(1, selection.instance, selection.demonstration)
    assert tried.failed_segment > 0
    browser.open(page.as_uri())
    browser.until(lambda: browser.text("#headline"))
    place = int(browser.ask("return document.querySelector('#slider').value"))
    assert place > 0
    q = tried.plan.q[tried.samples(SAMPLES)[place]]
    hand = reader.setup.workcells[0].arm.pose(q)
    placed = browser.still(lambda: browser.node(HAND)["matrix"].round(4).tolist())
    np.testing.assert_allclose(Y_UP @ hand, placed, atol=1e-3)


def test_the_end_of_reach_is_shown_in_numbers_and_on_the_arm(browser, opened, reader) -> None:
    selection = select(reader, 1)
    tried = reader.attempt(1, selection.instance, selection.demonstration)
    found, root = tried.unreachable, f"attempts/{tried.number + 1:02d}/ghost/reach"
    browser.slide("#slider", int(browser.ask("return document.querySelector('#slider').max")))
    rows = [browser.text(f"#reach tr:nth-child({i}) td:nth-child(3)").strip() for i in (1, 2, 3)]
    values = [float(row.split()[0]) for row in rows]
    expected = [found.gain[-1], found.singular[-1], found.distance[-1]]
    np.testing.assert_allclose(values, expected, rtol=0.01)
    assert f"at most {found.wrist.most:.3f} m" in browser.text("#headline")
    for part in ("shoulder", "wrist", "sphere", "asked"):
        assert browser.node(f"{root}/{part}")["seen"], part
    browser.click("#ghost-shown")
    assert not browser.node(f"{root}/wrist")["seen"]


def test_two_demonstrations_are_on_one_slider(browser, opened, reader) -> None:
    selection = select(reader, 1)
    first = selection.demonstration
    second = 1 - first
    copy = f"copies/{second + 1:02d}"
    strips = "return document.querySelectorAll('#joints .other').length"
    assert not browser.node(copy)["seen"]
    browser.select("#against", second)
    other = reader.attempt(1, selection.instance, second)
    browser.slide("#slider", 0)
    start = browser.node(f"{copy}/baxter/left_hand")
    assert start["seen"]
    hand = Y_UP @ other.arm.pose(other.plan.q[:1])[0]
    np.testing.assert_allclose(start["matrix"], hand, atol=1e-3)
    assert browser.ask(strips) == 2 * other.arm.n, "a curve and a number for each joint"
    browser.slide("#slider", int(browser.ask("return document.querySelector('#slider').max")))
    assert f"demonstration {second + 1}: segment" in browser.text("#where")
    moved = browser.node(f"{copy}/baxter/left_hand")["matrix"]
    assert np.linalg.norm(moved[:3, 3] - start["matrix"][:3, 3]) > 0.05
    browser.click(f"#demonstrations li:nth-child({second + 1})")
    assert browser.ask("return document.querySelector('#against').value") == str(first)
    assert browser.node(f"copies/{first + 1:02d}")["seen"]
    assert not browser.node(copy)["seen"]
    browser.select("#against", "")
    assert not browser.node(f"copies/{first + 1:02d}")["seen"]
    assert browser.ask(strips) == 0


def test_the_round_before_is_beside(browser, opened, reader) -> None:
    assert "the run: insufficient, ended after 2 rounds" in browser.text("#round-headline")
    browser.click("#before summary")
    shown = browser.driver.find_element("css selector", "#before-map svg")
    assert shown.is_displayed()
    assert browser.text("#before-title") == "round 1"
    assert browser.text("#before-words").startswith("round 1 → 2: of the work area ")
    browser.click("#before summary")


def test_the_map_lies_as_the_scene_does(browser, opened, reader) -> None:
    marks = {}
    for number, demonstration in enumerate(reader.event(1).demonstrations, start=1):
        marks[number] = browser.pixel(demonstration.X_WO[0, :3, 3])
    script = """
        const marks = [...document.querySelectorAll("#map .token")];
        return marks.map((m) => { const b = m.getBoundingClientRect(); return [b.x, b.y]; });
    """
    drawn = np.array(browser.ask(script))
    across = np.sign(drawn[1] - drawn[0])
    seen = np.sign(np.subtract(marks[2], marks[1]))
    assert across[0] == seen[0], "what is to the right on the map is so in 3-D"
    robot = "return document.querySelector('#map .robot').getBoundingClientRect().bottom"
    assert browser.ask(robot) < drawn[:, 1].min()


def test_a_round_without_demonstrations_has_no_empty_headings(browser, tmp_path, capsys) -> None:
    changes = ["demonstrations.initial=0", "demonstrations.budget=1", "objects.0.symmetry=null"]
    for _ in new_run(load_scenario("pouring", changes), tmp_path / "run").events():
        pass
    page = tmp_path / "page.html"
    inspect_run(tmp_path / "run", Console(), round=1, html=page)
    assert "no demonstration in this round: every instance fails" in capsys.readouterr().out
    browser.open(page.as_uri())
    browser.until(lambda: browser.text("#no-demonstration"))
    headings = browser.ask(
        "return [...document.querySelectorAll('h2')].filter((h) => h.offsetParent)"
        ".map((h) => h.firstChild.data)"
    )
    assert headings == ["Instance", "Demonstrations"]


@pytest.mark.parametrize(("width", "height"), [(390, 844), (1024, 700)])
def test_pages_fit_phones_and_laptops(browser, opened, width, height) -> None:
    with browser.screen_of(width, height):
        sizes = """
            return [document.documentElement, panel].map((e) => [e.scrollWidth, e.clientWidth]);
        """
        assert all(wide <= room for wide, room in browser.ask(sizes))
        boxes = {
            name: browser.ask(
                "const b = document.querySelector(arguments[0]).getBoundingClientRect();"
                "return [b.left, b.top, b.right, b.bottom]",
                name,
            )
            for name in ("#panel", "#meshcat-pane", "#track", "#key", "#play", "#where")
        }
        for name, (left, top, right, bottom) in boxes.items():
            assert 0 <= left < right <= width, name
            assert 0 <= top < bottom <= height, name
        left, top, right, bottom = boxes["#meshcat-pane"]
        assert (right - left) * (bottom - top) > 0.3 * width * height
        canvas = "const c = viewer.renderer.domElement; return [c.clientWidth, c.clientHeight]"
        room = [right - left, bottom - top]
        browser.until(lambda: np.allclose(browser.ask(canvas), room, atol=2))
        browser.slide("#slider", 0)
        assert browser.text("#where").startswith("screw segment 1 of")


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
        browser.select("#against", 1)
        browser.until(lambda: (browser.node("copies/02/baxter/left_hand") or {}).get("seen"))
        assert not browser.node("attempts/02")["seen"]
        browser.select("#against", "")
        browser.until(lambda: browser.node("copies/02") is None)
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
    charts = "return [...document.querySelectorAll('svg.chart')].map((c) => c.ariaLabel)"
    assert browser.ask(charts) == ["joint angles along the plan", "reach along the plan"] * 2
    with browser.screen_of(390, 844):
        assert browser.ask("return document.documentElement.scrollWidth") <= 390
    assert browser.driver.find_elements("css selector", "p.bounds") == []
    links = browser.ask("return [...document.links].map((a) => a.getAttribute('href'))")
    assert all((tmp_path / link).is_file() for link in links)
    browser.click("#round-1 a")
    browser.until(lambda: browser.text("#headline").startswith("Demonstration 1 fails"))
