"""Objects that are free to move in a simulation: how they stand, and how far they are pushed.

They stand by hydroelastic contact, a pressure over the whole of the face they stand on: the one
point in which point contact would hold a cylinder up makes it rock. What touches them otherwise,
the robot above all, meets them in points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddRigidHydroelasticProperties,
    GeometryId,
    ProximityProperties,
    RoleAssign,
    SceneGraph,
)
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody

from drake_screw.screws import pose, rotation_angle, translation_distance
from drake_screw.screws.rotations import rotation_from_quaternion
from drake_screw.typing import Array

STIFFNESS = 1e7
"""Pa, hydroelastic modulus of objects: a bowl of 0.3 kg sinks in by a micrometre."""
RESOLUTION = 0.5
"""Of an object's mesh, over its radius."""
DISSIPATION = 10.0
"""s/m, of Hunt and Crossley: what is set down does not bounce."""
SETTLING = 0.3
"""s, for which objects stand by themselves before anything moves."""
SETTLED_POSITION, SETTLED_ROTATION = 1e-3, 5e-3
"""m and rad, that an object may move by itself until it rests; beyond, it was not set down."""


@dataclass(frozen=True)
class Displacement:
    """How far an object was moved: the greatest distance of its frame from where it had settled.

    Attributes:
        object: its name.
        position: m, of the frame's origin.
        rotation: rad.
        time: s, when it was 0.1 mm or 1 mrad from there for the first time; None if it never was.
    """

    object: str
    position: float
    rotation: float
    time: float | None = None

    def __str__(self) -> str:
        turned = f" and turned by {self.rotation:.3f} rad" if self.rotation > 1e-3 else ""
        when = "" if self.time is None else f" from {self.time:.2f} s on"
        return f"{self.object} is pushed by {1e3 * self.position:.1f} mm{turned}{when}"


def let_stand(
    scene_graph: SceneGraph,
    plant: MultibodyPlant,
    objects: Sequence[tuple[RigidBody, float]],
    ground: Sequence[RigidBody],
) -> None:
    """Make objects compliant and what they may stand on rigid, for hydroelastic contact.

    Args:
        scene_graph: of the plant.
        plant: finalized, with "hydroelastic_with_fallback" for a contact model.
        objects: with the radius of each in m.
        ground: fixed bodies.
    """
    for body, radius in objects:
        for geometry in plant.GetCollisionGeometriesForBody(body):
            properties = _properties(scene_graph, geometry)
            properties.UpdateProperty("material", "hunt_crossley_dissipation", DISSIPATION)
            AddCompliantHydroelasticProperties(RESOLUTION * radius, STIFFNESS, properties)
            _assign(scene_graph, plant, geometry, properties)
    for body in ground:
        for geometry in plant.GetCollisionGeometriesForBody(body):
            properties = _properties(scene_graph, geometry)
            AddRigidHydroelasticProperties(0.1, properties)
            _assign(scene_graph, plant, geometry, properties)


def _properties(scene_graph: SceneGraph, geometry: GeometryId) -> ProximityProperties:
    given = scene_graph.model_inspector().GetProximityProperties(geometry)
    return ProximityProperties(given)


def _assign(
    scene_graph: SceneGraph,
    plant: MultibodyPlant,
    geometry: GeometryId,
    properties: ProximityProperties,
) -> None:
    source = plant.get_source_id()
    scene_graph.AssignRole(source, geometry, properties, RoleAssign.kReplace)


def poses(positions: ArrayLike) -> Array:
    """Poses (..., 4, 4) from a free body's positions in a plant (..., 7): quaternion, place."""
    positions = np.asarray(positions, dtype=float)
    return pose(rotation_from_quaternion(positions[..., :4]), positions[..., 4:])


def displacements(names: Sequence[str], t: Array, X_WO: Array) -> tuple[Displacement, ...]:
    """How far objects went in a simulation.

    Args:
        names: of the k objects.
        t: (m,) s.
        X_WO: (m, k, 4, 4), where they had settled first.
    """
    found = []
    for i, name in enumerate(names):
        far = translation_distance(X_WO[:, i], X_WO[:1, i])
        turned = rotation_angle(X_WO[:, i], X_WO[:1, i])
        moved = np.flatnonzero((far > 1e-4) | (turned > 1e-3))
        when = float(t[moved[0]]) if len(moved) else None
        found.append(Displacement(name, float(far.max()), float(turned.max()), when))
    return tuple(found)


def unsettled(names: Sequence[str], placed: Array, settled: Array) -> str:
    """What did not stay where it was placed, in words; empty if all did.

    Args:
        names: of the k objects.
        placed, settled: (k, 4, 4) X_WO.
    """
    for name, X, Y in zip(names, placed, settled, strict=True):
        far, turned = float(translation_distance(X, Y)), float(rotation_angle(X, Y))
        if far > SETTLED_POSITION or turned > SETTLED_ROTATION:
            fell = 1e3 * float(X[2, 3] - Y[2, 3])
            how = f"falls by {fell:.1f} mm" if fell > 500.0 * SETTLED_POSITION else "is moved"
            return (
                f"the {name} does not rest where it stands: by itself it {how} "
                f"({1e3 * far:.1f} mm, {turned:.3f} rad) in {SETTLING:g} s"
            )
    return ""
