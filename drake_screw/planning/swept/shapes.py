"""A workcell's collision shapes, read from Drake's scene graph into a `Cell`."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import GeometryId, Role
from pydrake.multibody.tree import BodyIndex, RigidBody

from drake_screw.errors import ModelError
from drake_screw.planning.swept.cell import Cell
from drake_screw.planning.swept.cores import Core, core_of, together
from drake_screw.planning.swept.never_meet import never_meet
from drake_screw.robot import Workcell
from drake_screw.typing import Array

FEW = 4
"""Fixed shapes near one another that are looked at as one, at most."""


def cell_of(workcell: Workcell, clearance: float = 0.0) -> tuple[Cell, Array]:
    """All collision shapes of a workcell, and which of them could touch.

    Args:
        workcell: robot, table and objects.
        clearance: m, that they have to be apart.

    Returns:
        The cell; of each of its pairs, those that stand last, which of `Workcell.pairs` it is of.

    Raises:
        ModelError: a collision shape is of a kind that is not known here.
    """
    plant, arm = workcell.plant, workcell.arm
    inspector = workcell.scene_graph.model_inspector()
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, arm.full_positions(np.zeros(arm.n)))
    last = {}
    for i, name in enumerate(arm.joint_names):
        for body in plant.GetBodiesKinematicallyAffectedBy([plant.GetJointByName(name).index()]):
            last[body] = i
    object_of = {body.index(): i for i, body in enumerate(workcell.objects)}
    cores, X_WG, joint, objects, bodies, ids = [], [], [], [], [], []

    def body_of(geometry: GeometryId) -> RigidBody:
        return plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))

    geometries = inspector.GetAllGeometryIds(Role.kProximity)
    for geometry in sorted(geometries, key=lambda one: last.get(body_of(one).index(), -1)):
        shape, body = inspector.GetShape(geometry), body_of(geometry)
        core = core_of(shape)
        if core is None:
            raise ModelError(
                f"link '{body.name()}' has a collision shape of a kind that is not supported: "
                f"{shape}",
                remedy="Give it spheres, capsules, cylinders, boxes, ellipsoids or meshes.",
            )
        index = body.index()
        X_RB = np.eye(4) if index in object_of else body.EvalPoseInWorld(context).GetAsMatrix4()
        X_RG = X_RB @ inspector.GetPoseInFrame(geometry).GetAsMatrix4()
        X_RG[:3, 3] += X_RG[:3, :3] @ core.p
        cores.append(core)
        X_WG.append(X_RG[:3])
        joint.append(last.get(index, -1))
        objects.append(object_of.get(index, -1))
        bodies.append(index)
        ids.append(geometry)
    reach = np.array([core.reach for core in cores], dtype=float)
    balls = np.column_stack([np.array(X_WG).reshape(-1, 3, 4)[:, :, 3], reach])
    around_each = [_box_around(X, core) for X, core in zip(X_WG, cores, strict=True)]
    boxes = np.array(around_each).reshape(-1, 2, 3)
    fixed = (np.array(joint) < 0) & (np.array(objects) < 0)
    cluster = clusters(boxes, fixed)
    pairs, standing = _pairs(workcell, bodies, ids, joint, objects, balls, clearance, cluster)
    chain = arm.screw_chain()
    joints = np.array(joint, dtype=np.int64)
    moved = int((joints < 0).sum())
    ends = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    behind = joints[ends[:, 0]] + 1
    slot = behind * (len(joints) - moved) + ends[:, 1] - moved
    of = np.column_stack([ends[:, 1], behind, cluster[ends[:, 0]]])
    groups = np.flatnonzero((np.diff(of, axis=0, prepend=-2) != 0).any(axis=1))
    around = np.empty((len(groups), 2, 3))
    for i, (begin, end) in enumerate(itertools.pairwise([*groups.tolist(), len(ends)])):
        own = ends[begin:end, 0]
        around[i, 0], around[i, 1] = boxes[own, 0].min(axis=0), boxes[own, 1].max(axis=0)
        if not fixed[own].all():
            around[i] = [[-np.inf] * 3, [np.inf] * 3]
    frames = np.array(X_WG, dtype=float).reshape(-1, 3, 4)
    cell = Cell(
        np.ascontiguousarray(chain.screws, dtype=float),
        np.stack([chain.lower, chain.upper]).astype(float),
        together(cores),
        frames,
        joints,
        np.array(objects, dtype=np.int64),
        reach,
        np.array([core.box for core in cores], dtype=float).reshape(-1, 3),
        np.ascontiguousarray(frames[moved:, :, 3].T),
        joints[moved:].copy(),
        reach[moved:].copy(),
        np.searchsorted(joints[moved:], np.arange(arm.n)).astype(np.int64),
        ends,
        slot,
        np.append(groups, len(ends)).astype(np.int64),
        slot[groups],
        around,
        np.array(standing, dtype=np.int64).reshape(-1, 2),
        float(clearance),
    )
    number = {frozenset(bodies): i for i, bodies in enumerate(workcell.pairs)}
    of_bodies = [number[frozenset((bodies[a], bodies[b]))] for a, b in (*pairs, *standing)]
    return cell, np.array(of_bodies, dtype=np.int64)


def _pairs(workcell, bodies, ids, joint, objects, balls, clearance, cluster):  # type: ignore[no-untyped-def]
    """Pairs of shapes that Drake would look at, by their place in the lists, and standing ones."""
    checker = workcell.checker
    inspector = workcell.scene_graph.model_inspector()
    plant = workcell.plant
    robot = [checker.IsPartOfRobot(plant.get_body(body)) for body in bodies]
    pairs, standing = [], []
    apart: dict[tuple[BodyIndex, BodyIndex], bool] = {}

    def strangers(a: int, b: int) -> bool:
        key = bodies[a], bodies[b]
        if key not in apart:
            between = tuple(range(joint[a] + 1, joint[b] + 1))
            own = balls[[body == bodies[b] for body in bodies]]
            apart[key] = never_meet(workcell, *key, between, own, clearance)
        return apart[key]

    for a in range(len(bodies)):
        for b in range(len(bodies)):
            if joint[a] > joint[b] or (joint[a] == joint[b] and (joint[a] >= 0 or a >= b)):
                continue
            if bodies[a] == bodies[b] or not (robot[a] or robot[b]):
                continue
            if checker.IsCollisionFilteredBetween(bodies[a], bodies[b]):
                continue
            if inspector.CollisionFiltered(ids[a], ids[b]):
                continue
            if joint[b] >= 0:
                if objects[a] < 0 and strangers(a, b):
                    continue
                pairs.append((a, b))
            elif objects[a] >= 0 or objects[b] >= 0:
                standing.append((a, b))
    pairs.sort(key=lambda pair: (pair[1], joint[pair[0]], cluster[pair[0]], pair[0]))
    return pairs, standing


def _box_around(X_WG: Array, core: Core) -> Array:
    """(2, 3) m, lower and upper corner of a box in W around a core at X_WG (3, 4)."""
    half = np.abs(X_WG[:, :3]) @ core.box
    return np.stack([X_WG[:, 3] - half, X_WG[:, 3] + half])


def clusters(boxes: Array, some: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Sorts boxes into clusters of a few that are near one another.

    Args:
        boxes: (S, 2, 3) m, their lower and upper corners.
        some: (S,) which of them.

    Returns:
        (S,) the cluster of each, from 0; -1 of the others.
    """
    cluster = np.full(len(boxes), -1)
    sets, count = [np.flatnonzero(some)], 0
    middles = boxes.mean(axis=1)
    while sets:
        own = sets.pop()
        if len(own) <= FEW:
            cluster[own] = count
            count += 1
            continue
        longest = np.argmax(np.ptp(middles[own], axis=0))
        own = own[np.argsort(middles[own, longest], kind="stable")]
        gap = np.argmax(np.diff(middles[own, longest])) + 1
        sets += [own[:gap], own[gap:]]
    return cluster
