"""Recordings dropped into a folder, by a clock that the tests turn."""

from __future__ import annotations

from pathlib import Path

import pytest

from drake_screw.demonstrations.library import JOINTS, OBJECTS
from drake_screw.web import inbox as module
from drake_screw.web.inbox import PATIENCE, PERIOD, Inbox


class Clock:
    now = 1000.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    return clock


def take(inbox: Inbox, clock: Clock, seconds: float = 1.1 * PERIOD) -> Path | None:
    clock.now += seconds
    return inbox.take()


def drop(folder: Path, *names: str, text: str = "time\n") -> Path:
    folder.mkdir(exist_ok=True)
    for name in names:
        (folder / name).write_text(text)
    return folder


def test_a_recording_is_taken_once_and_again_when_it_changes(tmp_path, clock) -> None:
    inbox = Inbox(tmp_path)
    assert take(inbox, clock) is None
    demo = drop(tmp_path / "demo", JOINTS, OBJECTS)
    assert take(inbox, clock) is None
    assert take(inbox, clock, 0.5 * PERIOD) is None
    assert take(inbox, clock) == demo
    assert take(inbox, clock, 10 * PATIENCE) is None
    drop(demo, JOINTS, text="time,left_s0\n")
    assert take(inbox, clock) is None
    assert take(inbox, clock) == demo


def test_a_recording_that_grows_is_waited_for(tmp_path, clock) -> None:
    inbox = Inbox(tmp_path)
    for length in range(1, 5):
        drop(tmp_path / "demo", JOINTS, OBJECTS, text="0" * length)
        assert take(inbox, clock) is None
    assert take(inbox, clock) == tmp_path / "demo"


def test_a_missing_file_is_waited_for_longer(tmp_path, clock) -> None:
    inbox = Inbox(tmp_path)
    half = drop(tmp_path / "half", JOINTS)
    assert take(inbox, clock) is None
    assert take(inbox, clock, 0.9 * PATIENCE) is None
    assert take(inbox, clock) == half


def test_what_lay_there_before_is_not_taken(tmp_path, clock) -> None:
    drop(tmp_path / "old", JOINTS, OBJECTS)
    (tmp_path / "notes.txt").write_text("not a recording")
    inbox = Inbox(tmp_path)
    assert take(inbox, clock) is None
    assert take(inbox, clock, 10 * PATIENCE) is None


def test_a_folder_may_come_into_being_later(tmp_path, clock) -> None:
    inbox = Inbox(tmp_path / "deep" / "inbox")
    assert take(inbox, clock) is None
    inbox.open()
    demo = drop(inbox.folder / "demo", JOINTS, OBJECTS)
    assert take(inbox, clock) is None
    assert take(inbox, clock) == demo
