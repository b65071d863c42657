"""The desk of an interactive teacher: lead the arm in the browser, record, look, accept."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from pydrake.geometry import Meshcat, MeshcatParams

from drake_screw.acquisition import Suggestion
from drake_screw.demonstrations import Recording
from drake_screw.demonstrations.library import JOINTS, OBJECTS
from drake_screw.scenario.assemble import Setup
from drake_screw.scenario.lesson import PERIOD, DeskLesson
from drake_screw.screws.rotations import Array
from drake_screw.visualization import Scene
from drake_screw.visualization.inspector import Inspector
from drake_screw.visualization.inspector_panel import KEY, body, script_json
from drake_screw.visualization.palette import ACCENT
from drake_screw.visualization.panel_server import PanelServer

SAY = 0.1
"""s. Between states of the panel while the arm moves."""
LOOK = 1.0
"""s. Between looks into the watched folder."""


class TeachingDesk:
    """Asks for demonstrations in the browser; a `Desk` of an `InteractiveTeacher`.

    The page opens with the first request. The person leads the arm by sliders of the hand's pose
    (differential inverse kinematics keeps the joints within their limits) or of the joints, and
    records; the recording is cut into screws and planned at once, to be accepted or repeated. Or
    they drop a recording's folder into the watched folder.

    Args:
        setup: of the run.
        inbox: the watched folder; none if None.
        host, port: of the page, as in `PanelServer`.
        announce: told where the page is.
    """

    def __init__(
        self,
        setup: Setup,
        *,
        inbox: Path | None = None,
        host: str = "localhost",
        port: int | None = None,
        announce: Callable[[str], None] = print,
    ) -> None:
        self._setup, self._inbox, self._host, self._port = setup, inbox, host, port
        self._announce = announce
        self._seen: set[Path] = set()
        self._server: PanelServer | None = None

    def teach(self, suggestion: Suggestion, number: int) -> Recording | None:
        """See `Desk.teach`; returns when the person has decided."""
        if self._server is None:
            self._open()
        assert self._server is not None
        lesson = DeskLesson(self._setup, self._inspector, suggestion, number)
        self._inspector.clear()
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
            if now - looked > LOOK and lesson.leading:
                looked = now
                moved |= self._look(lesson)
            if moved and now - said > SAY:
                said, moved = now, lesson.recording_now
                self._pose(lesson.led.q)
                self._server.show(lesson.state())
        self._inspector.clear()
        self._server.show(lesson.state())
        return lesson.accepted

    def _open(self) -> None:
        setup = self._setup
        meshcat = Meshcat(MeshcatParams(host=self._host, show_stats_plot=False))
        name = setup.scenario.name
        self._scene = Scene(
            meshcat, setup.robot, setup.table, setup.objects, setup.area, scenario=name
        )
        self._inspector = Inspector(meshcat, setup.workcell, setup.objects)
        key = ((ACCENT, "demonstrate here"), *KEY)
        panel = body("teach.html", f"const KEY = {script_json(key)};", ("panel.js", "teach.js"))
        self._server = PanelServer(
            meshcat.port(), panel, f"{name}: teach", host=self._host, port=self._port
        )
        self._announce(f"a demonstration is wanted: open {self._server.url} in a browser")
        if self._inbox is not None:
            self._inbox.mkdir(parents=True, exist_ok=True)
            self._seen = set(self._inbox.iterdir())
            self._announce(f"or drop a recording's folder into {self._inbox}")

    def _pose(self, q: Array) -> None:
        linkage = self._inspector.linkage
        for name, X in zip(linkage.names, linkage.poses(q[None])[0], strict=True):
            self._inspector.meshcat.SetTransform(f"/workcell/{name}", X)

    def _look(self, lesson: DeskLesson) -> bool:
        """Read what was dropped into the watched folder; a folder still growing has to wait."""
        if self._inbox is None:
            return False
        for folder in sorted(set(self._inbox.iterdir()) - self._seen):
            files = [folder / JOINTS, folder / OBJECTS]
            if all(f.is_file() and time.time() - f.stat().st_mtime > LOOK for f in files):
                self._seen.add(folder)
                lesson.take(folder)
                return True
        return False
