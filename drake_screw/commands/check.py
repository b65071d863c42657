"""``drake-screw check``: what a scenario would do, before it is done."""

from __future__ import annotations

from drake_screw.commands.options import (
    JsonOption,
    ModelOption,
    ScenarioArgument,
    SetOption,
    VerboseOption,
    chosen_scenario,
)
from drake_screw.commands.output import Output

EXAMPLE = "drake-screw check my_scenario.yaml"


def check(
    scenario: ScenarioArgument,
    model: ModelOption = None,
    set_: SetOption = None,
    json: JsonOption = None,
    verbose: VerboseOption = False,
) -> None:
    """Check a scenario, and describe its run.

    Reads all its files; finds whatever would make the run fail on its input.
    """
    output = Output(json)
    from drake_screw.commands.countdown import Countdown

    loaded = chosen_scenario(scenario, set_, model)
    with Countdown(output.console) as shown:
        from drake_screw.assembly.preview import preview

        found = preview(loaded, shown)
    output.present(found)
