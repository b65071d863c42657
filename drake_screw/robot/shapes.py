"""Solid shapes of a workcell: a box, a cylinder, a sphere, or the convex hull of a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydrake.geometry import (
    Box,
    Convex,
    Cylinder,
    PolygonSurfaceMesh,
    Shape,
    Sphere,
    TriangleSurfaceMesh,
)
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import RigidBody

from drake_screw.errors import ModelError
from drake_screw.files import NO_FILE
from drake_screw.robot.mesh_files import CONVERTED, hull_file
from drake_screw.robot.model_text import LARGEST
from drake_screw.typing import Array

MESH_SUFFIXES = (".obj", ".gltf", ".vtk")
"""Of the files that Drake makes a convex hull of."""

SIDES = 48
"""Corners that stand for a circle."""


@dataclass(frozen=True)
class BoxShape:
    """A box about its frame's origin; full sizes along x, y, z in m."""

    size: tuple[float, float, float]

    def __str__(self) -> str:
        return f"box {' x '.join(f'{length:g}' for length in self.size)} m"


@dataclass(frozen=True)
class CylinderShape:
    """A cylinder about its frame's origin, its axis along z; in m."""

    radius: float
    length: float

    def __str__(self) -> str:
        return f"cylinder of radius {self.radius:g} m, {self.length:g} m long"


@dataclass(frozen=True)
class SphereShape:
    """A sphere about its frame's origin; in m."""

    radius: float

    def __str__(self) -> str:
        return f"sphere of radius {self.radius:g} m"


@dataclass(frozen=True)
class MeshShape:
    """The convex hull of a mesh file, whose coordinates times `scale` are in m."""

    file: Path
    scale: float = 1.0

    def __str__(self) -> str:
        scaled = "" if self.scale == 1.0 else f" times {self.scale:g}"
        return f"convex hull of {self.file.name}{scaled}"


Solid = BoxShape | CylinderShape | SphereShape | MeshShape


@dataclass(frozen=True)
class PlacedShape:
    """A shape G in a frame F: p_FG `xyz` in m; roll, pitch and yaw `rpy` in rad."""

    solid: Solid
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def X_FG(self) -> RigidTransform:
        """Pose of the shape."""
        return RigidTransform(RollPitchYaw(self.rpy), self.xyz)

    def drake(self) -> Shape:
        """The shape as Drake has it.

        Raises:
            ModelError: of a mesh: there is no such file, or Drake makes no hull of it.
        """
        match self.solid:
            case BoxShape(size):
                return Box(*size)
            case CylinderShape(radius, length):
                return Cylinder(radius, length)
            case SphereShape(radius):
                return Sphere(radius)
            case MeshShape(file, scale):
                return _hull(file, scale)

    def corners(self) -> Array:
        """Points (v, 3) in F whose convex hull is the shape, or nearly so where it is round.

        Raises:
            ModelError: as `drake`.
        """
        match self.solid:
            case BoxShape(size):
                signs = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3), axis=-1).reshape(-1, 3)
                p_GP = signs * size
            case CylinderShape(radius, length):
                p_GP = np.concatenate([_circle(radius, z) for z in (-length / 2, length / 2)])
            case SphereShape(radius):
                angles = np.linspace(-np.pi / 2, np.pi / 2, SIDES // 2 + 1)
                rings = [_circle(radius * np.cos(a), radius * np.sin(a)) for a in angles]
                p_GP = np.concatenate(rings)
            case MeshShape(file, scale):
                hull = _hull(file, scale).GetConvexHull()
                p_GP = vertices(hull)
        return np.asarray(self.X_FG.multiply(p_GP.T)).T


def vertices(surface: PolygonSurfaceMesh | TriangleSurfaceMesh) -> Array:
    """The vertices (v, 3) of one of Drake's surfaces."""
    return np.array([surface.vertex(i) for i in range(surface.num_vertices())])


def register(
    plant: MultibodyPlant,
    body: RigidBody,
    shape: Shape,
    X_BG: RigidTransform,
    color: Array,
    friction: float = 0.6,
    look: Shape | None = None,
) -> None:
    """Give a body a look and a collision shape, which are the same unless there is a `look`.

    A plant without a scene graph, which is for kinematics alone, gets neither.
    """
    if not plant.geometry_source_is_registered():
        return
    X_BL, seen = (X_BG, shape) if look is None else (RigidTransform(), look)
    plant.RegisterVisualGeometry(body, X_BL, seen, f"{body.name()}_look", color)
    plant.RegisterCollisionGeometry(
        body, X_BG, shape, f"{body.name()}_shape", CoulombFriction(friction, friction)
    )


def _circle(radius: float, z: float) -> Array:
    angle = np.arange(SIDES) * 2.0 * np.pi / SIDES
    return np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), np.full(SIDES, float(z))], axis=-1
    )


def _hull(file: Path, scale: float) -> Convex:
    others = ", ".join(CONVERTED)
    remedy = (
        f"Give the path of a mesh: {', '.join(MESH_SUFFIXES[:-1])} or {MESH_SUFFIXES[-1]}; "
        f"{others} are converted."
    )
    if not file.exists():
        raise ModelError("there is no such mesh", remedy=remedy, file=file)
    if not file.is_file():
        what = "it is a folder" if file.is_dir() else NO_FILE
        raise ModelError(f"no mesh: {what}", remedy=remedy, file=file)
    suffix = file.suffix.lower()
    if suffix not in (*MESH_SUFFIXES, *CONVERTED):
        raise ModelError(
            f"'{file.suffix}' is no kind of mesh that a convex hull can be made of",
            remedy=remedy,
            file=file,
        )
    try:
        read = hull_file(file) if suffix in CONVERTED else file
    except ModelError as error:
        raise ModelError(f"this mesh {error.message}", remedy=remedy, file=file) from error
    try:
        shape = Convex(str(read), scale)
        hull = shape.GetConvexHull()
    except (RuntimeError, ValueError) as error:
        message = f"Drake cannot read this mesh: {error}"
        raise ModelError(message, remedy=remedy, file=file) from error
    far = max(float(np.abs(hull.vertex(i)).max()) for i in range(hull.num_vertices()))
    if not far <= LARGEST:
        raise ModelError(
            f"this mesh, {scale:g} times as large as in the file, goes as far as {far:.3g} m",
            remedy="Give a scale with which its coordinates are in m: 0.001 if they are in mm.",
            file=file,
        )
    return shape
