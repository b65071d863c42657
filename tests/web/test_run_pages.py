"""Where the pages of a run are served, and what is said of it."""

from __future__ import annotations

import gc
import socket
import urllib.request
from collections.abc import Iterator
from contextlib import suppress
from typing import Any
from urllib.parse import urlsplit

import pytest

from drake_screw.acquisition import Finished, Status
from drake_screw.assembly.setup import Setup
from drake_screw.errors import DrakeScrewError, RecordingError
from drake_screw.scenario.loader import dump_scenario, load_scenario
from drake_screw.web.run_pages import RunPages
from drake_screw.web.server import check_address

INTERACTIVE = "teacher={kind: interactive}"


def open_pages(changes: list[str], said: list[str], **options: Any) -> RunPages:
    scenario = load_scenario("pouring", changes)
    pages = RunPages(scenario, announce=said.append, **options)
    pages.open(Setup(scenario, **pages.parts))
    return pages


@pytest.fixture
def said() -> list[str]:
    return []


@pytest.fixture
def opened() -> Iterator[list[RunPages]]:
    gc.collect()  # Meshcats that other tests left behind must not end in a page's thread
    pages: list[RunPages] = []
    yield pages
    for page in pages:
        page.__exit__()


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


def test_a_run_has_no_page_unless_it_asks_for_one(said) -> None:
    pages = open_pages([], said)
    assert (pages.live, pages.teaching) == (None, None)
    assert not said


@pytest.mark.parametrize(("change", "option"), [("meshcat=true", False), ("meshcat=false", True)])
def test_the_key_or_the_option_shows_the_run(said, opened, change, option) -> None:
    opened.append(open_pages([change], said, watched=option))
    (pages,) = opened
    assert pages.live is not None
    assert said == [f"watch the run at {pages.live.url}"]
    assert urlsplit(pages.live.url).hostname == "localhost"
    assert "pouring" in read(pages.live.url)


def test_a_teacher_has_a_page_beside_it(said, opened) -> None:
    port = free_pair()
    opened.append(open_pages([INTERACTIVE, "meshcat=true"], said, port=port))
    (pages,) = opened
    assert pages.live is not None
    assert pages.teaching is not None
    assert urlsplit(pages.live.url).port == port
    assert urlsplit(pages.teaching.url).port == port + 1
    assert f"watch the run at {pages.live.url}" in said
    assert f"give demonstrations at {pages.teaching.url}" in said
    assert "the run is starting" in read(pages.teaching.url + "state?after=0")


def test_everyone_is_warned_of_an_open_page(said, opened) -> None:
    opened.append(open_pages(["meshcat=true"], said, host="0.0.0.0"))
    assert said[0].startswith("warning: served on 0.0.0.0 to everyone")


def test_ports_are_checked_before_a_run_begins(taken) -> None:
    scenario = load_scenario("pouring")
    with pytest.raises(DrakeScrewError, match=f"cannot serve on localhost, port {taken}"):
        RunPages(scenario, watched=True, port=taken)
    interactive = load_scenario("pouring", [INTERACTIVE])
    with pytest.raises(DrakeScrewError, match="cannot serve"):
        RunPages(interactive, watched=True, port=taken - 1)
    with pytest.raises(DrakeScrewError, match="this run has none"):
        RunPages(scenario, port=taken)
    RunPages(scenario)
    RunPages(interactive)


def test_a_page_gets_the_port_that_meshcat_would_take_next(said, opened) -> None:
    """Meshcat by itself takes the first free port from 7000 on, as those of other tests may."""
    for port in range(7000, 7100):
        with suppress(DrakeScrewError):
            check_address("localhost", port)
            opened.append(open_pages(["meshcat=true"], said, port=port))
            break
    assert "<title>pouring</title>" in read(f"http://localhost:{port}/")


def test_a_folder_that_cannot_be_watched(tmp_path) -> None:
    (tmp_path / "file").write_text("in the way")
    teacher = f"teacher={{kind: interactive, folder: {tmp_path / 'file'}}}"
    with pytest.raises(RecordingError, match="file: cannot be watched"):
        open_pages([teacher], [])


def test_a_run_that_has_finished_says_where_its_page_is_kept(said, opened, tmp_path) -> None:
    scenario = load_scenario("pouring", ["meshcat=true"])
    opened.append(RunPages(scenario, announce=said.append))
    (pages,) = opened
    pages.open(Setup(scenario), tmp_path)
    assert pages.live is not None
    state = pages.live.url + "state?after=0"
    assert '"finished": ""' in read(state)
    pages.live(Finished(Status.INSUFFICIENT, "the budget is used up", None, ()))
    assert f"is kept in {tmp_path / 'meshcat.html'}" in read(state)
