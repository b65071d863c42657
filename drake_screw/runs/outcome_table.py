"""Planning a list of task instances with a folder of recordings."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

from drake_screw.assembly.setup import Setup
from drake_screw.files import WRITABLE_OUTPUT, write_text, writing
from drake_screw.runs.instance_tables import outcomes_csv, read_instances
from drake_screw.scenario.schema import Scenario
from drake_screw.typing import PathLike


@dataclass(frozen=True)
class OutcomeTable:
    """A written table of outcomes; as text it is what ``drake-screw evaluate`` prints.

    Attributes:
        output: the table.
        instances: how many were planned.
        outside: how many of them lie outside the work area.
        success_rates: share of the instances that each demonstration solves, by its name.
        solved: share that at least one of them solves.
        seconds: that planning took.
    """

    output: Path
    instances: int
    outside: int
    success_rates: dict[str, float]
    solved: float
    seconds: float

    def __str__(self) -> str:
        count = f"{self.instances:,} instances x {len(self.success_rates)} demonstrations"
        lines = [f"{count} in {self.seconds:.1f} s"]
        if self.outside:
            lines.append(f"note: {self.outside:,} instances lie outside the work area")
        lines += (f"  {name}: {rate:.1%}" for name, rate in self.success_rates.items())
        lines += [f"solved by at least one: {self.solved:.2%}", f"written to {self.output}"]
        return "\n".join(lines)


def tabulate_outcomes(
    scenario: Scenario, demonstrations: PathLike, instances: PathLike, output: PathLike
) -> OutcomeTable:
    """Write the outcomes of all instances with all demonstrations as a CSV.

    Args:
        scenario: gives robot, start configuration, objects and segmentation.
        demonstrations: folder of recordings, of the robot that the scenario says they are of.
        instances: CSV to read, see `read_instances`.
        output: CSV to write, see `outcomes_csv`.

    Raises:
        DrakeScrewError: anything that cannot be read or written; nothing is written then.
    """
    setup, output = Setup(scenario), Path(output)
    x_y_yaw = read_instances(Path(instances), setup.area)
    learned = [setup.learn(recording) for recording in setup.recordings(demonstrations)]
    began = time.perf_counter()
    outcomes = setup.evaluate(learned, x_y_yaw)
    seconds = time.perf_counter() - began
    text = outcomes_csv(x_y_yaw, outcomes, [d.name for d in learned], setup.area)
    with writing(output, WRITABLE_OUTPUT):
        write_text(output, text)
    rates = outcomes.success.mean(axis=0).tolist()
    return OutcomeTable(
        output=output,
        instances=len(x_y_yaw),
        outside=int((~setup.area.contains(x_y_yaw)).sum()),
        success_rates={d.name: rate for d, rate in zip(learned, rates, strict=True)},
        solved=float(outcomes.any_success.mean()),
        seconds=seconds,
    )
