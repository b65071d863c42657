"""What the work area must agree with: the reach of the arms, and what stands around."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drake_screw.errors import ScenarioError
from drake_screw.robot import Arm, ScrewChain, Workcell
from drake_screw.scenario.schema import Scenario
from drake_screw.tasks import ObjectArea, WorkArea

TOOL = 0.5
"""m. The end effector is never farther than this from the object that it works on."""
PLACES = 25
"""Along each axis of the work area, that are looked at for obstacles."""
STANDS_IN = 1e-3
"""m, that an object must be in an obstacle; one that stands on it is not."""


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
    for i, item in enumerate(area.objects):

        def away_from(chain: ScrewChain, item: ObjectArea = item) -> float:
            nearest = np.clip(chain.shoulder[:2], item.lower[:2], item.upper[:2])
            return float(np.linalg.norm(np.append(nearest, item.z) - chain.shoulder))

        chain = min(chains, key=lambda chain: away_from(chain) - chain.reach)
        away = away_from(chain)
        if away > chain.reach + TOOL:
            raise ScenarioError(
                f"objects.{i}: the work area of '{item.name}' is out of reach: its nearest "
                f"point is {away:.2f} m from the shoulder, the end effector gets "
                f"{chain.reach:.2f} m",
                remedy="Move the work area towards the robot; x, y and z are in metres, "
                f"seen from '{scenario.robot.base}'.",
                file=scenario.source,
            )


def covered_by_obstacles(workcell: Workcell, area: WorkArea) -> tuple[Covered, ...]:
    """Obstacles that objects would stand inside somewhere in the work area, on a grid of places.

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
            at = area.lower + np.array([x_share, y_share, 0.5]) * (area.upper - area.lower)
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
