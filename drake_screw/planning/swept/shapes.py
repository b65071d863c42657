"""A workcell's collision shapes, read from Drake's scene graph into a `Cell`."""

from __future__ import annotations

import itertools
from collections.abc import Container, Sequence

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

Pair = tuple[int, int]
"""Two shapes, by their place among all."""

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
        ModelError: a collision shape is of a kind that is not known here, or a flat mesh.
    """
    plant, arm = workcell.plant, workcell.arm
    inspector = workcell.scene_graph.model_inspector()
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, arm.full_positions(np.zeros(arm.n)))
    last = {}
    for i, arm_joint in enumerate(arm.joints):
        for body in plant.GetBodiesKinematicallyAffectedBy([arm_joint.index()]):
            last[body] = i
    object_of = {body.index(): i for i, body in enumerate(workcell.objects)}
    cores, X_WG, joint, objects, bodies, ids = [], [], [], [], [], []

    def body_of(geometry: GeometryId) -> RigidBody:
        return plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))

    geometries = inspector.GetAllGeometryIds(Role.kProximity)
    for geometry in sorted(geometries, key=lambda one: last.get(body_of(one).index(), -1)):
        shape, body = inspector.GetShape(geometry), body_of(geometry)
        try:
            core = core_of(shape)
        except ValueError as error:
            raise ModelError(
                f"this mesh is flat, and a collision shape of '{workcell.name(body.index())}'",
                remedy="Give it some thickness, or take a thin box in its place.",
                file=shape.source().path(),
            ) from error
        if core is None:
            raise ModelError(
                f"link '{workcell.name(body.index())}' has a collision shape of a kind that is "
                f"not supported: {shape}",
                remedy="Give it spheres, capsules, cylinders, boxes, ellipsoids or meshes.",
                file=workcell.model_file,
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
    frames = np.array(X_WG, dtype=float).reshape(-1, 3, 4)
    joints, chain = np.array(joint, dtype=np.int64), arm.screw_chain()
    moved = int((joints < 0).sum())
    reach = np.array([core.reach for core in cores], dtype=float)
    boxes = np.array(
        [_box_around(X, core) for X, core in zip(frames, cores, strict=True)], dtype=float
    ).reshape(-1, 2, 3)
    nothing = np.zeros(0, dtype=np.int64)
    alone = Cell(
        screws=np.ascontiguousarray(chain.screws, dtype=float),
        limits=np.stack([chain.lower, chain.upper]).astype(float),
        shapes=together(cores),
        X_WG=frames,
        joint=joints,
        object=np.array(objects, dtype=np.int64),
        reach=reach,
        box=np.array([core.box for core in cores], dtype=float).reshape(-1, 3),
        centers=np.ascontiguousarray(frames[moved:, :, 3].T),
        moved_joint=joints[moved:].copy(),
        moved_reach=reach[moved:].copy(),
        begin=np.searchsorted(joints[moved:], np.arange(arm.n)).astype(np.int64),
        pairs=nothing.reshape(0, 2),
        slot=nothing,
        groups=nothing,
        spans=nothing,
        span_slot=nothing,
        span_shape=nothing,
        around=np.zeros(0),
        standing=nothing.reshape(0, 2),
        clearance=float(clearance),
    )
    cluster = clusters(boxes, (joints < 0) & (alone.object < 0))
    number = {frozenset(pair): i for i, pair in enumerate(workcell.pairs)}
    pairs, standing = _looked_at(workcell, number, bodies, ids, alone)
    kept = [
        one
        for own in _by_bodies(pairs, bodies)
        if objects[own[0][0]] >= 0 or not never_meet(with_pairs(alone, own, [], boxes, cluster))
        for one in own
    ]
    cell = with_pairs(alone, kept, standing, boxes, cluster)
    both = np.concatenate([cell.pairs, cell.standing])
    of_bodies = [number[frozenset((bodies[a], bodies[b]))] for a, b in both.tolist()]
    return cell, np.array(of_bodies, dtype=np.int64)


def with_pairs(
    cell: Cell,
    pairs: Sequence[Pair],
    standing: Sequence[Pair],
    boxes: Array,
    cluster: NDArray[np.int64],
) -> Cell:
    """A cell that looks at these pairs of its shapes.

    Args:
        cell: the shapes.
        pairs: the second one of each moved by more joints than the first one.
        standing: the arm moves neither.
        boxes: (S, 2, 3) m, lower and upper corners of boxes in W around the shapes at q = 0.
        cluster: (S,) of each shape that is fixed in W; -1 of the others.
    """
    moved = len(cell.joint) - len(cell.moved_joint)
    ordered = sorted(pairs, key=lambda pair: (pair[1], cell.joint[pair[0]], cluster[pair[0]], pair))
    ends = np.array(ordered, dtype=np.int64).reshape(-1, 2)
    behind = cell.joint[ends[:, 0]] + 1
    slot = behind * len(cell.moved_joint) + ends[:, 1] - moved
    of = np.column_stack([ends[:, 1], behind, cluster[ends[:, 0]]])
    groups = np.flatnonzero((np.diff(of, axis=0, prepend=-2) != 0).any(axis=1))
    spans = np.flatnonzero(np.diff(slot[groups], prepend=-1))
    around = np.empty((len(groups), 2, 3))
    for i, (begin, end) in enumerate(itertools.pairwise([*groups.tolist(), len(ends)])):
        own = ends[begin:end, 0]
        around[i, 0], around[i, 1] = boxes[own, 0].min(axis=0), boxes[own, 1].max(axis=0)
        if (cluster[own] < 0).any():
            around[i] = [[-np.inf] * 3, [np.inf] * 3]
    return cell._replace(
        pairs=ends,
        slot=slot,
        groups=np.append(groups, len(ends)).astype(np.int64),
        spans=np.append(spans, len(groups)).astype(np.int64),
        span_slot=slot[groups[spans]],
        span_shape=ends[groups[spans], 1],
        around=np.ascontiguousarray(around.reshape(-1, 6).T).ravel(),
        standing=np.array(standing, dtype=np.int64).reshape(-1, 2),
    )


def _looked_at(
    workcell: Workcell,
    known: Container[frozenset[BodyIndex]],
    bodies: Sequence[BodyIndex],
    ids: Sequence[GeometryId],
    cell: Cell,
) -> tuple[list[Pair], list[Pair]]:
    """Pairs of shapes that Drake would look at, by their place; and those that stand.

    Args:
        workcell: of the shapes.
        known: the pairs of bodies that could touch.
        bodies, ids: of each shape.
        cell: the shapes.
    """
    inspector = workcell.scene_graph.model_inspector()
    joint, objects = cell.joint.tolist(), cell.object.tolist()
    pairs, standing = [], []
    for a, b in itertools.product(range(len(bodies)), repeat=2):
        if joint[a] > joint[b] or (joint[a] == joint[b] and (joint[a] >= 0 or a >= b)):
            continue
        if frozenset((bodies[a], bodies[b])) not in known:
            continue
        if inspector.CollisionFiltered(ids[a], ids[b]):
            continue
        if joint[b] >= 0:
            pairs.append((a, b))
        elif objects[a] >= 0 or objects[b] >= 0:
            standing.append((a, b))
    return pairs, standing


def _by_bodies(pairs: Sequence[Pair], bodies: Sequence[BodyIndex]) -> list[list[Pair]]:
    """The pairs of the same two bodies together."""
    of: dict[tuple[BodyIndex, BodyIndex], list[Pair]] = {}
    for a, b in pairs:
        of.setdefault((bodies[a], bodies[b]), []).append((a, b))
    return list(of.values())


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
