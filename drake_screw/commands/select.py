"""``drake-screw select``: the fewest recordings of a folder that suffice."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drake_screw.commands.options import (
    JsonOption,
    ModelOption,
    ScenarioArgument,
    SeedOption,
    SetOption,
    VerboseOption,
    chosen_scenario,
)
from drake_screw.commands.output import Output

EXAMPLE = "drake-screw select pouring --demonstrations recordings"


def select(
    scenario: ScenarioArgument,
    demonstrations: Annotated[
        Path, typer.Option(metavar="DIR", help="A folder of recordings.", show_default=False)
    ],
    instances: Annotated[
        int | None,
        typer.Option(
            help="Instances in each region to compare sets of recordings on, at first. Default: "
            "400, or 6,400 shared out among more than 16 regions, but 25 at least.",
            min=1,
        ),
    ] = None,
    model: ModelOption = None,
    seed: SeedOption = None,
    set_: SetOption = None,
    json: JsonOption = None,
    verbose: VerboseOption = False,
) -> None:
    """Find the fewest recordings that suffice, and certify them.

    Sets are compared on a table of instances planned with all recordings; the chosen one is
    certified on fresh instances, as in a run: with coverage.success=execution by executing plans,
    while the table is of plans even then. Nothing is kept of a selection that is interrupted.
    Exit code 0: certified. 1: no set is. 2: bad input.
    """
    out = Output(json)
    from drake_screw.commands.select_console import SelectConsole, show_selection

    loaded = chosen_scenario(scenario, set_, model, seed=seed)
    with SelectConsole(out.console) as shown:
        from drake_screw.runs.selecting import select as select_recordings

        found = select_recordings(loaded, demonstrations, instances=instances, listener=shown)
    show_selection(found, loaded.demonstrations.budget, out)
    out.write(found)
    raise typer.Exit(0 if found.certified else 1)
