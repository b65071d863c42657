"""A robot model as it comes, read into a plant to be looked at."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from pydrake.multibody.plant import MultibodyPlant
from pydrake.planning import RobotDiagram, RobotDiagramBuilder

from drake_screw.robot import RobotConfig
from drake_screw.robot.base import WORLD
from drake_screw.robot.parts import add_robot


@dataclass(frozen=True, eq=False)
class Robot:
    """A model with nothing around it, where it puts itself.

    Attributes:
        given: the model as it was asked for, a shipped name or a path, and what it is read with.
        file: that it was read from.
        diagram: of the finalized plant, which it keeps.
        plant: that plant.
        mimics: names of joints that follow another one.
    """

    given: RobotConfig
    file: Path
    diagram: RobotDiagram
    plant: MultibodyPlant
    mimics: frozenset[str]


def read_robot(model: str | RobotConfig) -> Robot:
    """Read a model.

    Args:
        model: its name or file; or that with packages, arguments of xacro and an SRDF file.

    Raises:
        ModelError: there is no such file, or Drake cannot read it.
    """
    if isinstance(model, str):
        model = RobotConfig(model, (), "", ())
    builder = RobotDiagramBuilder(time_step=0.0)
    added = add_robot(builder.parser(), replace(model, base=WORLD))
    mimics = frozenset(mimic.follower for mimic in added.mimics)
    plant: MultibodyPlant = builder.plant()
    plant.Finalize()
    return Robot(model, added.model.file, builder.Build(), plant, mimics)
