"""The station in which a scenario's plans are executed, and whether it can be simulated."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drake_screw.errors import ModelError, ScenarioError
from drake_screw.execution.allowed import Allowed
from drake_screw.execution.motors import immovable
from drake_screw.execution.parallel import StationConfig
from drake_screw.robot import RobotConfig, Workcell

if TYPE_CHECKING:
    from drake_screw.assembly.planning_setup import PlanningSetup


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


def check_standing(setup: PlanningSetup, config: StationConfig) -> None:
    """Raises ScenarioError if an object, set down in the middle of its area, does not stay there.

    Args:
        setup: of the scenario.
        config: of its station, with free objects.
    """
    area = setup.area
    X_WO = area.X_WO((area.lower + area.upper) / 2.0)
    _, unrest = config.build().settled(setup.workcell.start, X_WO)
    if not unrest:
        return
    on = "there is no table" if setup.table is None else f"the table's top is at {setup.table.top}"
    heights = ", ".join(f"{o.name} {o.z:g}" for o in area.objects)
    raise ScenarioError(
        f"an object that is free to move has to stand on something, and {unrest}",
        remedy=f"Heights (objects: z) are: {heights}; {on}.",
        file=setup.scenario.source,
    )
