"""Whether the work area that a scenario describes makes sense for its arm and its workcell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from drake_screw.errors import ScenarioError
from drake_screw.robot import Arm, Workcell
from drake_screw.scenario.schema import Scenario
from drake_screw.tasks import GridRegions, WorkArea, anywhere, draw
from drake_screw.typing import Array

TOOL = 0.5
"""m. The end effector is never farther than this from the object that it works on."""
PLACES = 25
"""Along each axis of the work area, that are looked at for obstacles."""
STANDS_IN = 1e-3
"""m, that an object must be in an obstacle; one that stands on it is not."""
ROOM = 2000
"""Places in a region, at one of which objects must not overlap: where a hundredth is left of it,
they all do so less often than once in 500 million times."""
SAMPLED = 512
"""Places of what stands on something that moves, the nearest of which is looked for."""


@dataclass(frozen=True)
class Covered:
    """How much of an object's work area an obstacle takes up: there the two would overlap."""

    obstacle: str
    object: str
    share: float

    def __str__(self) -> str:
        share = "all" if self.share >= 1.0 else f"about {max(self.share, 0.01):.0%}"
        return (
            f"obstacle '{self.obstacle}' is in the place of '{self.object}' in {share} of its work "
            "area: the two would overlap there"
        )


def check_reach(scenario: Scenario, arms: Sequence[Arm], area: WorkArea) -> None:
    """Check that some of the work area can be reached by one of the arms.

    Raises:
        ScenarioError: none of an object's can.
    """
    chains = [arm.screw_chain() for arm in arms]
    away = np.stack(
        [np.linalg.norm(nearest_places(area, c.shoulder) - c.shoulder, axis=-1) for c in chains]
    )
    for i, item in enumerate(area.objects):
        nearest = int((away[:, i] - [chain.reach for chain in chains]).argmin())
        chain = chains[nearest]
        if away[nearest, i] > chain.reach + TOOL:
            raise ScenarioError(
                f"objects.{i}: the work area of '{item.name}' is out of reach: its nearest "
                f"point is {away[nearest, i]:.2f} m from the shoulder, the end effector gets "
                f"{chain.reach:.2f} m",
                remedy="Move the work area towards the robot; x, y and z are in metres, "
                f"seen from '{scenario.robot.base}'.",
                file=scenario.source,
            )


def covered_by_obstacles(workcell: Workcell, area: WorkArea) -> tuple[Covered, ...]:
    """Obstacles that objects would stand inside somewhere in the work area.

    They are looked for on a grid of places along x and y, in the middle of all else.

    Nothing comes of it by itself: only with collisions checked, and only if the arm touches
    something there, do plans fail.
    """
    plant, k = workcell.plant, len(area.objects)
    if not workcell.obstacles:
        return ()
    root = workcell.diagram.CreateDefaultContext()
    context = plant.GetMyMutableContextFromRoot(root)
    graph = workcell.scene_graph.GetMyContextFromRoot(root)
    shape = {
        body.index(): plant.GetCollisionGeometriesForBody(body)[0]
        for body in (*workcell.objects, *workcell.obstacles)
    }
    share = np.linspace(0.0, 1.0, PLACES)
    inside = np.zeros((len(workcell.obstacles), k))
    for x_share in share:
        for y_share in share:
            along = np.array([x_share, y_share, *[0.5] * (len(area.axes) - 2)])
            at = area.lower + along * (area.upper - area.lower)
            plant.SetPositions(context, workcell.positions(workcell.start, area.X_WO(at)))
            query = workcell.scene_graph.get_query_output_port().Eval(graph)
            for i, obstacle in enumerate(workcell.obstacles):
                for j, body in enumerate(workcell.objects):
                    pair = shape[obstacle.index()], shape[body.index()]
                    distance = query.ComputeSignedDistancePairClosestPoints(*pair).distance
                    inside[i, j] += distance < -STANDS_IN
    return tuple(
        Covered(obstacle.name(), area.objects[j].name, float(inside[i, j] / PLACES**2))
        for i, obstacle in enumerate(workcell.obstacles)
        for j in range(k)
        if inside[i, j]
    )


def nearest_places(area: WorkArea, p_WS: Array) -> Array:
    """Where each object is nearest to a point; of what stands on another, of places drawn.

    Args:
        area: the work area.
        p_WS: (3,) m.

    Returns:
        (k, 3) m.
    """
    drawn = anywhere(replace(area, overlap=None), np.random.default_rng(0), SAMPLED)
    p_WO = area.X_WO(drawn)[..., :3, 3]
    away = np.linalg.norm(p_WO - p_WS, axis=-1)
    nearest = p_WO[away.argmin(axis=0), np.arange(len(area.objects))]
    for i, item in enumerate(area.objects):
        if item.on is None:
            xyz = [0, 1, 3]
            nearest[i] = np.clip(p_WS, np.take(item.least, xyz), np.take(item.greatest, xyz))
    return nearest


def check_room(scenario: Scenario, regions: GridRegions) -> None:
    """Check that every region has room for objects that must not overlap.

    Raises:
        ScenarioError: one has next to none.
    """
    if regions.area.overlap is None:
        return
    first = {"seed": scenario.seed, "round": 0, "start": 0, "count": 1}
    try:
        for region in range(regions.K):
            draw(regions, region, **first, most=ROOM)
    except ScenarioError as error:
        raise ScenarioError(error.message, remedy=error.remedy, file=scenario.source) from error
