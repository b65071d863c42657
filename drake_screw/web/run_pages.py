"""The pages beside a run: where it is watched, and where demonstrations are given."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Self

from drake_screw.acquisition.interactive_teacher import InteractiveTeacher
from drake_screw.assembly.setup import Parts, Setup
from drake_screw.errors import DrakeScrewError
from drake_screw.runs.pictures import SCENE
from drake_screw.runs.run import Listener
from drake_screw.scenario.schema import Scenario
from drake_screw.web.live_page import LivePage
from drake_screw.web.server import check_address, warning
from drake_screw.web.teaching_page import TeachingPage


class RunPages:
    """The pages of a run that is about to begin.

    An interactive teacher has a page of its own, where demonstrations are given; the one on which
    the run is watched leads there. To be used as a context manager; at its end they are closed.

    Args:
        scenario: of the run.
        watched: show the run, even if the scenario does not say so.
        host: "localhost", or an address to listen on.
        port: of the page; if there are two, the teacher's has the next one. Free ones if None.
        announce: called with the addresses, and whenever a person is waited for.

    Attributes:
        watched: whether the run is shown.
        live: the page on which it is, once open.
        teaching: the page where demonstrations are given, if there is one.

    Raises:
        DrakeScrewError: they cannot be served there, or there are none.
    """

    def __init__(
        self,
        scenario: Scenario,
        *,
        watched: bool = False,
        host: str = "localhost",
        port: int | None = None,
        announce: Callable[[str], None] = print,
    ) -> None:
        self.watched = watched or scenario.meshcat
        self.live: LivePage | None = None
        self.teaching: TeachingPage | None = None
        self._interactive = scenario.teacher.kind == "interactive"
        self._host, self._port, self._announce = host, port, announce
        count = self.watched + self._interactive
        if count == 0 and (host != "localhost" or port is not None):
            raise DrakeScrewError(
                "--host and --port are for a page, and this run has none",
                remedy="Add --meshcat to watch the run in the browser.",
            )
        for number in range(count):
            check_address(host, None if port is None else port + number)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for page in (self.live, self.teaching):
            if page is not None:
                page.close()

    @property
    def parts(self) -> Parts:
        """What has to be passed to the run: the teacher, if there is a page to teach on."""
        return Parts(teacher=self._teacher) if self._interactive else Parts()

    @property
    def listeners(self) -> Sequence[Listener]:
        """The pages that are open."""
        return [page for page in (self.live, self.teaching) if page is not None]

    def open(self, setup: Setup, folder: Path | None = None) -> None:
        """Serve the pages of a run, and say where they are.

        Args:
            setup: of the run, made with `parts`.
            folder: the run directory, if there is one; the pages say what is kept there.

        Raises:
            DrakeScrewError: they cannot be served, or the teacher's folder cannot be watched.
        """
        risk = warning(self._host)
        if risk is not None and (self.watched or self._interactive):
            self._announce(risk)
        teach = ""
        if self._interactive:
            teach = self._teaching_page(setup).open()
        if self.watched:
            kept = None if folder is None else folder.resolve() / SCENE
            self.live = LivePage(setup, host=self._host, port=self._port, teach=teach, kept=kept)
            self._announce(f"watch the run at {self.live.url}")
        if teach:
            self._announce(f"give demonstrations at {teach}")

    def _teacher(self, setup: Setup) -> InteractiveTeacher:
        return InteractiveTeacher(self._teaching_page(setup), setup.area)

    def _teaching_page(self, setup: Setup) -> TeachingPage:
        if self.teaching is None:
            port = self._port + 1 if self._port is not None and self.watched else self._port
            self.teaching = TeachingPage(
                setup,
                inbox=setup.scenario.teacher.folder,
                host=self._host,
                port=port,
                announce=self._announce,
            )
        return self.teaching
