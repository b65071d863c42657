"""The columns of a table of outcomes: where an instance is, and what became of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Cause, Outcomes
from drake_screw.planning.symmetry import TOOL
from drake_screw.planning.touching import Pair, cut_short, pair_name, touching_bodies
from drake_screw.runs.outcome_files import Column
from drake_screw.tasks import column_name
from drake_screw.typing import Array

COORDINATE, TURN = ".9g", ".4f"


def outcome_columns(
    setup: Setup,
    demonstrations: Sequence[Demonstration],
    coordinates: Array,
    told: Sequence[tuple[int, int]],
    outcomes: Outcomes,
) -> tuple[Column, ...]:
    """The columns of some instances, the same for all blocks of a table.

    Args:
        setup: of the scenario.
        demonstrations: D of them.
        coordinates: (N, k, c) m and rad.
        told: object and axis of the coordinates that have a column.
        outcomes: (N, D).

    Returns:
        The coordinates; the code of each demonstration, as of ``Outcomes.codes``; a column
        ``demonstration:body`` in rad for each body that a demonstration may turn; a column
        ``demonstration:arm`` for the arm that an outcome is of where there are several; and a
        column ``demonstration:touches`` with the bodies, "left_hand-bowl", which is dispensable.
    """
    X_WO = setup.area.X_WO(coordinates)
    return (
        *_coordinates(setup, coordinates, told),
        *_codes(demonstrations, outcomes),
        *_turns(setup, demonstrations, X_WO, outcomes),
        *_arms(setup, demonstrations, outcomes),
        *_touching(setup, demonstrations, X_WO, outcomes),
    )


def _coordinates(
    setup: Setup, coordinates: Array, told: Sequence[tuple[int, int]]
) -> Iterator[Column]:
    for i, j in told:
        name = column_name(setup.area, i, setup.area.axes[j])
        yield Column(name, coordinates[:, i, j], COORDINATE)


def _codes(demonstrations: Sequence[Demonstration], outcomes: Outcomes) -> Iterator[Column]:
    codes = outcomes.codes()
    for d, demonstration in enumerate(demonstrations):
        yield Column(demonstration.name, codes[:, d])


def _turns(
    setup: Setup, demonstrations: Sequence[Demonstration], X_WO: Array, outcomes: Outcomes
) -> Iterator[Column]:
    """For each demonstration and each symmetric body that it turns."""
    names = [*(o.name for o in setup.area.objects), TOOL]
    for d, demonstration in enumerate(demonstrations):
        turned: dict[str, Array] = {}
        for one in setup.arms:
            own = outcomes.arm[:, d] == one.number
            variant = outcomes.variant[own, d]
            angles = one.symmetries.angles(demonstration, X_WO[own], variant)
            for body in one.symmetries.bodies(demonstration):
                angle = np.remainder(angles[:, body] + np.pi, 2.0 * np.pi) - np.pi
                turned.setdefault(names[body], np.zeros(len(X_WO)))[own] = angle
        for name, values in turned.items():
            yield Column(f"{demonstration.name}:{name}", values, TURN)


def _arms(
    setup: Setup, demonstrations: Sequence[Demonstration], outcomes: Outcomes
) -> Iterator[Column]:
    if not setup.arms[0].among_several:
        return
    names = np.array([one.name for one in setup.arms])
    for d, demonstration in enumerate(demonstrations):
        yield Column(f"{demonstration.name}:arm", names[outcomes.arm[:, d]])


def _touching(
    setup: Setup, demonstrations: Sequence[Demonstration], X_WO: Array, outcomes: Outcomes
) -> Iterator[Column]:
    """Which bodies touch, "" where none do; none where collisions are not looked at."""
    if not setup.scenario.planner.collision:
        return
    pairs = setup.workcell.pairs
    known = np.array([*(pair_name(setup.workcell.touching(i)) for i in range(len(pairs))), ""])
    for d, demonstration in enumerate(demonstrations):
        collides = outcomes.cause[:, d] == Cause.COLLISION
        pair = outcomes.pair[:, d]
        said = collides & (pair >= 0) & (pair < len(pairs))
        names = known[np.where(said, pair, len(pairs))].astype(object)
        for i in np.flatnonzero(collides & ~said).tolist():
            bodies = _bodies(setup, demonstration, X_WO[i], outcomes[i, d])
            names[i] = pair_name(bodies[0]) if bodies else ""
        yield Column(f"{demonstration.name}:touches", names, dispensable=True)


def _bodies(
    setup: Setup, demonstration: Demonstration, X_WO: Array, outcome: Outcomes
) -> tuple[Pair, ...]:
    """What touches, of an outcome of shape () that does not say so: it is planned again."""
    plan = cut_short(setup.judged_plan(demonstration, X_WO, outcome), outcome)
    clearance = setup.scenario.planner.clearance
    return touching_bodies(outcome, setup.arm_of(outcome).workcell, plan.q[-1], X_WO, clearance)
