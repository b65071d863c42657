"""Pairs of links that may touch: they are left out of collision checking."""

from __future__ import annotations

from collections.abc import Sequence

from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex, RigidBody

from drake_screw.errors import ModelError, unknown

KEY = "robot.ignore_collisions"

Pair = tuple[str, str]


def ignore_collisions(
    plant: MultibodyPlant,
    scene_graph: SceneGraph,
    robot: ModelInstanceIndex,
    pairs: Sequence[Pair],
) -> None:
    """Have Drake never look at whether pairs of bodies touch.

    Args:
        plant: finalized.
        scene_graph: of the plant.
        robot: whose links are meant; one of each pair may be the table or an obstacle.
        pairs: their names.

    Raises:
        ModelError: there is no such link, or neither of a pair is the robot's.
    """
    bodies = [plant.get_body(BodyIndex(i)) for i in range(1, plant.num_bodies())]
    links = {body.name(): body for body in bodies if body.model_instance() == robot}
    others: dict[str, list[RigidBody]] = {}
    for body in bodies:
        if body.model_instance() != robot and not body.is_floating_base_body():
            others.setdefault(body.name(), []).append(body)
    manager = scene_graph.collision_filter_manager()
    for pair in pairs:
        for name in pair:
            if name not in links and name not in others:
                message, remedy = unknown("link", name, "the robot model", links)
                raise ModelError(f"{KEY}: {message}", remedy=remedy)
        if not any(name in links for name in pair):
            raise ModelError(
                f"{KEY}: neither '{pair[0]}' nor '{pair[1]}' is a link of the robot",
                remedy="Name a link of the robot, and what it may touch.",
            )
        a, b = ([links[name]] if name in links else others[name] for name in pair)
        for one in a:
            for other in b:
                manager.Apply(
                    CollisionFilterDeclaration().ExcludeBetween(
                        GeometrySet(plant.GetCollisionGeometriesForBody(one)),
                        GeometrySet(plant.GetCollisionGeometriesForBody(other)),
                    )
                )


def remedy_for(pairs: Sequence[Pair]) -> str:
    """The lines of a scenario that let pairs touch."""
    return f"ignore_collisions: [{', '.join(f'[{a}, {b}]' for a, b in pairs)}]"
