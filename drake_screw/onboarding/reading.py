"""A robot model as it comes, read into a plant to be looked at."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.planning import RobotDiagram, RobotDiagramBuilder

from drake_screw.errors import ModelError
from drake_screw.resources import MODEL_SUFFIXES, find_resource
from drake_screw.robot.model_text import check_collision_shapes


@dataclass(frozen=True, eq=False)
class Robot:
    """A model with nothing around it, its root where it is free.

    Attributes:
        model: as it was asked for: a shipped name, or a path.
        file: that it was read from.
        diagram: of the finalized plant, which it keeps.
        plant: that plant.
        mimics: names of joints that follow another one.
    """

    model: str
    file: Path
    diagram: RobotDiagram
    plant: MultibodyPlant
    mimics: frozenset[str]


def read_robot(model: str) -> Robot:
    """Read a model.

    Raises:
        ModelError: there is no such file, or Drake cannot read it.
    """
    file = find_resource("models", model, MODEL_SUFFIXES)
    check_collision_shapes(file)
    builder = RobotDiagramBuilder(time_step=0.0)
    parser: Parser = builder.parser()
    try:
        parser.AddModels(str(file))
    except (RuntimeError, ValueError, SystemExit) as error:
        raise ModelError(f"Drake cannot read this model: {error}", file=file) from error
    plant: MultibodyPlant = builder.plant()
    plant.Finalize()
    return Robot(model, file, builder.Build(), plant, _mimics(file))


def _mimics(file: Path) -> frozenset[str]:
    """Joints that the model's text lets follow another one."""
    if file.suffix.lower() not in (".urdf", ".sdf"):
        return frozenset()
    try:
        joints = ET.parse(file).getroot().iter("joint")
        return frozenset(
            joint.get("name", "") for joint in joints if next(joint.iter("mimic"), None) is not None
        )
    except (ET.ParseError, OSError):
        return frozenset()
