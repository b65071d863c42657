"""The links that an arm moves, as Meshcat shows them: where they are, and copies of them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike
from pydrake.geometry import (
    FrameId,
    GeometryId,
    Meshcat,
    ReadObjToTriangleSurfaceMesh,
    Role,
    SceneGraph,
    Shape,
)
from pydrake.geometry import Mesh as MeshShape
from pydrake.multibody.tree import BodyIndex

from drake_screw.robot import Arm, Workcell
from drake_screw.robot.shapes import vertices
from drake_screw.typing import Array
from drake_screw.visualization.drawing import draw, rgba
from drake_screw.visualization.meshes import Mesh

HALO = 1.03
"""A copy is larger than its link by this factor, so that the two never flicker."""


class Linkage:
    """The bodies of a workcell that its arm moves.

    Args:
        workcell: with the arm.

    Attributes:
        arm: the arm.
        names: of the links that have a look, as parts of a path of the scene tree
            ("baxter/left_wrist"); `MeshcatVisualizer` uses the same.
    """

    def __init__(self, workcell: Workcell) -> None:
        self.arm: Arm = workcell.arm
        plant, graph = workcell.plant, workcell.scene_graph
        self._graph: SceneGraph = graph
        self._plant, self._named = plant, workcell.name
        self._context = plant.CreateDefaultContext()
        self._bare: dict[GeometryId, Mesh | None] = {}
        inspector = graph.model_inspector()
        first = self.arm.joints[0].index()
        moved = [
            (plant.get_body(i), plant.GetBodyFrameIdOrThrow(i))
            for i in plant.GetBodiesKinematicallyAffectedBy([first])
        ]
        self._links = [
            (body, frame, inspector.GetName(frame).replace("::", "/"))
            for body, frame in moved
            if inspector.NumGeometriesForFrameWithRole(frame, Role.kIllustration)
        ]
        self.names = tuple(name for _, _, name in self._links)

    def poses(self, q: ArrayLike) -> Array:
        """X_WL (m, l, 4, 4) of the l links, at configurations q (m, n) of the arm."""
        full = self.arm.full_positions(q)
        X_WL = np.empty((len(full), len(self._links), 4, 4))
        for i, positions in enumerate(full):
            self._plant.SetPositions(self._context, positions)
            for j, (body, _, _) in enumerate(self._links):
                X_WL[i, j] = self._plant.EvalBodyPoseInWorld(self._context, body).GetAsMatrix4()
        return X_WL

    def joint_frames(self, joint: int, q: ArrayLike) -> Array:
        """X_WJ (m, 4, 4) of a joint at configurations q (m, n), z along its axis.

        The frame is fixed to the link that carries the joint: it does not turn with it.
        """
        item = self.arm.joints[joint]
        revolute = item.type_name() == "revolute"
        z = item.revolute_axis() if revolute else item.translation_axis()
        x = np.cross(np.eye(3)[np.abs(z).argmin()], z)
        x /= np.linalg.norm(x)
        X_FJ = np.eye(4)
        X_FJ[:3, :3] = np.stack([x, np.cross(z, x), z], axis=-1)
        frames = []
        for positions in self.arm.full_positions(q):
            self._plant.SetPositions(self._context, positions)
            X_WF = item.frame_on_parent().CalcPoseInWorld(self._context).GetAsMatrix4()
            frames.append(X_WF @ X_FJ)
        return np.array(frames)

    def draw_copy(
        self, meshcat: Meshcat, path: str, q: ArrayLike, color: str, opacity: float
    ) -> None:
        """Draw the links once more, at one configuration q (n,), all in one colour."""
        X_WL = self.poses(np.asarray(q, dtype=float)[None])[0]
        for (_, frame, name), X in zip(self._links, X_WL, strict=True):
            self._draw_body(meshcat, f"{path}/{name}", frame, X, color, opacity)

    def draw_bodies(
        self,
        meshcat: Meshcat,
        path: str,
        names: Iterable[str],
        positions: Array,
        color: str,
        opacity: float,
    ) -> None:
        """Draw bodies of the workcell once more by their names, as `Workcell.name` has them.

        `positions` are those of the whole plant.
        """
        plant, inspector = self._plant, self._graph.model_inspector()
        plant.SetPositions(self._context, positions)
        wanted = set(names)
        for body in (plant.get_body(BodyIndex(i)) for i in range(1, plant.num_bodies())):
            if self._named(body.index()) not in wanted:
                continue
            frame = plant.GetBodyFrameIdOrThrow(body.index())
            X_WB = plant.EvalBodyPoseInWorld(self._context, body).GetAsMatrix4()
            name = inspector.GetName(frame).replace("::", "/")
            self._draw_body(meshcat, f"{path}/{name}", frame, X_WB, color, opacity)

    def _draw_body(
        self, meshcat: Meshcat, path: str, frame: FrameId, X_WB: Array, color: str, opacity: float
    ) -> None:
        """The looks of a body a little larger; its collision shapes where it has none."""
        inspector = self._graph.model_inspector()
        looks = inspector.GetGeometries(frame, Role.kIllustration)
        meshcat.SetTransform(path, X_WB)
        larger = np.diag([HALO, HALO, HALO, 1.0])
        for geometry in looks or inspector.GetGeometries(frame, Role.kProximity):
            place = f"{path}/{inspector.GetName(geometry).replace('::', '/')}"
            shape = inspector.GetShape(geometry)
            if geometry not in self._bare:
                self._bare[geometry] = _without_looks(shape)
            bare = self._bare[geometry]
            if bare is None:
                meshcat.SetObject(place, shape, rgba(color, opacity))
            else:
                draw(meshcat, place, bare, color, opacity)
            X_BG = inspector.GetPoseInFrame(geometry).GetAsMatrix4()
            meshcat.SetTransform(place, X_BG @ larger)


def _without_looks(shape: Shape) -> Mesh | None:
    """A mesh that brings colours of its own, which no colour would change, without them.

    Of glTF only the convex hull is left; None of other shapes.
    """
    if not isinstance(shape, MeshShape):
        return None
    path = shape.source().path() if shape.source().is_path() else None
    if path is not None and path.suffix.lower() == ".obj":
        if b"mtllib" not in path.read_bytes():
            return None
        surface = ReadObjToTriangleSurfaceMesh(path, shape.scale3())
        corners = vertices(surface)
        faces = [
            [surface.element(f).vertex(k) for k in range(3)] for f in range(surface.num_triangles())
        ]
    else:
        from scipy.spatial import ConvexHull  # takes long to import

        corners = vertices(shape.GetConvexHull())
        faces = ConvexHull(corners).simplices
    return Mesh(corners, np.asarray(faces, dtype=np.int32))
