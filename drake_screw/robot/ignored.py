"""Pairs of links that may touch: they are left out of collision checking."""

from __future__ import annotations

from collections.abc import Sequence

from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex, RigidBody

from drake_screw.errors import ModelError, unknown
from drake_screw.robot.names import called
from drake_screw.robot.packages import ModelPlace
from drake_screw.robot.parts import RobotConfig
from drake_screw.robot.srdf import IgnoredPair, read_srdf, srdf_file

KEY = "robot.ignore_collisions"

Pair = tuple[str, str]


def ignore_collisions(
    plant: MultibodyPlant,
    scene_graph: SceneGraph,
    instances: Sequence[ModelInstanceIndex],
    robot: RobotConfig,
) -> tuple[str, ...]:
    """Have Drake never look at whether those links touch that a robot's scenario or SRDF lets.

    Args:
        plant: finalized.
        scene_graph: that the plant is registered with, not yet in a diagram that was built.
        instances: the robot's models; one of a scenario's pair may be the table or an obstacle.
        robot: which says so.

    Returns:
        Names in the SRDF that the robot does not have, each once, in order.

    Raises:
        ModelError: there is no such link, or neither of a pair is the robot's; the SRDF cannot be
            found or read.
    """
    bodies = [plant.get_body(BodyIndex(i)) for i in range(1, plant.num_bodies())]
    links = [body for body in bodies if body.model_instance() in instances]
    others = [
        body
        for body in bodies
        if body.model_instance() not in instances and not body.is_floating_base_body()
    ]
    for pair in robot.ignore_collisions:
        if not any(_named(links, name) for name in pair):
            for name in pair:
                if not _named(others, name):
                    choices = [body.name() for body in links]
                    message, remedy = unknown("link", name, "the robot model", choices)
                    raise ModelError(f"{KEY}: {message}", remedy=remedy)
            raise ModelError(
                f"{KEY}: neither '{pair[0]}' nor '{pair[1]}' is a link of the robot",
                remedy="Name a link of the robot, and what it may touch.",
            )
        a, b = (_named(links, name) or _named(others, name) for name in pair)
        for name, found in zip(pair, (a, b), strict=True):
            if not found:
                choices = [body.name() for body in links]
                message, remedy = unknown("link", name, "the robot model", choices)
                raise ModelError(f"{KEY}: {message}", remedy=remedy)
        _exclude(plant, scene_graph, a, b)
    missing: dict[str, None] = {}
    for listed in ignored_pairs(robot):
        a, b = (_named(links, name) for name in listed[:2])
        missing |= dict.fromkeys(n for n, at in zip(listed[:2], (a, b), strict=True) if not at)
        _exclude(plant, scene_graph, a, b)
    return tuple(missing)


def ignored_pairs(robot: RobotConfig) -> tuple[IgnoredPair, ...]:
    """Pairs of links of a robot that may touch one another, by its SRDF.

    Raises:
        ModelError: that cannot be found or read.
    """
    if robot.srdf is None:
        return ()
    packages = ModelPlace(robot.model, robot.packages).packages
    return read_srdf(srdf_file(robot.srdf, packages), packages).pairs


def remedy_for(pairs: Sequence[Pair]) -> str:
    """The lines of a scenario that let pairs touch."""
    return f"ignore_collisions: [{', '.join(f'[{a}, {b}]' for a, b in pairs)}]"


def _named(bodies: Sequence[RigidBody], name: str) -> list[RigidBody]:
    return [body for body in bodies if called(body, name)]


def _exclude(
    plant: MultibodyPlant,
    scene_graph: SceneGraph,
    a: Sequence[RigidBody],
    b: Sequence[RigidBody],
) -> None:
    shapes = [
        GeometrySet([g for body in group for g in plant.GetCollisionGeometriesForBody(body)])
        for group in (a, b)
    ]
    scene_graph.collision_filter_manager().Apply(
        CollisionFilterDeclaration().ExcludeBetween(*shapes)
    )
