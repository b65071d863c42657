"""Pairs of a robot's links that are not looked at for touching one another."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from drake_screw.robot.packages import ModelPlace
from drake_screw.robot.parts import RobotConfig
from drake_screw.robot.srdf import IgnoredPair, read_srdf, srdf_file


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
    bodies = {
        plant.get_body(i).name(): plant.get_body(i)
        for instance in robot
        for i in plant.GetBodyIndices(instance)
    }
    filters = CollisionFilterDeclaration()
    unknown: dict[str, None] = {}
    for pair in (pair[:2] for pair in pairs):
        missing = [name for name in pair if name not in bodies]
        unknown.update(dict.fromkeys(missing))
        if not missing:
            shapes = [
                GeometrySet(plant.GetCollisionGeometriesForBody(bodies[name])) for name in pair
            ]
            filters.ExcludeBetween(*shapes)
    scene_graph.collision_filter_manager().Apply(filters)
    return tuple(unknown)
