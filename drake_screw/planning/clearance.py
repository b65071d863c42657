"""A lower bound on an arm's distance to all else, for many configurations at once.

The arm's collision shapes are covered by spheres, everything that it does not move by boxes. A
sphere with distance d at one configuration and d' at the next touches nothing in between unless its
centre travels d + d' or more, which is what makes most of a path cheap to clear; the rest is asked
of Drake.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numba as nb
import numpy as np
from pydrake.geometry import Box, Capsule, Cylinder, Ellipsoid, Role, Shape, Sphere
from pydrake.multibody.tree import BodyIndex

from drake_screw.robot import ScrewChain, Workcell
from drake_screw.screws import inverse
from drake_screw.typing import Array

CELL = 0.1  # rad (or m), of the grid on which neighbouring links are looked at
REACH = 0.15  # m, that a shape may extend from the points that stand for it

MANY = 250  # configurations that are worth a thread

SLENDER = 0.7
"""Half length of a piece of a shape, over its cross-section's radius, that one sphere covers."""


@dataclass(frozen=True, eq=False)
class Bubbles:
    """Spheres around an arm, boxes around the rest.

    Attributes:
        chain: the arm.
        centers: (S, 3) p_WS of the spheres at q = 0, m.
        radii: (S,) m.
        joint: (S,) the last joint before the sphere's body, from 0.
        X_BW: (B, 4, 4) the boxes' frames, and for a box of an object `objects` >= 0.
        sizes: (B, 3) half extents of the boxes, m.
        objects: (B,) the object that the box belongs to, seen from whose frame X_BW then is; -1.
        facing: (S, B) whether sphere and box could collide.
        pairs: (P, 2) spheres that could collide with one another.
    """

    chain: ScrewChain
    centers: Array
    radii: Array
    joint: Array
    X_BW: Array
    sizes: Array
    objects: Array
    facing: Array
    pairs: Array

    def __call__(self, q: Array, X_WO: Array) -> tuple[Array, Array]:
        """Bounds of every sphere.

        Args:
            q: (m, n).
            X_WO: (m, k, 4, 4).

        Returns:
            distance (m, S) of each sphere to all that it could touch, at most, in m, and the
            spheres' centres p_WS (m, S, 3).
        """
        E = self.chain.motions(q)[self.joint]
        p = (E[..., :3, :3] @ self.centers[:, None, :, None])[..., 0] + E[..., :3, 3]
        p = np.ascontiguousarray(np.moveaxis(p, 0, 1))
        distance = np.empty(p.shape[:2])
        threads = nb.get_num_threads()
        nb.set_num_threads(min(threads, 1 + len(p) // MANY))
        try:
            _bounds(
                p, self.radii, self.X_BW, self.sizes, self.objects, self.facing, self.pairs,
                np.ascontiguousarray(inverse(X_WO)), distance,
            )  # fmt: skip
        finally:
            nb.set_num_threads(threads)
        return distance, p


@nb.njit(parallel=True, cache=True)
def _bounds(
    p: Array,
    radii: Array,
    X_BW: Array,
    sizes: Array,
    objects: Array,
    facing: Array,
    pairs: Array,
    X_OW: Array,
    distance: Array,
) -> None:
    """Fill `distance` (m, S); the rest as in `Bubbles`."""
    for i in nb.prange(len(p)):
        for s in range(len(radii)):
            distance[i, s] = np.inf
        for b in range(len(sizes)):
            X = X_BW[b]
            if objects[b] >= 0:
                X = X_BW[b] @ X_OW[i, objects[b]]
            for s in range(len(radii)):
                if not facing[s, b]:
                    continue
                square = 0.0
                for k in range(3):
                    x = X[k, 0] * p[i, s, 0] + X[k, 1] * p[i, s, 1] + X[k, 2] * p[i, s, 2]
                    out = abs(x + X[k, 3]) - sizes[b, k]
                    if out > 0.0:
                        square += out * out
                distance[i, s] = min(distance[i, s], np.sqrt(square) - radii[s])
        for j in range(len(pairs)):
            a, b = pairs[j]
            square = 0.0
            for k in range(3):
                square += (p[i, a, k] - p[i, b, k]) ** 2
            half = 0.5 * (np.sqrt(square) - radii[a] - radii[b])
            distance[i, a] = min(distance[i, a], half)
            distance[i, b] = min(distance[i, b], half)


def bubbles_of(workcell: Workcell) -> Bubbles:
    """Cover a workcell's collision shapes.

    Shapes without an extent known here (meshes, half spaces) are taken as boundless: whatever
    could touch them is never cleared by these bounds.
    """
    plant, arm, checker = workcell.plant, workcell.arm, workcell.checker
    inspector = workcell.scene_graph.model_inspector()
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, arm.full_positions(np.zeros(arm.n)))
    last = {}
    for i, name in enumerate(arm.joint_names):
        for body in plant.GetBodiesKinematicallyAffectedBy([plant.GetJointByName(name).index()]):
            last[body] = i
    object_of = {body.index(): i for i, body in enumerate(workcell.objects)}

    centers, radii, joint, sphere_body = [], [], [], []
    X_BW, sizes, objects, box_body = [], [], [], []
    for geometry in inspector.GetAllGeometryIds(Role.kProximity):
        body = plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
        index = body.index()
        half = half_extents(inspector.GetShape(geometry))
        X_BG = inspector.GetPoseInFrame(geometry).GetAsMatrix4()
        if index in last:
            X_WG = body.EvalPoseInWorld(context).GetAsMatrix4() @ X_BG
            p_GS, radius = covering(inspector.GetShape(geometry))
            centers.append(p_GS @ X_WG[:3, :3].T + X_WG[:3, 3])
            radii += [radius] * len(p_GS)
            joint += [last[index]] * len(p_GS)
            sphere_body += [index] * len(p_GS)
        else:
            free = index in object_of
            X_RB = np.eye(4) if free else body.EvalPoseInWorld(context).GetAsMatrix4()
            X_BW.append(inverse(X_RB @ X_BG))
            sizes.append(half)
            objects.append(object_of.get(index, -1))
            box_body.append(index)
    filtered = {
        (a, b): checker.IsCollisionFilteredBetween(a, b)
        for a in set(sphere_body)
        for b in {*sphere_body, *box_body}
    }
    facing = np.array([[not filtered[a, b] for b in box_body] for a in sphere_body], dtype=bool)
    p_WS = np.concatenate(centers) if centers else np.empty((0, 3))
    on = {body: p_WS[np.array(sphere_body) == body] for body in last}
    strangers = {
        (a, b)
        for a in set(sphere_body)
        for b in set(sphere_body)
        if last[a] < last[b] and (filtered[a, b] or _never_meet(workcell, a, b, last, on[b]))
    }
    pairs = [
        (i, j)
        for i in range(len(radii))
        for j in range(len(radii))
        if joint[i] < joint[j] and (sphere_body[i], sphere_body[j]) not in strangers
    ]
    return Bubbles(
        arm.screw_chain(),
        p_WS,
        np.array(radii),
        np.array(joint, dtype=int),
        np.array(X_BW).reshape(-1, 4, 4),
        np.array(sizes).reshape(-1, 3),
        np.array(objects, dtype=int),
        facing.reshape(len(radii), len(sizes)),
        np.array(pairs, dtype=int).reshape(-1, 2),
    )


def half_extents(shape: Shape) -> Array:
    """Half the size (3,) in m of a shape's bounding box in its own frame; infinite if unknown."""
    match shape:
        case Box():
            return np.asarray(shape.size()) / 2.0
        case Sphere():
            return np.full(3, shape.radius())
        case Cylinder():
            return np.array([shape.radius(), shape.radius(), shape.length() / 2.0])
        case Capsule():
            tip = shape.length() / 2.0 + shape.radius()
            return np.array([shape.radius(), shape.radius(), tip])
        case Ellipsoid():
            return np.array([shape.a(), shape.b(), shape.c()])
        case _:
            return np.full(3, np.inf)


def covering(shape: Shape) -> tuple[Array, float]:
    """Centres (c, 3) in a shape's frame and the radius of spheres that together cover it."""
    half = half_extents(shape)
    if not np.isfinite(half).all():
        return np.zeros((1, 3)), np.inf
    long = 2 if isinstance(shape, Cylinder | Capsule) else int(np.argmax(half))
    across = np.delete(half, long)
    thick = float(np.linalg.norm(across) if isinstance(shape, Box) else across.max())
    if isinstance(shape, Capsule):
        # A capsule is a sphere swept along its axis: the end spheres cover its caps.
        straight = half[long] - thick
        gaps = max(1, int(np.ceil(straight / (SLENDER * thick))))
        places, piece = np.linspace(-straight, straight, gaps + 1), straight / gaps
    else:
        count = max(1, int(np.ceil(half[long] / (SLENDER * thick))))
        piece = half[long] / count
        places = piece * (2.0 * np.arange(count) - count + 1.0)
    centers = np.zeros((len(places), 3))
    centers[:, long] = places
    return centers, float(np.hypot(thick, piece))


def _never_meet(
    workcell: Workcell,
    a: BodyIndex,
    b: BodyIndex,
    last: Mapping[BodyIndex, int],
    p_WS: Array,
) -> bool:
    """Whether two links stay apart whatever the one or two joints between them do.

    Their distance is looked at on a grid; it cannot fall to zero in between if it is more than the
    farthest point of b travels in half a cell.

    Args:
        workcell: of the arm.
        a, b: bodies of the arm, a before b.
        last: the last joint before each body.
        p_WS: (c, 3) m, points that b's shapes are near, at q = 0.
    """
    between = np.arange(last[a] + 1, last[b] + 1)
    if len(between) > 2:
        return False
    arm, plant, scene_graph = workcell.arm, workcell.plant, workcell.scene_graph
    axes = [
        np.linspace(lower, upper, 2 + int((upper - lower) / CELL))
        for lower, upper in zip(arm.lower[between], arm.upper[between], strict=True)
    ]
    q = np.tile((arm.lower + arm.upper) / 2.0, (int(np.prod([len(x) for x in axes])), 1))
    q[:, between] = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(len(q), -1)
    chain = arm.screw_chain()
    E, J = chain.motions(q)[last[b]], chain.jacobian(q)[:, :, between]
    p = np.einsum("mij,cj->mci", E[:, :3, :3], p_WS) + E[:, None, :3, 3]
    w, v = J[:, None, :3], J[:, None, 3:]
    speed = np.linalg.norm(np.cross(w, p[..., None], axis=2) + v, axis=2) + REACH
    travel = (CELL / 2.0 * speed.sum(axis=-1)).max(axis=-1, initial=0.0)

    root = workcell.diagram.CreateDefaultContext()
    context = plant.GetMyMutableContextFromRoot(root)
    query = scene_graph.get_query_output_port()
    shapes = [plant.GetCollisionGeometriesForBody(plant.get_body(body)) for body in (a, b)]
    for row, needed in zip(arm.full_positions(q), travel, strict=True):
        plant.SetPositions(context, row)
        here = query.Eval(scene_graph.GetMyContextFromRoot(root))
        for one in shapes[0]:
            for other in shapes[1]:
                if here.ComputeSignedDistancePairClosestPoints(one, other).distance <= needed:
                    return False
    return True
