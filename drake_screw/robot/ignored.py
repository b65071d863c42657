"""Pairs of links that may touch: they are left out of collision checking."""

from __future__ import annotations

from collections.abc import Sequence

from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex

from drake_screw.errors import ModelError
from drake_screw.robot.names import called, find_body, scoped
from drake_screw.robot.parts import RobotConfig
from drake_screw.robot.srdf import srdf_with
from drake_screw.robot.tool import leave_out

KEY = "robot.ignore_collisions"

Pair = tuple[str, str]


def let_links_touch(
    plant: MultibodyPlant,
    scene_graph: SceneGraph,
    models: Sequence[ModelInstanceIndex],
    robot: RobotConfig,
) -> tuple[str, ...]:
    """Have Drake never look at whether those links touch that a robot's scenario or SRDF lets.

    Args:
        plant: finalized.
        scene_graph: that the plant is registered with, not yet in a diagram that was built.
        models: the robot's, whose links are meant; of a scenario's pair one may be the table, an
            obstacle or an object.
        robot: which says so.

    Returns:
        Names in the SRDF that the robot does not have, each once, in order.

    Raises:
        ModelError: a link of the scenario is none or several, or neither of a pair is the robot's;
            the SRDF cannot be found or read.
    """
    bodies = [plant.get_body(BodyIndex(i)) for i in range(1, plant.num_bodies())]
    links = [body for body in bodies if body.model_instance() in models]
    others = [body for body in bodies if body.model_instance() not in models]
    for pair in robot.ignore_collisions:
        a, b = (
            find_body(
                name,
                links if any(called(link, name) for link in links) else others,
                key=KEY,
                kind="link",
                many="links",
                where="the robot model",
                choices=links,
            )
            for name in pair
        )
        if a.model_instance() not in models and b.model_instance() not in models:
            raise ModelError(
                f"{KEY}: neither '{pair[0]}' nor '{pair[1]}' is a link of the robot",
                remedy="Name a link of the robot, and what it may touch.",
            )
        leave_out(plant, scene_graph, a, b)
    srdf = srdf_with(robot)
    if srdf is None:
        return ()
    by_name = {name: link for link in links for name in (scoped(link), link.name())}
    lacking: dict[str, None] = {}
    for names in (pair[:2] for pair in srdf.pairs):
        missing = [name for name in names if name not in by_name]
        lacking |= dict.fromkeys(missing)
        if not missing:
            leave_out(plant, scene_graph, *(by_name[name] for name in names))
    return tuple(lacking)


def remedy_for(pairs: Sequence[Pair]) -> str:
    """The lines of a scenario that let pairs touch."""
    return f"ignore_collisions: [{', '.join(f'[{a}, {b}]' for a, b in pairs)}]"
