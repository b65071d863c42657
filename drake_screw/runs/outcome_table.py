"""Planning a list of task instances with a folder of recordings."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import counted
from drake_screw.files import WRITABLE_OUTPUT, writing
from drake_screw.planning import Outcomes, concatenate
from drake_screw.planning.touching import CollisionCounts, CollisionTally
from drake_screw.runs.instance_tables import read_instances
from drake_screw.runs.outcome_columns import outcome_columns
from drake_screw.runs.outcome_files import outcome_file
from drake_screw.runs.shared_outcomes import SharedOutcomes
from drake_screw.scenario.schema import Scenario
from drake_screw.sharing import Executor
from drake_screw.steps import Step, Tell, to_nobody
from drake_screw.typing import Array, PathLike

PORTION = 64, 1 << 13
"""Instances that are planned at a time, at first and at most; more where it goes fast."""
BRISK = 0.3
"""s, that a portion is to take; it is halved if it takes four times as long."""


@dataclass(frozen=True)
class OutcomeTable:
    """A written table of outcomes; as text it is what ``drake-screw evaluate`` prints.

    Attributes:
        output: the table.
        instances: how many were planned.
        outside: how many of them lie outside the work area.
        unlike_fixed: how many of these have another number where the scenario fixes one, by the
            column's name.
        success_rates: share of the instances that each demonstration solves, by its name.
        solved: share that at least one of them solves.
        arms: share that each arm solves, where the robot has several that are planned for: of an
            instance the first that can; {} otherwise.
        collisions: how the others collide; None where collisions are not looked at.
        seconds: that planning took.
        planned_only: whether the scenario has plans executed, which is not done here.
    """

    output: Path
    instances: int
    outside: int
    unlike_fixed: dict[str, int]
    success_rates: dict[str, float]
    solved: float
    arms: dict[str, float]
    collisions: CollisionCounts | None
    seconds: float
    planned_only: bool

    def __str__(self) -> str:
        count = (
            f"{counted(self.instances, 'instance')} x "
            f"{counted(len(self.success_rates), 'demonstration')}"
        )
        lines = [f"{count} in {self.seconds:.1f} s"]
        if self.planned_only:
            lines.append(
                "note: an instance is solved here if it has a plan; coverage.success: execution is "
                "of runs"
            )
        if self.outside:
            lines.append(
                f"note: {counted(self.outside, 'instance')} "
                f"{'lies' if self.outside == 1 else 'lie'} outside the work area"
            )
        lines += (
            f"note: the scenario fixes {name}, and {counted(count, 'instance')} "
            f"{'has' if count == 1 else 'have'} another one"
            for name, count in self.unlike_fixed.items()
        )
        lines += (f"  {name}: {rate:.1%}" for name, rate in self.success_rates.items())
        lines.append(f"solved by at least one: {self.solved:.2%}")
        lines += (f"  of these with arm {name}: {rate:.2%}" for name, rate in self.arms.items())
        if self.collisions is not None and self.collisions.collisions:
            lines.append(str(self.collisions))
        lines.append(f"written to {self.output}")
        return "\n".join(lines)


def tabulate_outcomes(
    scenario: Scenario,
    demonstrations: PathLike,
    instances: PathLike,
    output: PathLike,
    *,
    tell: Tell = to_nobody,
    cluster: Executor | None = None,
) -> OutcomeTable:
    """Write the outcomes of all instances with all demonstrations as a table.

    However many instances there are, memory does not grow: all are read and looked at first, then
    planned and written a block at a time. The table is there when all of it is.

    Args:
        scenario: gives robot, start configuration, objects and segmentation.
        demonstrations: folder of recordings, of the robot that the scenario says they are of.
        instances: CSV or Parquet to read, see `read_instances`.
        output: CSV, gzipped CSV or Parquet to write, by its ending: .csv, .csv.gz, .parquet. A row
            for each instance, in their order; columns are those of `outcome_columns`, that of what
            touches for each demonstration of which a plan collides.
        tell: told how far it is.
        cluster: whose workers plan; None for all processors of this machine.

    Raises:
        DrakeScrewError: anything that cannot be read or written; nothing is written then.
    """
    output = Path(output)
    tell(Step(f"learning from {demonstrations}"))
    setup = Setup(scenario)
    learned = [setup.learn(recording) for recording in setup.recordings(demonstrations)]
    with writing(output, WRITABLE_OUTPUT), outcome_file(output) as table:
        found = read_instances(Path(instances), setup.area, tell)
        tally = _Tally(setup, learned)
        portions = (
            _Portions(setup, learned)
            if cluster is None
            else SharedOutcomes(setup, learned, cluster)
        )
        columns, done = found.columns, 0

        def planned(count: int) -> None:
            nonlocal done
            done += count
            tell(Step("planning instances", done, len(found)))

        planned(0)
        for coordinates in found.blocks():
            outcomes = portions.plan(coordinates, planned)
            tally.add(coordinates, outcomes)
            table.add(outcome_columns(setup, learned, coordinates, columns, outcomes))
        tell(Step("writing the table"))
    return tally.of(output, found.unlike_fixed, portions.seconds)


class _Portions:
    """Plans a portion of a block at a time, so that one hears how far it is.

    Outcomes do not depend on how they are divided.

    Args:
        setup: of the scenario.
        demonstrations: D of them.

    Attributes:
        seconds: that planning took.
    """

    def __init__(self, setup: Setup, demonstrations: Sequence[Demonstration]) -> None:
        self._setup, self._demonstrations = setup, demonstrations
        self.seconds = 0.0
        self._size, self._most = PORTION

    def plan(self, coordinates: Array, planned: Callable[[int], None]) -> Outcomes:
        """Outcomes (N, D) of instances (N, k, c)."""
        parts, first = [], 0
        while first < len(coordinates):
            some = coordinates[first : first + self._size]
            began = time.perf_counter()
            parts.append(self._setup.evaluate(self._demonstrations, some))
            taken = time.perf_counter() - began
            self.seconds += taken
            first += len(some)
            planned(len(some))
            if taken < BRISK:
                self._size = min(2 * self._size, self._most)
            elif taken > 4.0 * BRISK:
                self._size = max(self._size // 2, 1)
        return concatenate(parts)


class _Tally:
    """Counts of what a table says, block by block."""

    def __init__(self, setup: Setup, demonstrations: Sequence[Demonstration]) -> None:
        self._setup = setup
        self._names = [demonstration.name for demonstration in demonstrations]
        self._collisions = CollisionTally(setup.workcell)
        self._instances = self._outside = self._solved = 0
        self._successes = np.zeros(len(demonstrations), dtype=np.int64)
        self._by_arm = np.zeros(len(setup.arms) + 1, dtype=np.int64)

    def add(self, coordinates: Array, outcomes: Outcomes) -> None:
        """Counts outcomes (N, D) of instances (N, k, c)."""
        self._instances += len(coordinates)
        self._outside += int((~self._setup.area.contains(coordinates)).sum())
        self._successes += outcomes.success.sum(axis=0)
        self._solved += int(outcomes.any_success.sum())
        none = len(self._setup.arms)
        first = np.where(outcomes.success, outcomes.arm, none).min(axis=1)
        self._by_arm += np.bincount(first, minlength=none + 1)
        if self._setup.scenario.planner.collision:
            self._collisions.add(outcomes)

    def of(self, output: Path, unlike_fixed: dict[str, int], seconds: float) -> OutcomeTable:
        """What there is to say of the table."""
        setup, N = self._setup, self._instances
        return OutcomeTable(
            output=output,
            instances=N,
            outside=self._outside,
            unlike_fixed=unlike_fixed,
            success_rates=dict(zip(self._names, (self._successes / N).tolist(), strict=True)),
            solved=self._solved / N,
            arms={
                one.name: int(self._by_arm[one.number]) / N
                for one in setup.arms
                if one.among_several
            },
            collisions=self._collisions.counts if setup.scenario.planner.collision else None,
            seconds=seconds,
            planned_only=setup.scenario.coverage.success == "execution",
        )
