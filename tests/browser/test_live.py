"""A run that is going on, and an interactive teacher, as they are seen and clicked."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.acquisition import Finished, RegionsEvaluated, RoundFinished
from drake_screw.runs.run import open_run
from drake_screw.web.live_page import LivePage
from tests.browser.conftest import program

TEACH = """
import sys
import numpy as np
from drake_screw.acquisition import Suggestion
from drake_screw.acquisition.interactive_teacher import InteractiveTeacher
from drake_screw.assembly.setup import Setup
from drake_screw.scenario.loader import load_scenario
from drake_screw.web.teaching_page import TeachingPage
setup = Setup(load_scenario("pouring"))
teacher = InteractiveTeacher(TeachingPage(setup), setup.area)
place = Suggestion(6, np.array([[0.85, 0.45, 0.0]]), 2)
lesson = teacher.demonstrate(place, number=0, used=(), rng=np.random.default_rng(0))
demonstration = setup.learn(lesson.recording)
print(lesson.recording.name, lesson.remark, len(demonstration.X_OE))
"""


@pytest.fixture(scope="module")
def run(finished_run):
    return open_run(finished_run)


def test_a_run_is_told_as_it_happens(browser, run) -> None:
    view = LivePage(run.setup)
    try:
        browser.open(view.url)
        browser.until(lambda: "starting" in browser.text("#headline"))
        for event in run.replay():
            view(event)
            if isinstance(event, RoundFinished):
                number = event.round + 1
                browser.until(lambda n=number: f"round {n}: not" in browser.text("#headline"))
                path = f"rounds/{number:02d}"
                browser.until(lambda p=path: (browser.node(f"{p}/regions") or {}).get("seen"))
                assert browser.node("instances/success") is not None
                assert browser.node(f"{path}/next/bowl/ring")["seen"]
                verdict = event.verdict
                assert f"weakest region: {event.regions.name(verdict.region)}" in browser.text(
                    "#details"
                )
            if isinstance(event, Finished):
                browser.until(lambda: browser.text("#headline") == "insufficient")
        rounds = browser.ask("return document.querySelectorAll('#rounds li').length")
        demonstrations = browser.ask(
            "return document.querySelectorAll('#demonstrations li').length"
        )
        assert (rounds, demonstrations) == (2, 2)
        assert browser.complaints() == []
    finally:
        view.close()


def test_regions_fill_while_a_round_goes_on(browser, run) -> None:
    view = LivePage(run.setup)
    try:
        browser.open(view.url)
        K = run.setup.regions.K
        samples = np.full(K, 50)
        failures = np.where(np.arange(K) == 5, 40, 0)
        view(RegionsEvaluated(0, samples, failures))
        browser.until(lambda: "80.00% in region 5" in browser.text("#details"))
        browser.until(lambda: browser.node("progress/regions"))
        lower, upper = run.setup.regions.bounds(np.array([5, 6]))
        z = float(run.setup.area.z[0]) + 0.005
        middle = [[*p, z] for p in ((lower + upper) / 2.0)[:, 0, :2]]

        def apart() -> bool:
            screen = browser.screen()
            failing, fine = (screen[y, x] for x, y in map(browser.pixel, middle))
            return bool(
                failing.mean() < fine.mean() - 0.25
                and failing[2] > failing[1] + 0.15
                and fine.min() > 0.75
            )

        browser.until(apart)
    finally:
        view.close()


@pytest.mark.slow
def test_a_demonstration_is_given_by_clicks_alone(browser) -> None:
    with program(TEACH) as (url, process):
        browser.open(url)
        browser.until(lambda: "is wanted at bowl x 0.850" in browser.text("#headline"))
        browser.until(lambda: (browser.node("progress/next/bowl/ring") or {}).get("seen"))
        start = browser.node("workcell/baxter/left_hand")["matrix"][:3, 3]
        browser.click("#record")
        browser.until(lambda: "recording" in browser.text("#clock"))
        for axis, value in ((1, 0.72), (2, 0.56), (3, 0.10)):
            browser.slide(f"#pose tr:nth-child({axis}) input", value)
        moved = "workcell/baxter/left_hand"
        browser.until(lambda: np.linalg.norm(browser.node(moved)["matrix"][:3, 3] - start) > 0.35)
        joint = browser.still(lambda: browser.text("#arm tr:nth-child(1) td:nth-child(3)"))
        browser.slide("#arm tr:nth-child(7) input", 0.9)
        browser.until(
            lambda: abs(float(browser.text("#arm tr:nth-child(7) td:nth-child(3)")) - 0.9) < 0.01
        )
        assert browser.text("#arm tr:nth-child(1) td:nth-child(3)") == joint
        browser.click("#stop")
        browser.until(lambda: "found; planned" in browser.text("#message"))
        browser.until(lambda: browser.node("attempts/01/segments/01"))
        assert browser.driver.find_elements("css selector", "#segments li")
        browser.click("#repeat")
        browser.until(lambda: browser.node("attempts") is None)
        browser.click("#record")
        for axis, value in ((1, 0.70), (2, 0.56), (3, 0.10)):
            browser.slide(f"#pose tr:nth-child({axis}) input", value)
        browser.until(
            lambda: (
                browser.text("#pose tr:nth-child(2) td:nth-child(3)") == "0.560 m"
                and float(browser.text("#clock").split()[1]) > 2.0
            )
        )
        browser.click("#stop")
        browser.until(lambda: "found; planned" in browser.text("#message"))
        browser.click("#accept")
        rest = process.stdout.read()
        assert "demo_01 led by hand, 0 cm from the suggestion" in rest
