"""The pages that a run is watched on and taught at."""

from __future__ import annotations

from dataclasses import dataclass

from rich.console import Console

from drake_screw.errors import DrakeScrewError
from drake_screw.scenario.assemble import Setup
from drake_screw.scenario.live import LiveView
from drake_screw.scenario.schema import Scenario
from drake_screw.scenario.teaching import TeachingDesk, desk_of
from drake_screw.visualization.panel_server import check_address, warning


def check_pages(scenario: Scenario, meshcat: bool, host: str, port: int | None) -> None:
    """Find out whether a run's pages can be served, before anything is written.

    Args:
        scenario, meshcat, host, port: as in `open_pages`.

    Raises:
        DrakeScrewError: they cannot be served there, or there are none.
    """
    pages = (meshcat or scenario.meshcat) + (scenario.teacher.kind == "interactive")
    if pages == 0 and (host != "localhost" or port is not None):
        raise DrakeScrewError(
            "--host and --port are for a page, and this run has none",
            remedy="Add --meshcat to watch the run in the browser.",
        )
    for number in range(pages):
        check_address(host, None if port is None else port + number)


@dataclass(frozen=True)
class Pages:
    """The pages of a run.

    Attributes:
        view: the one on which the run is watched, if there is one; a listener.
        desk: the one at which demonstrations are given, if there is one.
    """

    view: LiveView | None
    desk: TeachingDesk | None

    def close(self) -> None:
        """Stop serving them."""
        for page in (self.view, self.desk):
            if page is not None:
                page.close()


def open_pages(
    setup: Setup,
    console: Console,
    *,
    meshcat: bool = False,
    host: str = "localhost",
    port: int | None = None,
) -> Pages:
    """Serve the pages of a run that is about to begin, and say where they are.

    An interactive teacher has a page of its own, where demonstrations are given; the one on which
    the run is watched leads there.

    Args:
        setup: of the run.
        console: told the addresses, with a warning where they are not on localhost.
        meshcat: whether the run is watched even if its scenario does not ask for it.
        host: "localhost", or an address to listen on.
        port: of the page; if there are two, the teacher's has the next one. Free ones if None.

    Raises:
        DrakeScrewError: they cannot be served there.
    """
    desk, watched = desk_of(setup), meshcat or setup.scenario.meshcat
    risk = warning(host)
    if risk is not None:
        console.print(risk, style="yellow", highlight=False, soft_wrap=True)
    view = None
    if desk is not None:
        desk.host = host
        desk.port = port + 1 if port is not None and watched else port
        desk.open()
    if watched:
        teach = "" if desk is None else desk.url
        try:
            view = LiveView(setup, host=host, port=port, teach=teach)
        except DrakeScrewError:
            if desk is not None:
                desk.close()
            raise
        console.print(f"watch the run at {view.url}", soft_wrap=True)
    if desk is not None:
        console.print(f"give demonstrations at {desk.url}", soft_wrap=True)
    return Pages(view, desk)
