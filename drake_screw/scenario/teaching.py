"""The desk of an interactive teacher: lead the arm in the browser, record, look, accept."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from drake_screw.acquisition import Event, Finished, RoundFinished, RoundStarted, Suggestion
from drake_screw.acquisition.interactive_teacher import InteractiveTeacher
from drake_screw.demonstrations import Recording
from drake_screw.demonstrations.library import JOINTS, OBJECTS
from drake_screw.errors import RecordingError
from drake_screw.scenario.assemble import Setup
from drake_screw.scenario.lesson import PERIOD, DeskLesson
from drake_screw.scenario.narration import describe
from drake_screw.typing import Array
from drake_screw.visualization import Scene
from drake_screw.visualization.inspector import Inspector
from drake_screw.visualization.inspector_panel import KEY, body, script_json
from drake_screw.visualization.lifetime import page_meshcat
from drake_screw.visualization.palette import ACCENT
from drake_screw.visualization.panel_server import PanelServer

SAY = 0.1
"""s. Between states of the panel while the arm moves."""
LOOK = 1.0
"""s. Between looks into the watched folder; a file that changed since then is still growing."""


def _print(text: str) -> None:
    print(text, flush=True)


_Files = tuple[tuple[str, int, int], ...]
"""Name, size in bytes and time of change in ns of each file of a recording."""


class TeachingDesk:
    """Asks for demonstrations in the browser; the `DemonstrationPrompt` of an `InteractiveTeacher`.

    The page opens with the first request, unless it is opened before. The person leads the arm by
    sliders of the hand's pose (differential inverse kinematics keeps the joints within their
    limits) or of the joints, and records; the recording is cut into screws and planned at once, to
    be accepted or repeated. Or they drop a recording's folder into the watched folder.

    Args:
        setup: of the run.
        inbox: the watched folder; none if None. What lies there already is not taken, unless it
            changes.

    Attributes:
        host, port: of the page, as in `PanelServer`.
        announce: told whenever a person is waited for, and where.
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
        self._setup, self._inbox = setup, inbox
        self.host, self.port, self.announce = host, port, announce
        self.url = ""
        self._seen = dict(self._dropped())
        self._since: dict[Path, tuple[_Files, float]] = {}
        self._server: PanelServer | None = None

    def open(self) -> str:
        """Serve the page, if it is not served yet; returns its URL.

        Raises:
            DrakeScrewError: it cannot be served.
            RecordingError: the watched folder cannot be made.
        """
        if self._server is not None:
            return self.url
        if self._inbox is not None:
            try:
                self._inbox.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise RecordingError(
                    f"cannot be watched: {error.strerror}",
                    remedy="Give another teacher.folder, one that can be made.",
                    file=self._inbox,
                ) from error
        setup = self._setup
        meshcat = page_meshcat(self.host)
        name = setup.scenario.name
        self._scene = Scene(
            meshcat, setup.robot, setup.table, setup.objects, setup.area, scenario=name
        )
        self._inspector = Inspector(meshcat, setup.workcell, setup.objects)
        key = ((ACCENT, "demonstrate here"), *KEY)
        panel = body("teach.html", f"const KEY = {script_json(key)};", ("panel.js", "teach.js"))
        title = f"{name}: teach"
        self._server = PanelServer(meshcat.port(), panel, title, host=self.host, port=self.port)
        self.url = self._server.url
        self._idle("the run is starting")
        return self.url

    def ask(self, suggestion: Suggestion, number: int) -> Recording | None:
        """See `DemonstrationPrompt.ask`; returns when the person has decided."""
        self.open()
        assert self._server is not None
        self._invite(number)
        while self._server.message(0.0) is not None:
            pass
        lesson = DeskLesson(self._setup, self._inspector, suggestion, number)
        self._scene.show_suggestion(suggestion.x_y_yaw)
        said, looked, moved = 0.0, 0.0, True
        while not lesson.over:
            message = self._server.message(PERIOD)
            while message is not None:
                lesson.hear(message)
                moved = True
                message = self._server.message(0.0)
            moved |= lesson.step()
            now = time.monotonic()
            if now - looked > LOOK and lesson.leading and not lesson.recording_now:
                looked = now
                moved |= self._look(lesson)
            if moved and now - said > SAY:
                said, moved = now, lesson.recording_now
                self._pose(lesson.guided.q)
                self._server.show(lesson.state())
        self._inspector.clear()
        self._scene.clear_suggestion()
        self._pose(self._setup.workcell.start)
        given = lesson.accepted is not None
        self._idle("thank you; the run goes on" if given else "no demonstration there")
        return lesson.accepted

    def hear(self, event: Event) -> None:
        """Say on the page how the run goes on between two requests."""
        if self._server is not None and isinstance(event, RoundStarted | RoundFinished | Finished):
            over = isinstance(event, Finished)
            words = describe(event, self._setup.regions)
            self._idle(f"the run has ended, {words}" if over else words)

    def close(self) -> None:
        """Stop serving the page."""
        if self._server is not None:
            self._server.close()

    def _idle(self, headline: str) -> None:
        """Show that nobody is asked for anything just now."""
        assert self._server is not None
        self._inspector.meshcat.Flush()
        blank: dict[str, Any] = {
            "message": "",
            "clock": "",
            "hint": "",
            "can": [],
            "leading": False,
        }
        title = f"{self._setup.scenario.name}: teach"
        empty: dict[str, Any] = {"hand": [], "joints": [], "segments": []}
        self._server.show({"title": title, "headline": headline, **blank, **empty})

    def _invite(self, number: int) -> None:
        folder = "" if self._inbox is None else f", or drop a recording's folder into {self._inbox}"
        self.announce(
            f"waiting for demonstration {number + 1}: open {self.url} in a browser{folder}"
        )

    def _pose(self, q: Array) -> None:
        linkage = self._inspector.linkage
        for name, X in zip(linkage.names, linkage.poses(q[None])[0], strict=True):
            self._inspector.meshcat.SetTransform(f"/workcell/{name}", X)

    def _look(self, lesson: DeskLesson) -> bool:
        """Read what was dropped into the watched folder; a folder still growing has to wait."""
        now = time.monotonic()
        for folder, files in self._dropped():
            if self._since.get(folder, ((), 0.0))[0] != files:
                self._since[folder] = files, now
            patience = LOOK if len(files) == 2 else 5.0 * LOOK
            if self._seen.get(folder) != files and now - self._since[folder][1] > patience:
                self._seen[folder] = files
                words = lesson.take(folder)
                todo = "mend it, or drop another" if lesson.leading else "accept or repeat it"
                self.announce(f"{words}\n{todo}: {self.url}")
                return True
        return False

    def _dropped(self) -> list[tuple[Path, _Files]]:
        """Recordings in the watched folder, and which files they have."""
        if self._inbox is None or not self._inbox.is_dir():
            return []
        found = []
        for folder in sorted(self._inbox.iterdir()):
            files = []
            for name in (JOINTS, OBJECTS):
                with suppress(OSError):
                    there = (folder / name).stat()
                    files.append((name, there.st_size, there.st_mtime_ns))
            if files:
                found.append((folder, tuple(files)))
        return found


def desk_of(setup: Setup) -> TeachingDesk | None:
    """The desk of a scenario that has an interactive teacher."""
    if setup.scenario.teacher.kind != "interactive":
        return None
    assert isinstance(setup.teacher, InteractiveTeacher)
    assert isinstance(setup.teacher.prompt, TeachingDesk)
    return setup.teacher.prompt
