"""``drake-screw evaluate``: a list of instances, planned with a folder of recordings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drake_screw.commands.options import (
    JsonOption,
    ModelOption,
    ScenarioArgument,
    SchedulerOption,
    SetOption,
    VerboseOption,
    chosen_cluster,
    chosen_scenario,
)
from drake_screw.commands.output import JSON, Output, check_distinct
from drake_screw.outputs import check_writable, writable

EXAMPLE = (
    "drake-screw evaluate pouring --demonstrations demos --instances places.csv "
    "--output outcomes.csv"
)


def evaluate(
    scenario: ScenarioArgument,
    demonstrations: Annotated[
        Path, typer.Option(metavar="DIR", help="A folder of recordings.", show_default=False)
    ],
    instances: Annotated[
        Path,
        typer.Option(
            metavar="FILE",
            help="CSV (.csv, .csv.gz) or .parquet, of any length. Columns x, y, yaw, z, roll, "
            "pitch, as far as they vary; of several objects cup.x, cup.y, ...; m and rad.",
        ),
    ],
    output: Annotated[
        Path,
        typer.Option(
            metavar="FILE",
            help="Where to write the outcomes: .csv, .csv.gz or .parquet.",
        ),
    ],
    model: ModelOption = None,
    scheduler: SchedulerOption = None,
    set_: SetOption = None,
    json: JsonOption = None,
    verbose: VerboseOption = False,
) -> None:
    """Plan every listed instance with every demonstration of a folder.

    The output has a column for each demonstration; its cells are 0:0 for success, s:j failed in
    screw segment s at the limit of joint j (both counted from 1), s:n unreachable, s:c collision.
    Which two bodies touch stands in a column of its own. Tables may be longer than memory: every
    row is looked at before planning begins, and the output appears when it is whole.
    """
    out = Output(json)
    check_writable(output, writable("--output"))
    check_distinct({"--instances": instances, "--output": output, JSON: json})
    from drake_screw.commands.countdown import Countdown
    from drake_screw.runs.outcome_table import tabulate_outcomes

    loaded = chosen_scenario(scenario, set_, model)
    with chosen_cluster(scheduler, out) as cluster, Countdown(out.console) as shown:
        found = tabulate_outcomes(
            loaded, demonstrations, instances, output, tell=shown, cluster=cluster
        )
    out.present(found)
