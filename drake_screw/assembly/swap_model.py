"""Another robot model in a scenario, with the same names for what the scenario plans with."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint, RigidBody

from drake_screw.errors import ModelError
from drake_screw.robot import RobotConfig
from drake_screw.robot.names import scoped
from drake_screw.robot.parts import add_robot
from drake_screw.robot.xacro_text import SUFFIX
from drake_screw.scenario.schema import Scenario
from drake_screw.typing import PathLike


def swap_model(scenario: Scenario, model: PathLike) -> Scenario:
    """The scenario on another robot model.

    The model must have the arm's joints, the base and the end effector. Other joints that are
    parked and that it lacks (those of a second arm, say) are left out, and so are links that it
    lacks and that the tool may touch, and pairs with them in `ignore_collisions`. The robot that
    recordings were made on stays as it is.

    Raises:
        ModelError: the model cannot be read or lacks the base, or it is one of the robot that the
            recordings were made on.
    """
    text = os.fspath(model)
    place = text if "://" in text else str(Path(model).resolve())
    block = scenario.robot.model_copy(update={"model": place})
    plant = MultibodyPlant(0.0)
    parser = Parser(plant)
    xacro = block.xacro if place.endswith(SUFFIX) else {}
    block = block.model_copy(update={"xacro": xacro})
    config = RobotConfig(block.model, block.joints, block.end_effector, (), block.base)
    robot_models = add_robot(parser, replace(config, packages=block.packages, xacro=xacro)).models
    names = _names(plant.get_joint(i) for i in plant.GetJointIndices())
    other = scenario.recorded_on
    if other is not None and set(other.joints) <= names and not set(block.joints) <= names:
        raise ModelError(
            f"no joint '{next(name for name in block.joints if name not in names)}' in this model; "
            "it has the joints of the robot that recordings were made on",
            remedy=f"Change that robot's model with: --set recorded_on.model={model}",
            file=model,
        )
    parked = {name: value for name, value in block.parked.items() if name in names}
    links = _names(plant.get_body(i) for model in robot_models for i in plant.GetBodyIndices(model))
    known = {"table", *links, *(o.name for o in scenario.objects)}
    known |= {o.name for o in scenario.obstacles}
    if block.tool is not None and block.tool.shape is not None:
        known.add("tool")
    ignored = tuple(pair for pair in block.ignore_collisions if known.issuperset(pair))
    robot = block.model_copy(update={"parked": parked, "ignore_collisions": ignored})
    if block.tool is not None:
        touches = tuple(name for name in block.tool.touches if name in known)
        tool = block.tool.model_copy(update={"touches": touches})
        robot = robot.model_copy(update={"tool": tool})
    return scenario.model_copy(update={"robot": robot})


def _names(parts: Iterable[Joint | RigidBody]) -> set[str]:
    """What parts may be called: by their names, or with their model's."""
    return {name for part in parts for name in (part.name(), scoped(part))}
