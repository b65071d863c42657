"""Where a person gives demonstrations: lead the arm in the browser, record, look, accept."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from drake_screw.acquisition import Event, Finished, RoundFinished, RoundStarted, Suggestion
from drake_screw.acquisition.interactive_teacher import InteractiveTeacher
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Recording
from drake_screw.runs.narration import describe
from drake_screw.runs.pictures import make_scene
from drake_screw.visualization.drawing import AXES
from drake_screw.visualization.inspector import Inspector
from drake_screw.visualization.lifetime import page_meshcat
from drake_screw.visualization.look_scene import clear_path
from drake_screw.visualization.meshcat_page import render
from drake_screw.visualization.palette import ACCENT, INK
from drake_screw.web.inbox import Inbox
from drake_screw.web.inspector_panel import PLAN_KEY
from drake_screw.web.led_arm import PERIOD, TAKEN_BACK
from drake_screw.web.offer import as_state
from drake_screw.web.server import PanelServer
from drake_screw.web.teaching_session import TeachingSession

UPDATE_PERIOD = 0.06
"""s. Between states of the panel while the arm moves."""


AT_WORK = {
    "message": "cutting it into screws and planning; the first time this may take a minute",
    "can": [],
}
"""What the panel says before a recording is planned; the arm's planner may have to be compiled."""


def _print(text: str) -> None:
    print(text, flush=True)


class TeachingPage:
    """Asks for demonstrations in the browser, for an `InteractiveTeacher`.

    It is a listener of the run, too. The page opens with the first request, unless it is opened
    before. The person leads the arm by a handle on the hand, by keys, or by sliders of the end
    effector's pose (differential inverse kinematics keeps the joints within their limits) or of the
    joints, and records; the last seconds can be taken back. The recording is cut into screws and
    planned at once, to be trimmed, accepted or repeated. Or they drop a recording's folder into the
    watched folder.

    Args:
        setup: of the run.
        inbox: the watched folder; none if None. What lies there already is not taken, unless it
            changes.
        host: "localhost", or an address to listen on.
        port: of the page; any free one if None.
        announce: called whenever a person is waited for, with the page's address.

    Attributes:
        url: of the page once it is open.
    """

    def __init__(
        self,
        setup: Setup,
        *,
        inbox: Path | None = None,
        host: str = "localhost",
        port: int | None = None,
        announce: Callable[[str], None] = _print,
    ) -> None:
        self._setup = setup
        self._inbox = None if inbox is None else Inbox(inbox)
        self._host, self._port, self._announce = host, port, announce
        self.url = ""
        self._server: PanelServer | None = None

    def open(self) -> str:
        """Serve the page, if it is not served yet; returns its URL.

        Raises:
            DrakeScrewError: it cannot be served.
            RecordingError: the watched folder cannot be made.
            RunDirectoryError: another process watches it.
        """
        if self._server is not None:
            return self.url
        if self._inbox is not None:
            self._inbox.open()
        setup, meshcat = self._setup, page_meshcat(self._host)
        self._scene = make_scene(setup, meshcat)
        self._inspector = Inspector(meshcat, setup.workcells, setup.objects)
        key = ((ACCENT, "demonstrate here"), (INK, "the hand's path as recorded"), *PLAN_KEY)
        look: dict[str, Any] = {"accent": ACCENT, "axes": AXES, "back": f"{TAKEN_BACK:g}"}
        panel = render("drake_screw.web", "teaching.html.j2", key=key, **look)
        self._title = f"{setup.scenario.name}: teach"
        self._server = PanelServer(
            meshcat.port(), panel, self._title, host=self._host, port=self._port
        )
        self.url = self._server.url
        self._show_idle("the run is starting")
        return self.url

    def ask(self, suggestion: Suggestion, number: int) -> Recording | None:
        """Ask for a demonstration; returns when the person has decided.

        Args:
            suggestion: where it is wanted.
            number: of the demonstration, from 0.

        Returns:
            The accepted recording; None if there will be none.
        """
        self.open()
        assert self._server is not None
        self._announce_request(number)
        while self._server.message(0.0) is not None:
            pass
        session = TeachingSession(self._setup, self._inspector, suggestion, number)
        self._scene.show_suggestion(suggestion.coordinates)
        updated, changed, due = 0.0, True, time.monotonic()
        while not session.over:
            while (message := self._server.message(max(0.0, due - time.monotonic()))) is not None:
                if session.is_to_plan(message):
                    self._server.show(session.state() | AT_WORK)
                session.handle(message)
                changed = True
            due = max(due, time.monotonic() - PERIOD) + PERIOD
            changed |= session.step()
            if session.leading and not session.recording:
                changed |= self._take_dropped(session)
            now = time.monotonic()
            if changed and now - updated > UPDATE_PERIOD:
                updated, changed = now, session.recording
                self._inspector.pose(session.led.arm, session.q)
                self._server.show(session.state())
        self._inspector.clear()
        clear_path(self._inspector.meshcat)
        self._scene.clear_suggestion()
        self._inspector.pose(session.led.arm, session.start)
        given = session.accepted is not None
        self._show_idle("thank you; the run goes on" if given else "no demonstration there")
        return session.accepted

    def __call__(self, event: Event) -> None:
        """Say on the page how the run goes on between two requests."""
        if self._server is not None and isinstance(event, RoundStarted | RoundFinished | Finished):
            over = isinstance(event, Finished)
            words = describe(event, self._setup.regions)
            self._show_idle(f"the run has ended, {words}" if over else words)

    def close(self) -> None:
        """Stop serving the page."""
        if self._server is not None:
            self._server.close()
        if self._inbox is not None:
            self._inbox.close()

    def _show_idle(self, headline: str) -> None:
        """Show that nobody is asked for anything just now."""
        assert self._server is not None
        self._inspector.meshcat.Flush()
        state: dict[str, Any] = {"title": self._title, "headline": headline, "leading": False}
        state |= {"message": "", "clock": "", "hint": "", "can": []}
        state |= {"pose": [], "joints": [], "hand": None, "ends": (0.0, 0.0)}
        state |= as_state(None, None)
        self._server.show(state)

    def _announce_request(self, number: int) -> None:
        folder = ""
        if self._inbox is not None:
            folder = f", or drop a recording's folder into {self._inbox.folder}"
        self._announce(
            f"waiting for demonstration {number + 1}: open {self.url} in a browser{folder}"
        )

    def _take_dropped(self, session: TeachingSession) -> bool:
        """Offer what was dropped into the watched folder; returns whether anything was."""
        folder = None if self._inbox is None else self._inbox.take()
        if folder is None:
            return False
        assert self._server is not None
        self._server.show(session.state() | AT_WORK)
        words = session.offer_folder(folder)
        todo = "correct it, or drop another" if session.leading else "accept or repeat it"
        self._announce(f"{words}\n{todo}: {self.url}")
        return True


def interactive_teacher(setup: Setup) -> InteractiveTeacher:
    """A teacher who asks on a page on localhost, to be passed to a `Setup` or a run.

    >>> from drake_screw import Setup, load_scenario
    >>> scenario = load_scenario("pouring", ["teacher={kind: interactive}"])
    >>> type(Setup(scenario, teacher=interactive_teacher).teacher).__name__
    'InteractiveTeacher'
    """
    page = TeachingPage(setup, inbox=setup.scenario.teacher.folder)
    return InteractiveTeacher(page, setup.area)
