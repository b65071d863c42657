"""``drake-screw compare``: finished runs side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drake_screw.commands.options import JsonOption, VerboseOption
from drake_screw.commands.output import Output, check_page

EXAMPLE = "drake-screw compare runs/pouring/monday runs/pouring/tuesday --html both.html"


def compare(
    runs: Annotated[
        list[Path],
        typer.Argument(metavar="RUN", help="Directories of two runs or more.", show_default=False),
    ],
    html: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write a page with their heat maps in one scale, too."),
    ] = None,
    json: JsonOption = None,
    verbose: VerboseOption = False,
) -> None:
    """Compare finished runs.

    Where their scenarios and certificates differ, their demonstrations, coverage by region, and
    what they made of instances that both have drawn; and what cannot be compared.
    """
    output = Output(json)
    check_page(html, json)
    from drake_screw.commands.compare_console import show_comparison
    from drake_screw.commands.countdown import Countdown
    from drake_screw.steps import Step

    with Countdown(output.console) as shown:
        from drake_screw.runs.comparison import compare_runs, open_runs

        opened = open_runs(runs, shown)
        shown(Step("comparing"))
        comparison = compare_runs(opened)
        if html is not None:
            from drake_screw.web.compare_page import write_compare_page

            shown(Step("drawing maps"))
            write_compare_page(opened, comparison, html)
    show_comparison(comparison, output)
    if html is not None:
        output.say(f"written: {html}")
    output.write(comparison)
