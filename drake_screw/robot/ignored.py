"""Pairs of links that may touch: they are left out of collision checking."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex, RigidBody

from drake_screw.errors import ModelError, unknown
from drake_screw.robot.names import called, scoped
from drake_screw.robot.packages import ModelPlace
from drake_screw.robot.parts import RobotConfig
from drake_screw.robot.srdf import IgnoredPair, read_srdf, srdf_file

KEY = "robot.ignore_collisions"

Pair = tuple[str, str]


def ignore_collisions(
    plant: MultibodyPlant,
    scene_graph: SceneGraph,
    robot: Sequence[ModelInstanceIndex],
    pairs: Sequence[Pair],
) -> None:
    """Have Drake never look at whether pairs of bodies touch.

    Args:
        plant: finalized.
        scene_graph: of the plant.
        robot: its models, whose links are meant; one of each pair may be the table or an obstacle.
        pairs: their names.

    Raises:
        ModelError: there is no such link or more than one, or neither of a pair is the robot's.
    """
    bodies = [plant.get_body(BodyIndex(i)) for i in range(1, plant.num_bodies())]
    links = [body for body in bodies if body.model_instance() in robot]
    fixed = [b for b in bodies if b.model_instance() not in robot and not b.is_floating_base_body()]
    manager = scene_graph.collision_filter_manager()
    for pair in pairs:
        a, b = (_called(name, links, fixed) for name in pair)
        if a.model_instance() not in robot and b.model_instance() not in robot:
            raise ModelError(
                f"{KEY}: neither '{pair[0]}' nor '{pair[1]}' is a link of the robot",
                remedy="Name a link of the robot, and what it may touch.",
            )
        manager.Apply(
            CollisionFilterDeclaration().ExcludeBetween(
                GeometrySet(plant.GetCollisionGeometriesForBody(a)),
                GeometrySet(plant.GetCollisionGeometriesForBody(b)),
            )
        )


def _called(name: str, links: Sequence[RigidBody], fixed: Sequence[RigidBody]) -> RigidBody:
    """The link of that name, or else what stands around."""
    matches = [body for body in links if called(body, name)]
    matches = matches or [body for body in fixed if called(body, name)]
    if len(matches) == 1:
        return matches[0]
    if matches:
        raise ModelError(
            f"{KEY}: {len(matches)} links are called '{name}'",
            remedy=f"Name one with its model: {', '.join(map(scoped, matches))}",
        )
    message, remedy = unknown("link", name, "the robot model", [link.name() for link in links])
    raise ModelError(f"{KEY}: {message}", remedy=remedy)


def remedy_for(pairs: Sequence[Pair]) -> str:
    """The lines of a scenario that let pairs touch."""
    return f"ignore_collisions: [{', '.join(f'[{a}, {b}]' for a, b in pairs)}]"


def ignored_pairs(robot: RobotConfig) -> tuple[IgnoredPair, ...]:
    """Pairs of links of a robot that may touch one another, by its SRDF.

    Raises:
        ModelError: that cannot be found or read.
    """
    if robot.srdf is None:
        return ()
    packages = ModelPlace(robot.model, robot.packages).packages
    return read_srdf(srdf_file(robot.srdf, packages), packages).pairs


def ignore(
    plant: MultibodyPlant,
    scene_graph: SceneGraph,
    robot: Sequence[ModelInstanceIndex],
    pairs: Iterable[Sequence[str]],
) -> tuple[str, ...]:
    """Let links of a robot touch one another without counting it as a collision.

    Args:
        plant: finalized.
        scene_graph: that the plant is registered with, not yet in a diagram that was built.
        robot: the robot's model instances.
        pairs: whose first two entries are names of links.

    Returns:
        Names that the robot does not have, each once, in order.
    """
    links = [plant.get_body(i) for model in robot for i in plant.GetBodyIndices(model)]
    bodies = {name: link for link in links for name in (scoped(link), link.name())}
    filters = CollisionFilterDeclaration()
    lacking: dict[str, None] = {}
    for pair in (pair[:2] for pair in pairs):
        missing = [name for name in pair if name not in bodies]
        lacking.update(dict.fromkeys(missing))
        if not missing:
            shapes = [
                GeometrySet(plant.GetCollisionGeometriesForBody(bodies[name])) for name in pair
            ]
            filters.ExcludeBetween(*shapes)
    scene_graph.collision_filter_manager().Apply(filters)
    return tuple(lacking)
