"""One request of the teaching page, message by message."""

from __future__ import annotations

import gc
import time

import numpy as np
import pytest

from drake_screw.acquisition import Suggestion
from drake_screw.acquisition.interactive_teacher import InteractiveTeacher
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Recording, write_recording
from drake_screw.runs.run import new_run
from drake_screw.scenario.loader import load_scenario
from drake_screw.screws import (
    exp,
    quaternion_from_rotation,
    rotation_angle,
    translation_distance,
)
from drake_screw.visualization.inspector import Inspector
from drake_screw.visualization.lifetime import page_meshcat
from drake_screw.web import teaching_page
from drake_screw.web.led_arm import PERIOD, TAKEN_BACK
from drake_screw.web.teaching_session import TeachingSession

PLACE = Suggestion(6, np.array([[0.85, 0.032, 0.0]]), 2)


@pytest.fixture(scope="module")
def setup() -> Setup:
    gc.collect()  # Meshcats that other tests left behind must not end in a page's thread
    return Setup(load_scenario("pouring", ["teacher={kind: interactive}"]))


@pytest.fixture(scope="module")
def inspector(setup) -> Inspector:
    return Inspector(page_meshcat("localhost"), setup.workcells, setup.objects)


@pytest.fixture
def session(setup, inspector) -> TeachingSession:
    return TeachingSession(setup, inspector, PLACE, 0)


@pytest.fixture(scope="module")
def shown(setup, inspector) -> TeachingSession:
    """The hand was led to the bowl, turned by a radian, and lifted."""
    session = TeachingSession(setup, inspector, PLACE, 0)
    session.handle({"do": "record"})
    for part, value in ((0, 0.72), (1, 0.15), (2, 0.12)):
        session.handle({"pose": part, "value": value})
    settle(session)
    session.handle({"pose": 5, "value": -60})
    settle(session)
    session.handle({"pose": 2, "value": 0.2})
    settle(session)
    session.handle({"do": "stop"})
    return session


def settle(session: TeachingSession, most: int = 600) -> None:
    """Let the arm get where it is wanted, or as far as it can."""
    for _ in range(most):
        if not session.step():
            return


def test_sliders_cover_the_work_area_in_millimetres_and_degrees(session, setup) -> None:
    x, y, z, *turns = session.state()["pose"]
    low, high = setup.area.lower[0], setup.area.upper[0]
    for slider, a, b in ((x, low[0], high[0]), (y, low[1], high[1])):
        assert slider["low"] <= a - 0.2 + 1e-3
        assert slider["high"] >= b + 0.2 - 1e-3
        assert slider["unit"] == "m"
        assert slider["low"] * 1e3 == pytest.approx(round(slider["low"] * 1e3), abs=1e-9)
    assert z["low"] < setup.area.z[0]
    assert [(t["low"], t["high"], t["unit"]) for t in turns] == [(-180.0, 180.0, "°")] * 3
    session.handle({"pose": 1, "value": 0.032})
    session.handle({"pose": 0, "value": 0.75})
    settle(session)
    assert session.led.X_WE[:2, 3] == pytest.approx([0.75, 0.032], abs=1e-3)


def test_the_hand_goes_where_it_is_dragged(session) -> None:
    X_WG = session.led.X_WE @ exp([0.2, -0.1, 0.4, 0.06, -0.05, 0.04])
    q = quaternion_from_rotation(X_WG[:3, :3])
    session.handle({"hand": [*X_WG[:3, 3].tolist(), *(2.0 * q / 1.1).tolist()]})
    before = session.state()["joints"]
    settle(session)
    assert translation_distance(session.led.X_WE, X_WG) < 1e-3
    assert rotation_angle(session.led.X_WE, X_WG) < 1e-3
    state = session.state()
    assert state["hand"]["name"] == "left_hand"
    assert state["hand"]["is"][:3] == pytest.approx(X_WG[:3, 3], abs=1e-3)
    for a, b in zip(before, state["joints"], strict=True):
        assert abs(a["margin"] - b["margin"]) <= abs(a["value"] - b["value"]) + 1e-9
    assert [j["margin"] for j in before] != [j["margin"] for j in state["joints"]]


