"""Whether the objects of a task are in one another."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet
from pydrake.planning import RobotDiagram, RobotDiagramBuilder

from drake_screw.robot.parts import ObjectConfig, add_object
from drake_screw.screws import quaternion_from_rotation


@dataclass(frozen=True)
class ObjectsOverlap:
    """Looks, with Drake, whether any two of k objects overlap, each of them its collision shape.

    Attributes:
        objects: the k objects.
        passed_over: pairs of them, by number, that may: what stands on something touches it.
    """

    objects: tuple[ObjectConfig, ...]
    passed_over: frozenset[tuple[int, int]] = frozenset()

    def __call__(self, X_WO: ArrayLike) -> NDArray[np.bool_]:
        """Poses (N, k, 4, 4) to (N,)."""
        X_WO = np.asarray(X_WO, dtype=float)
        diagram = self._diagram
        plant, root = diagram.plant(), diagram.CreateDefaultContext()
        context = plant.GetMyMutableContextFromRoot(root)
        graph = diagram.scene_graph()
        port, scene = graph.get_query_output_port(), graph.GetMyContextFromRoot(root)
        positions = np.empty((len(X_WO), plant.num_positions()))
        for i, item in enumerate(self.objects):
            first = plant.GetBodyByName(item.name).floating_positions_start()
            positions[:, first : first + 4] = quaternion_from_rotation(X_WO[:, i, :3, :3])
            positions[:, first + 4 : first + 7] = X_WO[:, i, :3, 3]
        found = np.empty(len(X_WO), dtype=bool)
        for n, q in enumerate(positions):
            plant.SetPositions(context, q)
            found[n] = port.Eval(scene).HasCollisions()
        return found

    @cached_property
    def _diagram(self) -> RobotDiagram:
        builder = RobotDiagramBuilder(time_step=0.0)
        plant = builder.plant()
        bodies = [add_object(plant, item) for item in self.objects]
        plant.Finalize()
        diagram = builder.Build()
        shapes = [GeometrySet(plant.GetCollisionGeometriesForBody(body)) for body in bodies]
        for i, j in self.passed_over:
            diagram.scene_graph().collision_filter_manager().Apply(
                CollisionFilterDeclaration().ExcludeBetween(shapes[i], shapes[j])
            )
        return diagram
