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


KEPT = "What is shown here is kept in "


@pytest.fixture(scope="module")
def run(finished_run):
    return open_run(finished_run)


def upright(browser, number: int) -> float:
    """How far a numeral's top is from straight up in the picture; rad."""
    X = browser.node(f"demonstrations/{number:02d}/place/number")["matrix"]
    X = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]) @ X
    foot, top = (browser.pixel(X[:3, 3] + s * X[:3, 1]) for s in (-0.1, 0.1))
    across, up = top[0] - foot[0], foot[1] - top[1]
    return abs(float(np.arctan2(across, up)))


def robot_is_in_view(browser) -> bool:
    """Whether every point of the robot is within the 3-D view."""
    return browser.ask(
        """
        const robot = viewer.scene_tree.children.workcell.children.baxter.object;
        viewer.camera.updateWorldMatrix(true, false);
        robot.updateWorldMatrix(true, true);
        let seen = true, count = 0;
        robot.traverse((o) => {
          if (!o.geometry) return;
          const p = o.geometry.attributes.position;
          for (let i = 0; i < p.count; i += 7, ++count) {
            const v = new MeshCat.THREE.Vector3(p.getX(i), p.getY(i), p.getZ(i));
            v.applyMatrix4(o.matrixWorld).project(viewer.camera);
            seen = seen && Math.abs(v.x) < 1 && Math.abs(v.y) < 1 && v.z < 1;
          }
        });
        return seen && count > 100;
        """
    )


def test_a_run_is_told_as_it_happens(browser, run) -> None:
    kept = run.directory.path / "meshcat.html"
    view = LivePage(run.setup, kept=kept)
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
        said = f"The run has finished; this page does not change any more. {KEPT}{kept}"
        assert browser.text("#finished") == said
        assert robot_is_in_view(browser)
        browser.until(lambda: max(upright(browser, n) for n in (1, 2)) < 0.06)
        browser.ask(
            "viewer.set_property(['Cameras', 'default', 'rotated', '<object>'], 'position',"
            "[0.3, 1.2, 1.6]); viewer.set_dirty()"
        )
        browser.until(lambda: max(upright(browser, n) for n in (1, 2)) < 0.06)
        for width, height in ((390, 844), (1024, 768)):
            with browser.screen_of(width, height):
                assert browser.fits()
        assert browser.complaints() == []
    finally:
        view.close()
    browser.until(lambda: browser.ask("return document.body.classList.contains('gone')"))
    before = "return getComputedStyle(document.querySelector('#panel'), '::before').content"
    assert browser.ask(before) == "none"


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
