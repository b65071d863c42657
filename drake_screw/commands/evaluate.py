"""Planning a list of task instances with a folder of recordings."""

from __future__ import annotations

import time
from pathlib import Path

from drake_screw.assembly.setup import Setup
from drake_screw.errors import RunDirectoryError
from drake_screw.files import write_text
from drake_screw.runs.instance_tables import outcomes_csv, read_instances
from drake_screw.scenario.schema import Scenario


def evaluate(scenario: Scenario, demonstrations: Path, instances: Path, output: Path) -> str:
    """Write the outcomes of all instances with all demonstrations as a CSV.

    Args:
        scenario: gives robot, start configuration, objects and segmentation.
        demonstrations: folder of recordings, of the robot that the scenario says they are of.
        instances: CSV to read, see `read_instances`.
        output: CSV to write, see `outcomes_csv`.

    Returns:
        A summary for people.

    Raises:
        DrakeScrewError: anything that cannot be read or written; nothing is written then.
    """
    setup = Setup(scenario)
    x_y_yaw = read_instances(instances, setup.area)
    learned = [setup.learn(recording) for recording in setup.recorder.library(demonstrations)]
    began = time.perf_counter()
    outcomes = setup.planner.all_outcomes(learned, setup.area.X_WO(x_y_yaw), setup.workcell.start)
    seconds = time.perf_counter() - began
    text = outcomes_csv(x_y_yaw, outcomes, [d.name for d in learned], setup.area)
    try:
        write_text(output, text)
    except OSError as error:
        raise RunDirectoryError(
            f"cannot be written: {error.strerror}",
            remedy="Give an --output in a folder that exists and that you may write to.",
            file=output,
        ) from error
    rates = outcomes.success.mean(axis=0)
    lines = [
        f"{len(x_y_yaw):,} instances x {len(learned)} demonstrations in {seconds:.1f} s",
        *(f"  {d.name}: {rate:.1%}" for d, rate in zip(learned, rates, strict=True)),
        f"solved by at least one: {outcomes.any_success.mean():.2%}",
        f"written to {output}",
    ]
    outside = ~setup.area.contains(x_y_yaw)
    if outside.any():
        lines.insert(1, f"note: {outside.sum():,} instances lie outside the work area")
    return "\n".join(lines)
