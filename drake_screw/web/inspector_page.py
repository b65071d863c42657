"""``drake-screw inspect``: a run's attempts in the browser, on a page, in the terminal."""

from __future__ import annotations

from pathlib import Path

from pydrake.geometry import Meshcat, MeshcatParams
from rich.console import Console
from rich.table import Table
from rich.text import Text

from drake_screw.errors import DrakeScrewError
from drake_screw.runs.reader import RunReader
from drake_screw.runs.run import open_run
from drake_screw.visualization.attempt import Attempt, headline
from drake_screw.visualization.lifetime import page_meshcat, scratch
from drake_screw.visualization.palette import OUTCOME_NAMES
from drake_screw.web.attempt_tables import attempts_csv, attempts_json
from drake_screw.web.choice import Choice, changed, choose
from drake_screw.web.panel import (
    inspector_body,
    where,
    with_panel,
)
from drake_screw.web.panel_server import PanelServer, check_address, warning
from drake_screw.web.stage import Stage

POLL = 1.0
"""s. How often a run that is still going on is asked for new rounds."""


def inspect(
    run: Path,
    console: Console,
    *,
    round: int | None = None,
    instance: int | None = None,
    html: Path | None = None,
    host: str = "localhost",
    port: int | None = None,
) -> None:
    """Look at a run: in the terminal, and in the browser or on a page.

    Args:
        run: its directory, finished or not.
        console: to write to.
        round: counted from 1; if None the last one that asked for a demonstration.
        instance: a row of the round's instances, from 0; if None the suggested one, or the
            earliest failing.
        html: a page to write, with its numbers beside it; if None, serve until interrupted.
        host, port: as in `serve`.

    Raises:
        RunDirectoryError: the directory is damaged, of another version, or has no round yet.
        ScenarioError: there is no such round or instance.
    """
    reader = open_run(run).reader
    choice = choose(reader, reader.check_round(round), instance)
    if html is None:
        serve(reader, choice, console, host=host, port=port)
    else:
        tell_instance(reader, choice, console)
        page = save_page(reader, choice, html)
        console.print(f"written: {page}, its numbers beside it (.csv, .json)", soft_wrap=True)


def serve(
    reader: RunReader,
    choice: Choice,
    console: Console,
    *,
    host: str = "localhost",
    port: int | None = None,
) -> None:
    """Show a run in the browser until interrupted.

    Args:
        reader: of the run.
        choice: what to show first.
        console: told where to look, with the first instance's table, and which ones follow.
        host: "localhost", or an address to listen on, so that others can look, too.
        port: of the page; any free one if None.
    """
    check_address(host, port)
    stage = Stage(reader, page_meshcat(host))
    page = inspector_body(None)
    name = reader.setup.scenario.name
    server = PanelServer(stage.meshcat.port(), page, f"{name}: inspect", host=host, port=port)
    risk = warning(host)
    if risk is not None:
        console.print(risk, style="yellow", highlight=False, soft_wrap=True)
    console.print(f"open {server.url} in a browser; Ctrl-C ends it", soft_wrap=True)
    try:
        server.show(stage.show(choice, live=True))
        tell_instance(reader, choice, console)
        while True:
            message = server.message(POLL)
            if message is None:
                if reader.refresh():
                    server.show(stage.show(choice, live=True))
                continue
            before, choice = choice, changed(reader, choice, message)
            server.show(stage.show(choice, live=True))
            if (before.round, before.instance) != (choice.round, choice.instance):
                _tell(reader, choice, console)
    except KeyboardInterrupt:
        console.print("ended")
    finally:
        server.close()


def save_page(reader: RunReader, choice: Choice, file: Path) -> Path:
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
    with scratch():
        page = _page(reader, choice)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(page, encoding="utf-8")
    except OSError as error:
        raise DrakeScrewError(
            f"cannot be written: {error.strerror}", remedy="Give another --html.", file=file
        ) from error
    if choice.instance is not None:
        attempts = reader.attempts(choice.round, choice.instance)
        file.with_suffix(".csv").write_text(attempts_csv(attempts))
        facts = {"round": choice.round + 1, "instance": choice.instance}
        text = attempts_json(attempts, facts, reader.setup.area)
        file.with_suffix(".json").write_text(text)
    return file


def _page(reader: RunReader, choice: Choice) -> str:
    stage = Stage(reader, Meshcat(MeshcatParams(host="localhost", show_stats_plot=False)))
    drawn = stage.show(choice, live=False)
    title = f"{reader.setup.scenario.name}, round {choice.round + 1}"
    return with_panel(stage.meshcat.StaticHtml(), inspector_body(drawn), title)


def instance_table(attempts: list[Attempt]) -> Table:
    """All demonstrations of an instance side by side."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for name in ("", "demonstration", "outcome", "segment", "joint", "along it", "least margin"):
        right = name in ("", "segment", "along it", "least margin")
        table.add_column(name, justify="right" if right else "left")
    for tried in attempts:
        joint, margin = tried.tightest
        names, failed, at = tried.arm.joint_names, tried.failed_segment, tried.failed_joint
        table.add_row(
            str(tried.number + 1),
            tried.demonstration.name,
            Text(OUTCOME_NAMES[tried.cause], style="green" if tried.plan.success else "yellow"),
            "" if failed is None else f"{failed + 1} of {len(tried.guides)}",
            "" if at is None else names[at],
            "" if failed is None else f"{float(tried.plan.outcome.fraction):.1%}",
            f"{margin:.3f} ({names[joint]})",
        )
    return table


def tell_instance(reader: RunReader, choice: Choice, console: Console) -> None:
    """An instance and all its attempts in words and as a table."""
    if choice.instance is None:
        console.print("this round has no instances")
        return
    attempts = reader.attempts(choice.round, choice.instance)
    _tell(reader, choice, console)
    console.print(instance_table(attempts))
    for tried in attempts:
        text = f"demonstration {tried.number + 1} {headline(tried)}"
        console.print(Text(text), soft_wrap=True)


def _tell(reader: RunReader, choice: Choice, console: Console) -> None:
    if choice.instance is not None:
        x_y_yaw = reader.event(choice.round).evaluation.x_y_yaw[choice.instance]
        place = where(reader.setup.area, x_y_yaw)
        console.print(
            Text(f"round {choice.round + 1}, instance {choice.instance}: {place}"), soft_wrap=True
        )
