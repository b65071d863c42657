"""Planning a list of task instances with a folder of recordings."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import counted
from drake_screw.files import WRITABLE_OUTPUT, write_text, writing
from drake_screw.planning import Cause, Outcomes
from drake_screw.planning.symmetry import TOOL
from drake_screw.planning.touching import (
    CollisionCounts,
    Pair,
    count_collisions,
    cut_short,
    known_pair,
    pair_name,
    touching_bodies,
)
from drake_screw.runs.instance_tables import outcomes_csv, read_instances, unlike_fixed
from drake_screw.scenario.schema import Scenario
from drake_screw.typing import Array, PathLike


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
    scenario: Scenario, demonstrations: PathLike, instances: PathLike, output: PathLike
) -> OutcomeTable:
    """Write the outcomes of all instances with all demonstrations as a CSV.

    Args:
        scenario: gives robot, start configuration, objects and segmentation.
        demonstrations: folder of recordings, of the robot that the scenario says they are of.
        instances: CSV to read, see `read_instances`.
        output: CSV to write, see `outcomes_csv`; with a column `demonstration:arm` for the arm that
            an outcome is of where there are several, a column `demonstration:body` for each body
            that a demonstration may turn, and a column `demonstration:touches` for each
            demonstration of which a plan collides, with the bodies: "left_hand-bowl".

    Raises:
        DrakeScrewError: anything that cannot be read or written; nothing is written then.
    """
    setup, output = Setup(scenario), Path(output)
    coordinates = read_instances(Path(instances), setup.area)
    learned = [setup.learn(recording) for recording in setup.recordings(demonstrations)]
    began = time.perf_counter()
    outcomes = setup.evaluate(learned, coordinates)
    seconds = time.perf_counter() - began
    turns = _turns(setup, learned, setup.area.X_WO(coordinates), outcomes)
    arms = _arms(setup, learned, outcomes)
    touching = _touching(setup, learned, setup.area.X_WO(coordinates), outcomes)
    names = [d.name for d in learned]
    text = outcomes_csv(coordinates, outcomes, names, setup.area, turns, {**arms, **touching})
    with writing(output, WRITABLE_OUTPUT):
        write_text(output, text)
    rates = outcomes.success.mean(axis=0).tolist()
    return OutcomeTable(
        output=output,
        instances=len(coordinates),
        outside=int((~setup.area.contains(coordinates)).sum()),
        unlike_fixed=unlike_fixed(coordinates, setup.area),
        success_rates={d.name: rate for d, rate in zip(learned, rates, strict=True)},
        solved=float(outcomes.any_success.mean()),
        arms=_shares(setup, outcomes),
        collisions=(
            count_collisions(outcomes, setup.workcell) if scenario.planner.collision else None
        ),
        seconds=seconds,
        planned_only=scenario.coverage.success == "execution",
    )


def _turns(
    setup: Setup, demonstrations: Sequence[Demonstration], X_WO: Array, outcomes: Outcomes
) -> dict[str, Array]:
    """Columns (N,) for each demonstration and each symmetric body that it turns, rad."""
    names = [*(o.name for o in setup.area.objects), TOOL]
    columns: dict[str, Array] = {}
    for d, demonstration in enumerate(demonstrations):
        for one in setup.arms:
            own = outcomes.arm[:, d] == one.number
            variant = outcomes.variant[own, d]
            angles = one.symmetries.angles(demonstration, X_WO[own], variant)
            for body in one.symmetries.bodies(demonstration):
                turned = np.remainder(angles[:, body] + np.pi, 2.0 * np.pi) - np.pi
                name = f"{demonstration.name}:{names[body]}"
                columns.setdefault(name, np.zeros(len(X_WO)))[own] = turned
    return columns


def _arms(
    setup: Setup, demonstrations: Sequence[Demonstration], outcomes: Outcomes
) -> dict[str, list[str]]:
    """Columns (N,) for each demonstration: the arm that its outcomes are of, where several are."""
    if not setup.arms[0].among_several:
        return {}
    names = np.array([one.name for one in setup.arms])
    return {
        f"{demonstration.name}:arm": names[outcomes.arm[:, d]].tolist()
        for d, demonstration in enumerate(demonstrations)
    }


def _shares(setup: Setup, outcomes: Outcomes) -> dict[str, float]:
    """The share of instances that each of several arms solves, the first that can."""
    solved = np.where(outcomes.success, outcomes.arm, len(setup.arms)).min(axis=1)
    return {
        one.name: float((solved == one.number).mean()) for one in setup.arms if one.among_several
    }


def _touching(
    setup: Setup, demonstrations: Sequence[Demonstration], X_WO: Array, outcomes: Outcomes
) -> dict[str, list[str]]:
    """Columns (N,) for demonstrations that collide: which bodies touch, "" where none do."""
    columns = {}
    for d, demonstration in enumerate(demonstrations):
        column = [""] * len(X_WO)
        for i in np.flatnonzero(outcomes.cause[:, d] == Cause.COLLISION).tolist():
            bodies = _bodies(setup, demonstration, X_WO[i], outcomes[i, d])
            column[i] = pair_name(bodies[0]) if bodies else ""
        if any(column):
            columns[f"{demonstration.name}:touches"] = column
    return columns


def _bodies(
    setup: Setup, demonstration: Demonstration, X_WO: Array, outcome: Outcomes
) -> tuple[Pair, ...]:
    """What touches, of an outcome of shape (); planned again where it does not say that."""
    known = known_pair(outcome, setup.workcell)
    if known is not None:
        return (known,)
    plan = cut_short(setup.judged_plan(demonstration, X_WO, outcome), outcome)
    clearance = setup.scenario.planner.clearance
    return touching_bodies(outcome, setup.arm_of(outcome).workcell, plan.q[-1], X_WO, clearance)
