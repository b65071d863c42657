"""A run's attempts in the browser: served from a program, or saved as a page."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from markupsafe import Markup
from pydrake.geometry import Meshcat, MeshcatParams

from drake_screw.errors import DrakeScrewError
from drake_screw.files import write_text, writing
from drake_screw.outputs import check_writable
from drake_screw.runs.reader import RunReader
from drake_screw.visualization.lifetime import page_meshcat, scratch
from drake_screw.visualization.meshcat_page import add_to_page, render
from drake_screw.web.attempt_tables import attempts_csv, attempts_json
from drake_screw.web.inspector_panel import KEY
from drake_screw.web.inspector_scene import InspectorScene
from drake_screw.web.selection import Selection, after_message
from drake_screw.web.server import PanelServer, check_address, warning

POLL_PERIOD = 1.0
"""s. How often a run that is still going on is asked for new rounds."""


def serve(
    reader: RunReader,
    selection: Selection,
    *,
    host: str = "localhost",
    port: int | None = None,
    announce: Callable[[str], None] = print,
    on_selection: Callable[[Selection], None] | None = None,
) -> None:
    """Show a run in the browser until interrupted.

    Args:
        reader: the run.
        selection: what to show first.
        host: "localhost", or an address to listen on, so that others can look, too.
        port: of the page; any free one if None.
        announce: called with the warning of an open address, with the page's address, and at the
            end.
        on_selection: called with the first selection, and with every one of another instance.

    Raises:
        DrakeScrewError: the page cannot be served there.
    """
    check_address(host, port)
    scene = InspectorScene(reader, page_meshcat(host))
    title = f"{reader.setup.scenario.name}: inspect"
    server = PanelServer(scene.meshcat.port(), _panel(None), title, host=host, port=port)
    risk = warning(host)
    if risk is not None:
        announce(risk)
    announce(f"open {server.url} in a browser; Ctrl-C ends it")
    try:
        server.show(scene.show(selection, live=True))
        if on_selection is not None:
            on_selection(selection)
        while True:
            message = server.message(POLL_PERIOD)
            if message is None:
                if reader.refresh():
                    server.show(scene.show(selection, live=True))
                continue
            before, selection = selection, after_message(reader, selection, message)
            server.show(scene.show(selection, live=True))
            moved = (before.round, before.instance) != (selection.round, selection.instance)
            if moved and on_selection is not None:
                on_selection(selection)
    except KeyboardInterrupt:
        announce("ended")
    finally:
        server.close()


def save_page(reader: RunReader, selection: Selection, file: Path) -> Path:
    """Write one instance with all its demonstrations as a page that needs no network.

    Beside it, with the same name, are its numbers as .json and the plans as .csv.

    Raises:
        DrakeScrewError: the page cannot be written there.
    """
    if file.suffix in (".csv", ".json"):
        raise DrakeScrewError(
            "a page under this name would be overwritten by its own numbers",
            remedy=f"Name it {file.with_suffix('.html').name}; the numbers are written beside it.",
            file=file,
        )
    numbers = [file.with_suffix(".csv"), file.with_suffix(".json")]
    for written in (file, *numbers):
        if written.parent.is_dir():
            check_writable(written, "Give another --html.")
    texts = {}
    if selection.instance is not None:
        attempts = reader.attempts(selection.round, selection.instance)
        facts = {"round": selection.round + 1, "instance": selection.instance}
        texts[numbers[0]] = attempts_csv(attempts)
        texts[numbers[1]] = attempts_json(attempts, facts, reader.setup.area)
    with scratch():
        texts[file] = _saved_page(reader, selection)
    for written, text in texts.items():
        with writing(written, remedy="Give another --html."):
            written.parent.mkdir(parents=True, exist_ok=True)
            write_text(written, text)
    return file


def _saved_page(reader: RunReader, selection: Selection) -> str:
    meshcat = Meshcat(MeshcatParams(host="localhost", show_stats_plot=False))
    state = InspectorScene(reader, meshcat).show(selection, live=False)
    title = f"{reader.setup.scenario.name}, round {selection.round + 1}"
    return add_to_page(meshcat.StaticHtml(), _panel(state), title=title)


def _panel(saved_state: dict[str, Any] | None) -> Markup:
    """The panel of a saved page with its state, or of a live one with None."""
    return render("drake_screw.web", "inspector.html.j2", key=KEY, saved_state=saved_state)
