"""``drake-screw inspect``: why instances of a run fail."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drake_screw.commands.options import RunArgument, VerboseOption
from drake_screw.commands.output import Output

EXAMPLE = "drake-screw inspect runs/pouring/TIME --html failing.html"


def inspect(
    run: RunArgument,
    round: Annotated[
        int | None, typer.Option(help="Round, from 1. Default: the last that asked.")
    ] = None,
    instance: Annotated[
        int | None, typer.Option(help="Row of the round's instances, from 0. Default: suggested.")
    ] = None,
    html: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a page instead of serving one.")
    ] = None,
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "localhost",
    port: Annotated[int | None, typer.Option(help="Port of the page. Default: a free one.")] = None,
    verbose: VerboseOption = False,
) -> None:
    """See why an instance fails.

    In the terminal, and in Meshcat or on a page that can be kept. It begins with the last round
    that asked for a demonstration, at the instance where it did.
    """
    from drake_screw.commands.inspect_console import inspect_run

    inspect_run(
        run, Output().console, round=round, instance=instance, html=html, host=host, port=port
    )