def test_keys_move_the_hand_along_the_world_and_turn_it_about_its_own(session) -> None:
    start = session.led.X_WE
    for _ in range(10):
        session.handle({"jog": 1, "value": -0.001})
    session.handle({"jog": 5, "value": 0.1})
    settle(session)
    wanted = start @ exp([0.0, 0.0, 0.1, 0.0, 0.0, 0.0])
    wanted[1, 3] -= 0.01
    assert translation_distance(session.led.X_WE, wanted) < 1e-3
    assert rotation_angle(session.led.X_WE, wanted) < 1e-3


def test_an_arm_that_cannot_follow_says_why_and_is_wanted_where_it_is(session) -> None:
    session.handle({"pose": 1, "value": 1.4})
    settle(session)
    assert session.state()["message"].startswith("the arm cannot follow: ")
    p = session.led.X_WE[:3, 3]
    assert p[1] < 1.3
    assert session.led.wanted[:3] == pytest.approx(p, abs=6e-3)
    session.handle({"pose": 1, "value": 0.6})
    settle(session)
    assert session.state()["message"] == ""
    assert session.led.X_WE[1, 3] == pytest.approx(0.6, abs=1e-3)


def test_the_last_seconds_are_taken_back_with_the_arm(session) -> None:
    session.handle({"do": "record"})
    session.handle({"pose": 1, "value": 0.4})
    for _ in range(150):
        session.step()
    assert session.state()["clock"] == "recording, 3.0 s"
    assert session.state()["can"] == ["back", "stop"]
    at_one = session.led._samples[50].copy()
    session.handle({"do": "back"})
    assert session.state()["clock"] == "recording, 1.0 s"
    np.testing.assert_array_equal(session.led.q, at_one)
    for _ in range(20):
        session.step()
    assert session.state()["clock"] == "recording, 1.0 s"
    session.handle({"pose": 2, "value": 0.25})
    for _ in range(50):
        session.step()
    assert session.state()["clock"] == "recording, 2.0 s"
    steps = np.abs(np.diff(session.led._samples, axis=0)).max(axis=0)
    assert (steps <= session.led.arm.velocity_limits * PERIOD).all()
    for _ in range(3):
        session.handle({"do": "back"})
    assert session.led.recorded == 0.0
    assert TAKEN_BACK == 2.0


def test_what_is_kept_is_shown_at_once(shown) -> None:
    state = shown.state()
    assert state["can"] == ["accept", "repeat"]
    (kept,) = state["kept"]
    fidelity = shown._offer.tried.demonstration.fidelity[0]
    assert kept["words"].startswith(str(fidelity))
    assert kept["color"] == "#00795a"
    assert fidelity.turn_shown == pytest.approx(np.pi / 3, abs=0.02)
    assert 'class="deviation"' in state["chart"]
    assert state["ends"] == (0.0, state["duration"])
    assert len(state["segments"]) == len(shown._offer.tried.guides)


def test_a_recording_is_trimmed_at_both_ends(shown) -> None:
    whole = shown._whole
    shown.handle({"trim": [1.0, 3.0]})
    assert shown.step()
    assert not shown.step()
    part = shown._offer.recording
    assert part.t[0] == 0.0
    assert part.duration == pytest.approx(2.0)
    np.testing.assert_array_equal(part.q[0], whole.q[50])
    np.testing.assert_array_equal(part.q[-1], whole.q[150])
    assert part.cut
    assert part.notes[-1] == f"kept 1.00 s to 3.00 s of {whole.duration:.2f} s"
    for ends, index in (([1.0, 2.9], 145), ([1.2, 2.9], 60)):
        shown.handle({"trim": ends})
        shown.step()
        np.testing.assert_array_equal(shown.q, whole.q[index])
    shown.handle({"trim": [2.0, 2.0]})
    shown.step()
    assert shown.state()["can"] == ["repeat"]
    assert "1 sample from 2.00 s to 2.00 s" in shown.state()["message"]
    shown.handle({"do": "accept"})
    assert not shown.over
    shown.handle({"trim": [-5.0, 1e6]})
    shown.step()
    assert shown._offer.recording is whole


