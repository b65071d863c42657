"""The teaching page: the hand is dragged and jogged, and what is recorded is trimmed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from tests.browser.conftest import Browser, program

TEACH = """
import numpy as np
from drake_screw.acquisition import Suggestion
from drake_screw.acquisition.interactive_teacher import InteractiveTeacher
from drake_screw.assembly.setup import Setup
from drake_screw.scenario.loader import load_scenario
from drake_screw.web.teaching_page import TeachingPage
setup = Setup(load_scenario("pouring"))
teacher = InteractiveTeacher(TeachingPage(setup), setup.area)
place = Suggestion(6, np.array([[0.85, 0.032, 0.0]]), 2)
lesson = teacher.demonstrate(place, number=0, used=(), rng=np.random.default_rng(0))
print(lesson.recording.name, lesson.remark, lesson.recording.notes[-1])
"""
HAND = "workcell/baxter/left_hand"


@pytest.fixture(scope="module")
def teaching(browser) -> Iterator[Browser]:
    """The page while it waits for a demonstration, which ends with these tests."""
    with program(TEACH) as (url, process):
        browser.open(url)
        browser.until(lambda: "is wanted at bowl x 0.850" in browser.text("#headline"))
        browser.until(lambda: browser.text("#handle .name") == "left_hand")
        browser.process = process
        yield browser


def hand(browser: Browser) -> np.ndarray:
    """X_WE (4, 4) of the hand that is drawn; the page's y is up."""
    X = browser.node(HAND)["matrix"]
    return np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]) @ X


def settled(browser: Browser) -> np.ndarray:
    browser.still(lambda: hand(browser).round(4).tolist())
    return hand(browser)


def column(browser: Browser, table: str, cell: int) -> list[str]:
    return browser.ask(
        "return [...document.querySelectorAll(arguments[0])].map((c) => c.textContent)",
        f"{table} td:nth-child({cell})",
    )


def test_the_hand_follows_its_handle_and_the_margins_follow_the_joints(teaching) -> None:
    browser = teaching
    before, margins = settled(browser), column(browser, "#arm", 4)
    tip = browser.pixel(before[:3, 3] + 0.1 * before[:3, 0])
    root = browser.pixel(before[:3, 3])
    along = np.subtract(tip, root)
    browser.pull("[data-grip=move0] .line", tuple((0.5 * along).round().astype(int).tolist()))
    browser.until(lambda: np.linalg.norm(hand(browser)[:3, 3] - before[:3, 3]) > 0.03)
    after = settled(browser)
    moved = before[:3, :3].T @ (after[:3, 3] - before[:3, 3])
    assert moved[0] == pytest.approx(0.05, abs=0.012)
    assert moved[1:] == pytest.approx([0.0, 0.0], abs=2e-3)
    np.testing.assert_allclose(after[:3, :3], before[:3, :3], atol=2e-3)
    assert column(browser, "#arm", 4) != margins
    x, y, z = (f"{v:.3f} m" for v in after[:3, 3])
    assert np.allclose(
        [float(c.split()[0]) for c in column(browser, "#pose", 3)[:3]], after[:3, 3], atol=2e-3
    ), (x, y, z)
    steps = browser.ask("return [...document.querySelectorAll('#pose input')].map((i) => i.step)")
    assert steps == ["0.001"] * 3 + ["1"] * 3


def test_a_phone_is_wide_enough_and_a_finger_turns_the_hand(teaching) -> None:
    browser = teaching
    with browser.screen_of(390, 844):
        assert browser.fits()
        before = settled(browser)
        browser.pull("[data-grip=turn2] .line", (25, 20), touch=True)
        browser.until(lambda: np.abs(hand(browser)[:3, :3] - before[:3, :3]).max() > 0.2)
        after = settled(browser)
        np.testing.assert_allclose(after[:3, 2], before[:3, 2], atol=5e-3)
        np.testing.assert_allclose(after[:3, 3], before[:3, 3], atol=2e-3)
    with browser.screen_of(1024, 768):
        assert browser.fits()
    assert browser.complaints() == []


def clock(browser) -> float:
    """s that are recorded; the page shows them while it records."""
    words = browser.text("#clock").split()
    return float(words[1]) if words else np.inf


@pytest.mark.slow
def test_what_was_led_is_taken_back_trimmed_and_accepted(teaching) -> None:
    browser = teaching
    body = browser.driver.find_element("tag name", "body")
    start = settled(browser)
    body.send_keys("r")
    browser.until(lambda: hand(browser)[2, 3] == pytest.approx(start[2, 3] + 1e-3, abs=2e-4))
    browser.click("#record")
    for axis, value in ((1, 0.72), (2, 0.15), (3, 0.12)):
        browser.slide(f"#pose tr:nth-child({axis}) input", value)
    browser.until(lambda: np.allclose(hand(browser)[:3, 3], [0.72, 0.15, 0.12], atol=1e-3))
    there = clock(browser)
    browser.until(lambda: clock(browser) > there + 2.0)  # what is taken back is not the bowl's
    browser.slide("#pose tr:nth-child(1) input", 0.3)
    browser.until(lambda: hand(browser)[0, 3] < 0.4)
    said = clock(browser)
    browser.click("#back")
    browser.until(lambda: clock(browser) < said)
    assert hand(browser)[0, 3] > 0.4
    browser.slide("#pose tr:nth-child(3) input", 0.2)
    browser.until(lambda: hand(browser)[2, 3] == pytest.approx(0.2, abs=1e-3))
    browser.click("#stop")
    browser.until(lambda: "found; planned" in browser.text("#message"))
    browser.until(lambda: browser.node("recording/path"))
    assert "kept to" in browser.text("#kept")
    assert browser.ask("return document.querySelectorAll('#chart .deviation').length") >= 1
    browser.slide("#ends tr:nth-child(1) input", 1.0)
    browser.until(lambda: browser.text("#ends tr:nth-child(1) td:nth-child(3)") == "1.00 s")
    assert browser.complaints() == []
    browser.click("#accept")
    rest = browser.process.stdout.read()
    assert "demo_01 led by hand, 0 cm from the suggestion kept 1.00 s to" in rest
