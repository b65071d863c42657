"""``drake-screw init``: a scenario of one's own to begin with."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drake_screw.commands.options import VerboseOption
from drake_screw.commands.output import Output
from drake_screw.errors import DrakeScrewError, ScenarioError, unknown

EXAMPLE = "drake-screw init pouring --output mine.yaml"

_SCHEMA = "# yaml-language-server: $schema="


def init(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="A shipped scenario to begin with.")
    ] = "pouring",
    output: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Where to write it. Default: NAME.yaml, here."),
    ] = None,
    verbose: VerboseOption = False,
) -> None:
    """Write a scenario of your own, to change.

    It is a copy of a shipped one, in which every key is explained.
    """
    from drake_screw.files import WRITABLE_OUTPUT, write_text, writing
    from drake_screw.resources import SCENARIO_SUFFIXES, find_resource, list_resources

    shipped = list_resources("scenarios", SCENARIO_SUFFIXES)
    if name not in shipped:
        message, remedy = unknown("scenario", name, "what is shipped", shipped)
        raise ScenarioError(message, remedy=remedy)
    file = output or Path(f"{name}.yaml")
    if file.suffix not in SCENARIO_SUFFIXES:
        raise DrakeScrewError(
            "not the name of a scenario file", remedy=f"Name it {file.stem}.yaml, say.", file=file
        )
    source = find_resource("scenarios", name, SCENARIO_SUFFIXES)
    text = scenario_copy(source.read_text(encoding="utf-8"), source.parent)
    if file.exists():
        raise DrakeScrewError(
            "exists already; nothing is overwritten", remedy="Give another --output.", file=file
        )
    with writing(file, WRITABLE_OUTPUT):
        write_text(file, text)
    out = Output()
    out.say(f"written: {file}; change it, then")
    out.say(f"  drake-screw check {file}")
    out.say(f"  drake-screw run {file}")


def scenario_copy(text: str, folder: Path) -> str:
    """A scenario's text, fit for any other folder.

    A line that names its schema for editors, by a path relative to the file, gets that path in
    full, and goes where there is no such file.

    Args:
        text: of the scenario.
        folder: that it comes from.
    """
    lines = []
    for line in text.splitlines(keepends=True):
        if line.startswith(_SCHEMA):
            schema = line.removeprefix(_SCHEMA).strip()
            if "://" not in schema:
                file = (folder / schema).resolve()
                if not file.is_file():
                    continue
                line = f"{_SCHEMA}{file.as_uri()}\n"
        lines.append(line)
    return "".join(lines)