def test_a_dropped_recording_that_was_trimmed_is_stored_trimmed(shown, session, tmp_path) -> None:
    dropped = tmp_path / "from_the_robot"
    write_recording(shown._whole, dropped)
    session.offer_folder(dropped)
    assert session.state()["message"].startswith("from_the_robot: ")
    session.handle({"trim": [0.5, 4.0]})
    session.step()
    session.handle({"do": "accept"})
    accepted = session.accepted
    assert accepted is not None
    assert accepted.source == dropped

    class Prompt:
        def ask(self, suggestion: Suggestion, number: int) -> Recording | None:
            return accepted

    teacher = InteractiveTeacher(Prompt(), session._setup.area)
    lesson = teacher.demonstrate(PLACE, number=0, used=(), rng=np.random.default_rng(0))
    assert lesson.remark == "dropped into the folder, 0 cm from the suggestion"
    run = new_run(session._setup.scenario, tmp_path / "run", teacher=lambda _: teacher)
    folder = run.directory.add_demonstration(0, accepted, lesson.remark, {})
    rows = (folder / "joint_angles.csv").read_text().splitlines()
    assert len(rows) - 1 == len(accepted.t) < len(shown._whole.t)


@pytest.mark.parametrize(
    "message",
    [
        {"pose": 0, "value": float("nan")},
        {"pose": 6, "value": 0.1},
        {"joint": 7, "value": 0.1},
        {"joint": 0, "value": float("inf")},
        {"hand": [0.7, 0.2, 0.1, 0.0, 0.0, 0.0, 0.0]},
        {"hand": [0.7, 0.2, 0.1, 1.0, 0.0, 0.0]},
        {"hand": [0.7, 0.2, float("nan"), 1.0, 0.0, 0.0, 0.0]},
        {"hand": [0.7, None, 0.1, 1.0, 0.0, 0.0, "0"]},
        {"jog": 6, "value": 0.1},
        {"jog": 0, "value": float("nan")},
        {"jog": 0, "value": 1e300},
        {"trim": [0.0, 1.0]},
        {"trim": [0.0]},
        {"do": "accept"},
        {"do": "back"},
        {"do": "_restart"},
        {"do": 3},
        {},
    ],
)
def test_nonsense_does_not_move_the_arm(session, message) -> None:
    session.handle(message)
    assert not session.step()
    assert not session.over


def test_what_is_beyond_every_range_ends_at_its_end(session) -> None:
    session.handle({"pose": 3, "value": 1e300})
    session.step()
    session.handle({"joint": 3, "value": 99.0})
    settle(session)
    assert 0.0 < session.led.arm.margin(session.led.q)[3] < 0.01


def test_a_folder_that_cannot_be_used_is_told(session, tmp_path) -> None:
    folder = tmp_path / "broken"
    folder.mkdir()
    (folder / "joint_angles.csv").write_text("time\n")
    words = session.offer_folder(folder)
    assert "broken" in words
    assert session.leading


class Clicks:
    """A server whose person records, stops after half a second, and skips."""

    def __init__(self, *_: object, **__: object) -> None:
        self.url, self.shown = "http://localhost:0", []
        self._todo = ["record", "stop", "skip"]

    def message(self, wait: float) -> dict | None:
        """The next click, once it can be made."""
        time.sleep(wait)
        last = self.shown[-1] if self.shown else {"can": [], "clock": ""}
        if (
            not self._todo
            or self._todo[0] not in last["can"]
            or "0.0" <= last["clock"][11:14] < "0.5"
        ):
            return None
        return {"do": self._todo.pop(0)}

    def show(self, state: dict) -> None:
        self.shown.append(state)

    def close(self) -> None:
        pass


def test_the_page_says_that_it_is_at_work_before_it_plans(setup, monkeypatch) -> None:
    monkeypatch.setattr(teaching_page, "PanelServer", Clicks)
    page = teaching_page.TeachingPage(setup, announce=lambda _: None)
    assert page.ask(PLACE, 0) is None
    shown = page._server.shown
    (at_work,) = [i for i, state in enumerate(shown) if "planning" in state["message"]]
    assert shown[at_work]["can"] == []
    assert "stop" in shown[at_work - 1]["can"]
    assert "stop" not in shown[at_work + 1]["can"]
    page.close()
