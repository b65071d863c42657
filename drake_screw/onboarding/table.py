"""How high the table is, and where it stands."""

from __future__ import annotations

import itertools

import numpy as np
from pydrake.geometry import Convex, GeometryId, Mesh, SceneGraphInspector

from drake_screw.onboarding.arms import FoundArm
from drake_screw.onboarding.hand_ik import Range
from drake_screw.onboarding.reach import HOLDS, reach_map
from drake_screw.onboarding.reading import Robot
from drake_screw.onboarding.rectangles import Rectangle
from drake_screw.robot import ScrewChain, TableConfig
from drake_screw.robot.names import find_frame
from drake_screw.robot.shapes import vertices
from drake_screw.typing import Array

LOW_SHOULDER = 0.6
"""m. An arm whose shoulder is no higher above its base is taken to stand on the table."""

BELOW = 0.05
"""m, that an arm on a table may reach down behind the table's top."""

UNDER_THE_SHOULDER = (0.55, 0.45, 0.35, 0.25)
"""m, heights of a table in front of a robot that are tried."""

USUAL = 0.40
"""m, of these the one that is preferred by a little."""

ROUNDED = 0.05
"""m"""

BEHIND, BESIDE, BEYOND, IN_FRONT = 0.2, 0.15, 0.15, 0.14
"""m, that a table goes on behind the base, beside, beyond and before the work area."""

THICKNESS = 0.04


def stands_on_the_table(robot: Robot, arm: FoundArm, others: int, chain: ScrewChain) -> bool:
    """Whether a robot is an arm alone on its foot, and not a body on wheels or on a pedestal."""
    plant, inspector = robot.plant, robot.diagram.scene_graph().model_inspector()
    base = find_frame(plant, arm.base).body()
    context = plant.CreateDefaultContext()
    X_WF = base.EvalPoseInWorld(context).inverse()
    lowest = 0.0
    for body in plant.GetBodiesWeldedTo(base):
        if body.index() == plant.world_body().index():
            continue
        X_FB = X_WF @ body.EvalPoseInWorld(context)
        shapes = plant.GetCollisionGeometriesForBody(body) or (
            plant.GetVisualGeometriesForBody(body)
        )
        for shape in shapes:
            corners = _corners(inspector, shape)
            X_FS = X_FB @ inspector.GetPoseInFrame(shape)
            lowest = min(lowest, float((X_FS @ corners.T)[2].min(initial=0.0)))
    alone = others == 0 and not arm.held
    return alone and chain.shoulder[2] <= LOW_SHOULDER and lowest >= -BELOW


def _corners(inspector: SceneGraphInspector, shape: GeometryId) -> Array:
    """(m, 3) m, points whose hull holds a shape, in its own frame."""
    solid = inspector.GetShape(shape)
    if isinstance(solid, Mesh | Convex):
        return vertices(solid.GetConvexHull())
    box = inspector.GetObbInGeometryFrame(shape)
    if box is None:
        return np.zeros((0, 3))
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    return np.asarray((box.pose() @ (signs * box.half_width()).T).T)


def best_heights(chain: ScrewChain, within: Range, task: str) -> list[float]:
    """m, heights below the shoulder, first that at which most of a table can be reached."""
    shoulder, R = chain.shoulder, chain.reach
    x = shoulder[0] + np.linspace(0.35, 0.9, 7) * R
    y = shoulder[1] + np.linspace(-0.6, 0.6, 9) * R
    scores = {}
    for under in UNDER_THE_SHOULDER:
        z = float(np.round((shoulder[2] - under) / ROUNDED) * ROUNDED)
        found = reach_map(chain, within, x, y, z, HOLDS[task], aside=(0.0,))
        scores[z] = float(found.share.mean()) - 0.2 * abs(under - USUAL)
    return sorted(scores, key=lambda z: -scores[z])


def table_under(area: Rectangle, top: float, *, around_the_base: bool) -> TableConfig:
    """A table under a work area, and under the base where the robot stands on it."""
    x0 = min(-BEHIND, area.x[0] - IN_FRONT) if around_the_base else area.x[0] - IN_FRONT
    x1, y0, y1 = area.x[1] + BEYOND, area.y[0] - BESIDE, area.y[1] + BESIDE
    if around_the_base:
        y0, y1 = min(y0, -0.3), max(y1, 0.3)
    middle = round((x0 + x1) / 2.0, 3), round((y0 + y1) / 2.0, 3)
    return TableConfig(middle, (round(x1 - x0, 3), round(y1 - y0, 3)), top, THICKNESS)
