"""Links that cannot touch, whatever the joints between them do: they need not be looked at."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.tree import BodyIndex

from drake_screw.robot import Workcell
from drake_screw.typing import Array

CELL = 0.1
"""rad (or m), of the grid on which neighbouring links are looked at."""

MOST = 2
"""Joints between two links at most; of more, the grid would be too large."""


def never_meet(
    workcell: Workcell,
    a: BodyIndex,
    b: BodyIndex,
    between: tuple[int, ...],
    farthest: Array,
    clearance: float,
) -> bool:
    """Whether two links of an arm stay apart within the joint limits.

    Their distance is looked at on a grid of the joints between them. It cannot fall below what is
    asked for in between if it is more than the farthest point of b travels in half a cell.

    Args:
        workcell: of the arm.
        a, b: bodies; b is moved by more joints.
        between: the joints that move b and not a, from 0.
        farthest: (c, 4) for balls that together hold b's shapes: p_WC at q = 0 and radius, m.
        clearance: m, that they have to be apart.
    """
    if len(between) > MOST:
        return False
    arm, plant, scene_graph = workcell.arm, workcell.plant, workcell.scene_graph
    joints = list(between)
    axes = [
        np.linspace(lower, upper, 2 + int((upper - lower) / CELL))
        for lower, upper in zip(arm.lower[joints], arm.upper[joints], strict=True)
    ]
    count = int(np.prod([len(axis) for axis in axes]))
    q = np.tile((arm.lower + arm.upper) / 2.0, (count, 1))
    q[:, joints] = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(count, -1)
    chain = arm.screw_chain()
    E, J = chain.motions(q)[joints[-1]], chain.jacobian(q)[:, :, joints]
    p = np.einsum("mij,cj->mci", E[:, :3, :3], farthest[:, :3]) + E[:, None, :3, 3]
    w, v = J[:, None, :3], J[:, None, 3:]
    speed = np.linalg.norm(np.cross(w, p[..., None], axis=2) + v, axis=2)
    speed += farthest[:, 3:] * (np.linalg.norm(w, axis=2) > 0.5)
    travel = (CELL / 2.0 * speed.sum(axis=-1)).max(axis=-1, initial=0.0)

    root = workcell.diagram.CreateDefaultContext()
    context = plant.GetMyMutableContextFromRoot(root)
    query = scene_graph.get_query_output_port()
    shapes = [plant.GetCollisionGeometriesForBody(plant.get_body(body)) for body in (a, b)]
    for row, needed in zip(arm.full_positions(q), travel + clearance, strict=True):
        plant.SetPositions(context, row)
        here = query.Eval(scene_graph.GetMyContextFromRoot(root))
        for one in shapes[0]:
            for other in shapes[1]:
                if here.ComputeSignedDistancePairClosestPoints(one, other).distance <= needed:
                    return False
    return True
