"""The page of executions, as it is played."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drake_screw.assembly.setup import Setup
from drake_screw.execution import Contact
from drake_screw.execution.parallel import Job, StationConfig, execute_all
from drake_screw.execution.playback import PAUSE
from drake_screw.execution.trials import Trial
from drake_screw.runs.executions_page import executions_page
from drake_screw.scenario.loader import load_scenario
from tests.execution.conftest import arm, guides, plan, robot

__all__ = ["arm", "guides", "plan", "robot"]

PLACE = np.array([[0.9, 0.6, 0.0]])


@pytest.fixture(scope="module")
def trials(robot, plan) -> list[Trial]:
    setup = Setup(load_scenario("pouring"))
    config = StationConfig(robot, None, setup.objects)
    (good,) = execute_all(config, [Job(plan, setup.area.X_WO(PLACE))], workers=1)
    touching = replace(good.report, contacts=(Contact(("left_hand", "bowl"), 1.0, 1, 40.0),))
    return [
        Trial(3, PLACE, "demo_01", "", replace(good, report=touching)),
        Trial(9, PLACE - [[0.1, 0.0, 0.0]], "demo_02", "", good),
        Trial(5, PLACE, "", "left_w1 meets its limit in segment 2", None),
    ]


def test_executions_are_listed_and_played(browser, trials, tmp_path) -> None:
    page = tmp_path / "executions.html"
    text = executions_page(Setup(load_scenario("pouring")), trials)
    assert text is not None
    page.write_text(text, encoding="utf-8")
    browser.open(page.as_uri())
    browser.until(lambda: browser.text("#clock").startswith(("1 of 2", "2 of 2")))
    assert browser.driver.title == "pouring: executions"
    entries = [f"#executions li:nth-child({i})" for i in (1, 2)]
    assert "bowl at x 0.900 m, y 0.600 m (region 3)" in browser.text(entries[0])
    assert "left_hand touches the bowl" in browser.text(entries[0]) or (
        "left_hand touches bowl" in browser.text(entries[0])
    )
    assert "(region 9), with demo_02: as planned" in browser.text(entries[1])
    browser.click("#play")
    browser.until(lambda: browser.text("#play") == "play")
    browser.slide("#time", 0.2)
    browser.until(lambda: browser.text("#clock").startswith("1 of 2, 0.2 of "))
    browser.click(f"{entries[1]} button")
    browser.until(lambda: browser.text("#clock").startswith("2 of 2, "))
    length = trials[0].execution.t[-1]
    browser.slide("#time", length + PAUSE + 0.5)
    browser.until(lambda: browser.text("#clock") == f"2 of 2, 0.5 of {length:.1f} s")
    bowl = browser.node("station/bowl/bowl")["matrix"]
    assert bowl[0, 3] == pytest.approx(0.8, abs=1e-6)
    heights = browser.ask(
        """
        const found = [];
        let node = viewer.scene_tree;
        for (const part of ["station", "bowl", "bowl"]) node = node.children[part];
        node.object.traverse((o) => {
          if (o.geometry) found.push(o.geometry.attributes.position.count);
        });
        return found;
        """
    )
    assert max(heights) > 1000  # a cylinder has fewer points
    with browser.screen_of(390, 844):
        assert browser.fits()
    assert browser.complaints() == []


def test_without_an_execution_there_is_no_page(trials) -> None:
    assert executions_page(Setup(load_scenario("pouring")), trials[2:]) is None
