"""``drake-screw import``: recordings from the files that there are."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drake_screw.commands.options import ModelOption, SetOption, VerboseOption, chosen_scenario
from drake_screw.commands.output import Output
from drake_screw.errors import DrakeScrewError

if TYPE_CHECKING:
    from drake_screw.recordings import Understood

EXAMPLE = "drake-screw import log.csv --output recordings --object bowl=0.9,0.1"


def import_(
    source: Annotated[
        Path,
        typer.Argument(metavar="SOURCE", help="A file, or a folder of files.", show_default=False),
    ],
    output: Annotated[
        Path | None,
        typer.Option(metavar="LIBRARY", help="The folder of recordings to write to."),
    ] = None,
    scenario: Annotated[
        str,
        typer.Option(metavar="SCENARIO", help="Says which robot and objects."),
    ] = "pouring",
    object_: Annotated[
        list[str] | None,
        typer.Option(
            "--object",
            metavar="NAME=PLACE",
            help="Where an object was: bowl=0.9,0.1 or bowl=0.9,0.1,0.5 (x, y, yaw), 16 numbers, "
            "bowl=x,y,z,xyzw:0,0,0,1, or bowl@hand:12.4s+0,0,0.12.",
        ),
    ] = None,
    mapping: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="What the columns mean. Default: recording.yaml beside the data."
        ),
    ] = None,
    format: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Of the files: table, rostopic, bag, lerobot, hdf5, trajectory. Default: told by "
            "them.",
        ),
    ] = None,
    rate: Annotated[
        float | None, typer.Option(metavar="HZ", help="Of samples without a time.", min=1e-9)
    ] = None,
    episodes: Annotated[
        str | None,
        typer.Option(
            metavar="WHAT",
            help="Cuts a file that holds several demonstrations: pauses, a bag's topic, or a "
            "column.",
        ),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what is understood, and write nothing.")
    ] = False,
    model: ModelOption = None,
    set_: SetOption = None,
    verbose: VerboseOption = False,
) -> None:
    """Bring recordings in from files as they are.

    Columns, units and time are told from the file where they can only be one thing; what was
    understood is printed as the lines of a recording.yaml, which says it where it cannot be told.
    """
    if output is None and not dry_run:
        raise DrakeScrewError(
            "no --output", remedy="Give the folder to write to; or --dry-run, to look only."
        )
    from drake_screw.commands.countdown import Countdown
    from drake_screw.recordings import Mapping, read_mapping
    from drake_screw.recordings.places import parse_objects
    from drake_screw.steps import Step

    objects = parse_objects(object_ or [])
    said = read_mapping(mapping) if mapping else Mapping()
    said = said.with_(
        format=format, rate=rate, episodes=episodes, objects={**said.objects, **objects} or None
    )
    loaded = chosen_scenario(scenario, set_, model)
    out = Output()
    with Countdown(out.console) as shown:
        from drake_screw.assembly.importing import read_recordings, write_library
        from drake_screw.assembly.setup import Setup

        def reading(file: Path) -> Callable[[float], None]:
            shown(Step(f"reading {file.name}"))

            def read(part: float) -> None:
                shown(Step(f"reading {file.name}", part, 1.0))
                if part >= 1.0:
                    shown(Step(f"making out {file.name}"))

            return read

        setup = Setup(loaded)
        found = read_recordings(source, setup, said, objects_needed=not dry_run, progress=reading)
    for each in found:
        _say(each, out)
    if dry_run:
        out.say("nothing was written (--dry-run); to keep what was understood, recording.yaml:")
        out.say(found[0].mapping.text().rstrip())
        return
    assert output is not None
    with Countdown(out.console) as shown:
        folders = write_library(found, output, shown)
    for folder in folders:
        out.say(f"written: {folder}")
    out.say(f"  drake-screw look {output} --scenario {scenario}")


def _say(found: Understood, out: Output) -> None:
    out.say(found.name)
    width = max(len(name) for name, _ in found.facts)
    before = ""
    for name, text in found.facts:
        out.say(f"  {'' if name == before else name:<{width}}  {text}")
        before = name
