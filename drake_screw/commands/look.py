"""``drake-screw look``: what recordings hold, before any run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drake_screw.commands.options import (
    JsonOption,
    ModelOption,
    SetOption,
    VerboseOption,
    chosen_scenario,
)
from drake_screw.commands.output import Output, check_page

EXAMPLE = "drake-screw look recordings/demo_07 --html demo_07.html"


def look(
    recording: Annotated[
        Path,
        typer.Argument(
            metavar="RECORDING", help="A recording, or a folder of recordings.", show_default=False
        ),
    ],
    scenario: Annotated[
        str | None,
        typer.Option(
            metavar="SCENARIO",
            help="Says which robot and objects, and how paths are cut. Default: that of the run "
            "the recording is in, or a shipped one named like its folder, or pouring.",
            show_default=False,
        ),
    ] = None,
    html: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write a page with charts and the scene in 3-D, too."),
    ] = None,
    model: ModelOption = None,
    set_: SetOption = None,
    json: JsonOption = None,
    verbose: VerboseOption = False,
) -> None:
    """Look at a recording, or a folder of them, before any run.

    How faithfully it is kept and what is dropped, its screws, how near the end effector
    comes to the objects, and the joints to their limits; or why it is not used.
    """
    output = Output(json)
    check_page(html, json)
    from drake_screw.commands.countdown import Countdown
    from drake_screw.commands.look_console import chosen_for, show_looks

    name, why = chosen_for(recording, scenario)
    loaded = chosen_scenario(name, set_, model)
    with Countdown(output.console) as shown:
        from drake_screw.assembly.looking import look_at_path
        from drake_screw.assembly.setup import Setup

        looks = look_at_path(Setup(loaded), recording, shown)
        summary = looks.summary
        if html is not None:
            from drake_screw.web.look_page import write_look_page

            write_look_page(looks, html, shown)
    show_looks(summary, why, output)
    if html is not None:
        output.say(f"written: {html}")
    output.write(summary)
