"""Where the pages of a run are served, and what is said of it."""

from __future__ import annotations

import gc
import socket
import urllib.request
from collections.abc import Iterator
from contextlib import suppress
from urllib.parse import urlsplit

import numpy as np
import pytest
from rich.console import Console

from drake_screw.acquisition import Suggestion
from drake_screw.errors import DrakeScrewError, RecordingError
from drake_screw.scenario.assemble import Setup
from drake_screw.scenario.lesson import DeskLesson
from drake_screw.scenario.loader import dump_scenario, load_scenario
from drake_screw.scenario.pages import Pages, check_pages, open_pages
from drake_screw.visualization.panel_server import check_address

INTERACTIVE = "teacher={kind: interactive}"


@pytest.fixture
def console() -> Console:
    return Console(width=300, record=True, file=open("/dev/null", "w"))


@pytest.fixture
def opened(console) -> Iterator[list[Pages]]:
    gc.collect()  # Meshcats that other tests left behind must not end in a page's thread
    pages: list[Pages] = []
    yield pages
    for page in pages:
        page.close()


@pytest.fixture
def taken() -> Iterator[int]:
    """A port that something listens on."""
    with socket.create_server(("localhost", 0)) as listener:
        yield listener.getsockname()[1]


def free_pair() -> int:
    """A free port with a free one after it."""
    while True:
        with socket.create_server(("localhost", 0)) as first:
            port = first.getsockname()[1]
            try:
                with socket.create_server(("localhost", port + 1)):
                    return port
            except OSError:
                continue


def read(url: str) -> str:
    with urllib.request.urlopen(url, timeout=20) as answer:
        return answer.read().decode()


def test_the_key_is_off_unless_it_is_set(tmp_path) -> None:
    assert not load_scenario("pouring").meshcat
    shown = load_scenario("scooping", ["meshcat=true"])
    file = tmp_path / "again.yaml"
    file.write_text(dump_scenario(shown))
    assert load_scenario(file).meshcat


def test_a_run_has_no_page_unless_it_asks_for_one(console) -> None:
    pages = open_pages(Setup(load_scenario("pouring")), console)
    assert (pages.view, pages.desk) == (None, None)
    assert console.export_text() == ""


@pytest.mark.parametrize(("change", "option"), [("meshcat=true", False), ("meshcat=false", True)])
def test_the_key_or_the_option_shows_the_run(console, opened, change, option) -> None:
    opened.append(open_pages(Setup(load_scenario("pouring", [change])), console, meshcat=option))
    (pages,) = opened
    assert pages.view is not None
    assert console.export_text() == f"watch the run at {pages.view.url}\n"
    assert urlsplit(pages.view.url).hostname == "localhost"
    assert "pouring" in read(pages.view.url)


def test_a_teacher_has_a_page_beside_it(console, opened) -> None:
    port = free_pair()
    setup = Setup(load_scenario("pouring", [INTERACTIVE, "meshcat=true"]))
    opened.append(open_pages(setup, console, port=port))
    (pages,) = opened
    assert pages.view is not None
    assert pages.desk is not None
    assert urlsplit(pages.view.url).port == port
    assert urlsplit(pages.desk.url).port == port + 1
    text = console.export_text()
    assert f"watch the run at {pages.view.url}\n" in text
    assert f"give demonstrations at {pages.desk.url}\n" in text
    assert "the run is starting" in read(pages.desk.url + "state?after=0")


def test_everyone_is_warned_of_an_open_page(console, opened) -> None:
    setup = Setup(load_scenario("pouring", ["meshcat=true"]))
    opened.append(open_pages(setup, console, host="0.0.0.0"))
    assert "warning: served on 0.0.0.0 to everyone" in console.export_text()


def test_ports_are_checked_before_a_run_begins(taken) -> None:
    scenario = load_scenario("pouring")
    with pytest.raises(DrakeScrewError, match=f"cannot serve on localhost, port {taken}"):
        check_pages(scenario, True, "localhost", taken)
    interactive = load_scenario("pouring", [INTERACTIVE])
    with pytest.raises(DrakeScrewError, match="cannot serve"):
        check_pages(interactive, True, "localhost", taken - 1)
    with pytest.raises(DrakeScrewError, match="this run has none"):
        check_pages(scenario, False, "localhost", taken)
    check_pages(scenario, False, "localhost", None)
    check_pages(interactive, False, "localhost", None)


def test_a_page_gets_the_port_that_meshcat_would_take_next(console, opened) -> None:
    """Meshcat by itself takes the first free port from 7000 on."""
    for port in range(7000, 7100):
        with suppress(DrakeScrewError):
            check_address("localhost", port)
            break
    setup = Setup(load_scenario("pouring", ["meshcat=true"]))
    opened.append(open_pages(setup, console, port=port))
    assert "<title>pouring</title>" in read(f"http://localhost:{port}/")


def test_a_folder_that_cannot_be_watched(tmp_path) -> None:
    (tmp_path / "file").write_text("in the way")
    teacher = f"teacher={{kind: interactive, folder: {tmp_path / 'file'}}}"
    setup = Setup(load_scenario("pouring", [teacher]))
    with pytest.raises(RecordingError, match="file: cannot be watched"):
        open_pages(setup, Console(quiet=True))


def test_nonsense_does_not_move_the_arm(console, opened) -> None:
    setup = Setup(load_scenario("pouring", [INTERACTIVE]))
    opened.append(open_pages(setup, console))
    desk = opened[0].desk
    assert desk is not None
    place = Suggestion(6, np.array([[0.85, 0.45, 0.0]]), 2)
    lesson = DeskLesson(setup, desk._inspector, place, 0)
    for message in (
        {"hand": 0, "value": float("nan")},
        {"hand": 6, "value": 0.1},
        {"joint": 7, "value": 0.1},
        {"joint": 0, "value": float("inf")},
        {"hand": 3, "value": float("nan")},
        {"do": "accept"},
        {"do": "_restart"},
        {"do": 3},
        {},
    ):
        lesson.hear(message)
        assert not lesson.step(), message
    assert not lesson.over
    lesson.hear({"hand": 3, "value": 1e300})
    lesson.step()
    lesson.hear({"joint": 3, "value": 99.0})
    while lesson.step():
        pass
    arm = setup.workcell.arm
    assert 0.0 < arm.margin(lesson.guided.q)[3] < 0.01
