"""Collisions of a workcell's arm by Pinocchio and Coal, in place of Drake's own checker."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pinocchio_arm import model_of
from pydrake.geometry import (
    Box,
    Capsule,
    Convex,
    Cylinder,
    Ellipsoid,
    GeometryId,
    HalfSpace,
    Mesh,
    Role,
    Shape,
    Sphere,
)
from pydrake.multibody.tree import BodyIndex

from drake_screw.robot import Workcell
from drake_screw.typing import Array

RANDOM = 50
"""Configurations a path, anywhere within the limits, at which verdicts are compared besides those
on the path, where few touch anything."""


class CoalChecker:
    """A workcell's collision shapes in a geometry model of Pinocchio, asked about by Coal.

    The pairs are those that Drake looks at.

    Args:
        workcell: robot, table, obstacles and objects.
        threads: that configurations are shared out among.

    Attributes:
        pairs: how many pairs of shapes are asked about.

    Raises:
        ImportError: Pinocchio is not installed; it comes with the extra `benchmark`.
    """

    def __init__(self, workcell: Workcell, threads: int = 1) -> None:
        import pinocchio

        self._pin, self._threads, self._workcell = pinocchio, threads, workcell
        self._model = model_of(workcell.arm.screw_chain())
        self._geometry = pinocchio.GeometryModel()
        self._in_objects: list[tuple[int, int, Array]] = []
        of_body = self._add_shapes()
        inspector = workcell.scene_graph.model_inspector()
        for a, b in workcell.pairs:
            for (i, first), (j, second) in itertools.product(of_body[a], of_body[b]):
                if not inspector.CollisionFiltered(first, second):
                    self._geometry.addCollisionPair(pinocchio.CollisionPair(i, j))
        self.pairs = len(self._geometry.collisionPairs)
        self._data, self._found = self._model.createData(), self._geometry.createData()
        self._pool = pinocchio.BroadPhaseManagerPool_DynamicAABBTreeCollisionManager(
            self._model, self._geometry, threads
        )

    def collides(self, q: Array, X_WO: Array) -> NDArray[np.bool_]:
        """(m,) at which of q (m, n) anything touches among objects X_WO (k, 4, 4)."""
        return self._together(q, X_WO, first_only=False)

    def touches(self, q: Array, X_WO: Array) -> bool:
        """Whether anything touches at one of q (m, n), by one call for all; none behind the first.

        Trees of boxes around the shapes (a broad phase) say which pairs are looked at more closely.
        """
        return bool(self._together(q, X_WO, first_only=True).any())

    def touches_one_by_one(self, q: Array, X_WO: Array) -> bool:
        """The same by a call (`computeCollisions`) for every configuration, and of every pair."""
        self._place(self._geometry, X_WO)
        return any(
            self._pin.computeCollisions(
                self._model, self._data, self._geometry, self._found, one, True
            )
            for one in q
        )

    def beside_drake(
        self, paths: Sequence[tuple[Array, Array]], rng: np.random.Generator
    ) -> dict[str, Any]:
        """Coal's verdicts beside Drake's, on paths and at RANDOM configurations for each.

        Args:
            paths: configurations (m, n), and objects (k, 4, 4).
            rng: for the random ones.

        Returns:
            How many "configurations" there are, how many "touch" something by Drake, and where
            the verdicts "differ": configurations (n,) and objects.
        """
        arm, count, touch, differ = self._workcell.arm, 0, 0, []
        for on_path, X_WO in paths:
            q = np.concatenate([on_path, rng.uniform(arm.lower, arm.upper, (RANDOM, arm.n))])
            drakes = self._workcell.collides(q, X_WO)
            count, touch = count + len(q), touch + int(drakes.sum())
            differ += [(one, X_WO) for one in q[self.collides(q, X_WO) != drakes]]
        return {"configurations": count, "touch": touch, "differ": differ}

    def _together(self, q: Array, X_WO: Array, first_only: bool) -> NDArray[np.bool_]:
        for geometry in self._pool.getGeometryModels():
            self._place(geometry, X_WO)
        return np.asarray(
            self._pin.computeCollisionsInParallel(
                self._threads, self._pool, np.asfortranarray(q.T), True, first_only
            )
        )

    def _place(self, geometry: Any, X_WO: Array) -> None:
        for number, k, X_OG in self._in_objects:
            geometry.geometryObjects[number].placement = self._pin.SE3(X_WO[k] @ X_OG)

    def _add_shapes(self) -> dict[BodyIndex, list[tuple[int, GeometryId]]]:
        """Add all shapes; of each body their numbers, and what Drake knows them by."""
        workcell, arm, plant = self._workcell, self._workcell.arm, self._workcell.plant
        inspector, context = workcell.scene_graph.model_inspector(), plant.CreateDefaultContext()
        plant.SetPositions(context, arm.full_positions(np.zeros(arm.n)))
        moved_by: dict[BodyIndex, int] = {}
        for i, joint in enumerate(arm.joints):
            for index in plant.GetBodiesKinematicallyAffectedBy([joint.index()]):
                moved_by[index] = i + 1
        self._data = self._model.createData()
        self._pin.forwardKinematics(self._model, self._data, np.zeros(arm.n))
        objects = {body.index(): k for k, body in enumerate(workcell.objects)}
        of_body: dict[BodyIndex, list[tuple[int, GeometryId]]] = {}
        for number, geometry in enumerate(inspector.GetAllGeometryIds(Role.kProximity)):
            body = plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
            X_BG = inspector.GetPoseInFrame(geometry).GetAsMatrix4()
            of_body.setdefault(body.index(), []).append((number, geometry))
            if body.index() in objects:
                self._in_objects.append((number, objects[body.index()], X_BG))
            X_WG = self._pin.SE3(body.EvalPoseInWorld(context).GetAsMatrix4() @ X_BG)
            joint = moved_by.get(body.index(), 0)
            self._geometry.addGeometryObject(
                self._pin.GeometryObject(
                    str(number),
                    joint,
                    self._data.oMi[joint].actInv(X_WG),
                    coal_shape(inspector.GetShape(geometry)),
                )
            )
        return of_body


def coal_shape(shape: Shape) -> Any:
    """A collision shape of Drake's as Coal has it; of a mesh the convex hull, as in Drake."""
    import coal

    match shape:
        case Sphere():
            return coal.Sphere(shape.radius())
        case Capsule():
            return coal.Capsule(shape.radius(), shape.length())
        case Cylinder():
            return coal.Cylinder(shape.radius(), shape.length())
        case Box():
            return coal.Box(*shape.size())
        case Ellipsoid():
            return coal.Ellipsoid(shape.a(), shape.b(), shape.c())
        case HalfSpace():
            return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
        case Mesh() | Convex():
            surface = shape.GetConvexHull()
            points = coal.StdVec_Vec3s()
            for i in range(surface.num_vertices()):
                points.append(np.asarray(surface.vertex(i), dtype=float))
            return coal.Convex.convexHull(points, False, "Qt")
    raise TypeError(f"no shape of Coal's for {shape}")
