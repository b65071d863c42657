"""The station in which a scenario's plans are executed, and whether it can be simulated."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.errors import ModelError, ScenarioError
from drake_screw.execution.allowed import Allowed
from drake_screw.execution.motors import immovable
from drake_screw.execution.parallel import StationConfig
from drake_screw.robot import RobotConfig, Workcell
from drake_screw.tasks import ObjectArea, WorkArea, anywhere
from drake_screw.typing import Array

if TYPE_CHECKING:
    from drake_screw.assembly.planning_setup import PlanningSetup

DRAWN = 8
"""Places at which objects are set down to see whether they stay anywhere."""


def station_config(
    setup: PlanningSetup, robot: RobotConfig | None = None, *, free_objects: bool = False
) -> StationConfig:
    """What a process needs to build the station of a scenario.

    Args:
        setup: of the scenario.
        robot: with the arm that moves; the first one if None.
        free_objects: objects can be pushed; else they are locked in place.
    """
    block = setup.scenario.execution
    allowed = Allowed(
        position=block.position,
        rotation=block.rotation,
        displacement=block.displacement,
        turn=block.turn,
        contact_force=block.contact_force,
    )
    return StationConfig(
        robot or setup.robot,
        setup.table,
        setup.objects,
        setup.obstacles,
        free_objects=free_objects,
        allowed=allowed,
        model=setup.workcell.model.hash,
    )


def check_masses(workcell: Workcell) -> None:
    """Raises ModelError if a joint moves nothing that has inertia."""
    positions = workcell.arm.full_positions(workcell.start)
    found = immovable(workcell.plant, workcell.robot, positions)
    if found is not None:
        joint, links = found
        named = (
            f"its links {', '.join(links)} have no mass" if links else "none has any about its axis"
        )
        raise ModelError(
            f"joint '{joint}' cannot be driven: what it moves has no inertia; {named}",
            remedy="Give the links an <inertial> with mass and inertia; planning does without.",
            file=workcell.model_file,
        )


def check_standing(
    setup: PlanningSetup, config: StationConfig, coordinates: ArrayLike | None = None
) -> None:
    """Check that objects that are set down stay there.

    Args:
        setup: of the scenario.
        config: of its station, with free objects.
        coordinates: (k, c) where; somewhere in the work area if None: in its middle, or else at one
            of a few places drawn in it. Where the middle says nothing of the rest, since heights or
            tilts vary or objects overlap there, they are just those that are drawn.

    Raises:
        ScenarioError: an object does not stay at any of these places.
    """
    area, station, first = setup.area, config.build(), ""
    places = _somewhere(area) if coordinates is None else np.asarray(coordinates, dtype=float)[None]
    for X_WO in area.X_WO(places):
        _, unrest = station.settled(setup.workcell.start, X_WO)
        if not unrest:
            return
        first = first or unrest
    on = "there is no table" if setup.table is None else f"the table's top is at {setup.table.top}"
    raise ScenarioError(
        f"an object that is free to move has to stand on something, and {first}",
        remedy=f"Heights (objects: z) are: {', '.join(map(_height, area.objects))}; {on}.",
        file=setup.scenario.source,
    )


def _somewhere(area: WorkArea) -> Array:
    """Places (N, k, c) in a work area, of which objects rest at one if they do as a rule."""
    drawn = anywhere(area, np.random.default_rng(0), DRAWN)
    middle = area.middle
    if any(item.beyond_planar for item in area.objects) or area.overlaps(middle):
        return drawn
    return np.concatenate([middle[None], drawn])


def _height(item: ObjectArea) -> str:
    height = f"{item.z:g}" if not isinstance(item.z, tuple) else f"{item.z[0]:g} to {item.z[1]:g}"
    on = "" if item.on is None else f" on {item.on}"
    turned = "" if item.upright else ", tilted"
    return f"{item.name} {height}{on}{turned}"
