"""Whole runs whose demonstrations a person gives, by the real command and by clicks alone."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drake_screw.acquisition import Suggestion
from drake_screw.acquisition.simulated import SimulatedTeacher
from drake_screw.demonstrations import write_recording
from drake_screw.runs.run import open_run
from tests.browser.conftest import Browser

LEAST = 120.0
"""s. Patience with a command, which has to start, compile and evaluate."""
QUICK = [
    *("--set", "objects.0.symmetry=null"),
    *("--set", "demonstrations.first=random"),
    *("--set", "demonstrations.budget=2"),
    *("--set", "regions.grid={x: 2, y: 2}"),
]
HAND = "workcell/baxter/left_hand"


class Command:
    """``drake-screw ARGS`` going on, and what it has printed."""

    def __init__(self, process: subprocess.Popen[bytes], output: Path) -> None:
        self.process, self._output = process, output

    @property
    def text(self) -> str:
        return self._output.read_text()

    def until(self, pattern: str) -> str:
        """The first group of a pattern, once it has been printed."""

        def found() -> re.Match[str] | None:
            return re.search(pattern, self.text)

        return self._wait(found)[1]

    def ends(self) -> int:
        """The exit code."""
        return self.process.wait(LEAST)

    def _wait(self, condition: Callable[[], Any]) -> Any:
        end = time.monotonic() + LEAST
        while time.monotonic() < end:
            met = condition()
            if met:
                return met
            assert self.process.poll() is None, self.text
            time.sleep(0.05)
        raise AssertionError(f"not within {LEAST} s: {self.text}")


@contextmanager
def command(output: Path, *args: object) -> Iterator[Command]:
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONUNBUFFERED"}
    line = [sys.executable, "-m", "drake_screw.cli", *map(str, args)]
    with output.open("wb") as file:
        process = subprocess.Popen(
            line, stdout=file, stderr=subprocess.STDOUT, env=environment | {"COLUMNS": "200"}
        )
    try:
        yield Command(process, output)
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()


def lead(browser: Browser) -> list[float]:
    """Lead the arm to the bowl with buttons and sliders; returns the joint angles it ends at."""
    browser.until(lambda: browser.ask("return !document.querySelector('#record').disabled"))
    start = browser.still(lambda: browser.node(HAND)["matrix"][:3, 3].round(4).tolist())
    browser.click("#record")
    browser.until(lambda: "recording" in browser.text("#clock"))
    place = re.search(r"bowl x (\S+) m, y (\S+) m", browser.text("#headline"))
    assert place is not None
    x, y = map(float, place.groups())
    for axis, value in ((1, x - 0.1), (2, y), (3, 0.12)):
        browser.slide(f"#pose tr:nth-child({axis}) input", value)
    browser.until(
        lambda: np.linalg.norm(browser.node(HAND)["matrix"][:3, 3] - np.array(start)) > 0.25
    )
    angles = browser.still(lambda: browser.ask(
        "return [...document.querySelectorAll('#arm td:nth-child(3)')].map((c) => c.textContent)"
    ))  # fmt: skip
    browser.click("#stop")
    browser.until(lambda: "found; planned" in browser.text("#message"))
    browser.until(lambda: browser.node("attempts"))
    browser.click("#accept")
    return [float(angle) for angle in angles]


def wanted(browser: Browser, number: int) -> None:
    browser.until(lambda: f"demonstration {number} is wanted" in browser.text("#headline"))


def record(run: Path) -> dict[str, Any]:
    return json.loads((run / "run.json").read_text())


@pytest.mark.slow
def test_a_run_goes_on_with_what_is_given_by_clicks_alone(browser, tmp_path) -> None:
    run = tmp_path / "run"
    with command(
        tmp_path / "out", "run", "pouring", *QUICK, "--set", "teacher={kind: interactive}",
        "--output", run,
    ) as going:  # fmt: skip
        url = going.until(r"give demonstrations at (http://\S+)")
        assert going.until(r"waiting for demonstration 1: open (\S+)") == url
        browser.open(url)
        wanted(browser, 1)
        first = lead(browser)
        wanted(browser, 2)
        assert record(run)["rounds"][0]["demonstrations"] == 1
        assert going.until(r"(waiting for demonstration 2)")
        lead(browser)
        browser.until(lambda: "the run has ended" in browser.text("#headline"))
        assert going.ends() == (0 if record(run)["status"] == "certified" else 1)
        assert "\x1b" not in going.text
        browser.until(lambda: browser.ask("return document.body.classList.contains('gone')"))
    told = record(run)
    assert told["status"] in ("certified", "insufficient")
    assert [r["demonstrations"] for r in told["rounds"]] == [1, 2]
    assert [d["name"] for d in told["demonstrations"]] == ["demo_01", "demo_02"]
    assert all("led by hand, 0 cm" in d["remark"] for d in told["demonstrations"])
    reader = open_run(run).reader
    stored = reader.recording(0)
    assert np.allclose(stored.q[-1], first, atol=2e-3)
    assert np.abs(stored.q[-1] - stored.q[0]).max() > 0.1
    assert len(reader.event(1).demonstrations) == 2
    again = subprocess.run(
        [sys.executable, "-m", "drake_screw.cli", "report", run],
        capture_output=True, text=True, timeout=LEAST, check=True,
    )  # fmt: skip
    assert "with 2 demonstrations" in " ".join(again.stdout.split())
    assert "waiting" not in again.stdout


@pytest.mark.slow
def test_a_run_left_while_it_waits_is_carried_on_with_a_dropped_folder(browser, tmp_path) -> None:
    run, inbox = tmp_path / "run", tmp_path / "inbox"
    with command(
        tmp_path / "out", "run", "pouring", *QUICK, "--meshcat", "--output", run,
        "--set", f"teacher={{kind: interactive, folder: {inbox}}}",
    ) as going:  # fmt: skip
        watch = going.until(r"watch the run at (http://\S+)")
        teach = going.until(r"give demonstrations at (http://\S+)")
        going.until(rf"(waiting for demonstration 1: .*{re.escape(str(inbox))})")
        browser.open(watch)
        browser.until(lambda: "demonstration 1 wanted" in browser.text("#headline"))
        assert browser.ask("return document.querySelector('#teach a').href") == teach
        browser.open(teach)
        wanted(browser, 1)
        lead(browser)
        wanted(browser, 2)
        going.process.send_signal(signal.SIGINT)
        assert going.ends() == 130
        assert f"--resume {run}" in going.text
        assert "Traceback" not in going.text
    left = record(run)
    assert left["status"] == "interrupted"
    assert (len(left["demonstrations"]), len(left["rounds"])) == (1, 1)

    with command(tmp_path / "more", "run", "--resume", run) as going:
        url = going.until(r"waiting for demonstration 2: open (\S+)")
        browser.open(url)
        wanted(browser, 2)
        half = inbox / "half"
        half.mkdir()
        (half / "joint_angles.csv").write_text("time\n")
        assert going.until(r"(half/joint_angles\.csv:1: no column)")
        browser.until(lambda: "no column" in browser.text("#message"))
        source = drop(run, tmp_path, inbox)
        going.until(r"(from_the_robot: \d+ guiding poses? found)")
        browser.until(lambda: "from_the_robot" in browser.text("#message"))
        browser.until(lambda: browser.node("attempts"))
        browser.click("#accept")
        assert going.ends() in (0, 1)
    told = record(run)
    assert told["rounds"][0] == left["rounds"][0]
    assert told["demonstrations"][0] == left["demonstrations"][0]
    assert told["demonstrations"][1]["name"] == "from_the_robot"
    assert "dropped into the folder" in told["demonstrations"][1]["remark"]
    assert told["rounds"][1]["demonstrations"] == 2
    stored = run / told["demonstrations"][1]["folder"]
    for file in ("joint_angles.csv", "object_poses.csv"):
        assert (stored / file).read_bytes() == (source / file).read_bytes()


def drop(run: Path, aside: Path, inbox: Path) -> Path:
    """Let the simulated teacher show the wanted demonstration, and move it into the inbox."""
    setup = open_run(run).setup
    suggestion = open_run(run).reader.event(0).suggestion
    assert suggestion is not None
    teacher = SimulatedTeacher(setup.workcell, setup.area, "pouring")
    place = Suggestion(suggestion.region, suggestion.coordinates)
    lesson = teacher.demonstrate(place, number=1, used=(), rng=np.random.default_rng(0))
    assert lesson.recording is not None, lesson.remark
    folder = aside / "from_the_robot"
    write_recording(lesson.recording, folder, setup.scenario.robot.parked)
    return Path(shutil.move(folder, inbox / folder.name))


@pytest.mark.slow
@pytest.mark.parametrize("initial", [0, 1])
def test_a_person_may_have_no_demonstration(browser, tmp_path, initial) -> None:
    run = tmp_path / "run"
    with command(
        tmp_path / "out", "run", "pouring", *QUICK, "--set", "teacher={kind: interactive}",
        "--set", f"demonstrations.initial={initial}", "--output", run,
    ) as going:  # fmt: skip
        browser.open(going.until(r"waiting for demonstration 1: open (\S+)"))
        for _ in range(1 if initial else 3):
            wanted(browser, 1)
            before = browser.text("#headline")
            browser.click("#skip")
            browser.until(lambda b=before: browser.text("#headline") != b)
        assert going.ends() == 1
        assert going.text.count("waiting for") == (1 if initial else 3)
    told = record(run)
    assert told["status"] == "insufficient"
    assert "the teacher has no demonstration for this place" in told["reason"]
    assert len(told["rounds"]) == 1 - initial
