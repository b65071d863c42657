"""Another robot model in a scenario, with the same names for what the scenario plans with."""

from __future__ import annotations

import os
from collections.abc import Container, Iterable
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
from drake_screw.scenario.robot_blocks import ToolBlock
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
    joints = tuple(name for arm in block.each_arm for name in arm.joints)
    first = block.each_arm[0]
    config = RobotConfig(place, first.joints, first.end_effector, (), block.base)
    robot_models = add_robot(parser, replace(config, packages=block.packages, xacro=xacro)).models
    names = _names(plant.get_joint(i) for i in plant.GetJointIndices())
    other = scenario.recorded_on
    if other is not None and set(other.joints) <= names and not set(joints) <= names:
        raise ModelError(
            f"no joint '{next(name for name in joints if name not in names)}' in this model; "
            "it has the joints of the robot that recordings were made on",
            remedy=f"Change that robot's model with: --set recorded_on.model={model}",
            file=model,
        )
    parked = {name: value for name, value in block.parked.items() if name in names}
    links = _names(plant.get_body(i) for model in robot_models for i in plant.GetBodyIndices(model))
    known = {"table", *links, *(o.name for o in scenario.objects)}
    known |= {o.name for o in scenario.obstacles}
    for arm in block.each_arm:
        if arm.tool is not None and arm.tool.shape is not None:
            known.add("tool" if block.arms is None else f"{arm.name}_tool")
    ignored = tuple(pair for pair in block.ignore_collisions if known.issuperset(pair))
    robot = block.model_copy(update={"parked": parked, "ignore_collisions": ignored})
    if block.arms is not None:
        arms = tuple(arm.model_copy(update={"tool": _kept(arm.tool, known)}) for arm in block.arms)
        robot = robot.model_copy(update={"arms": arms})
    else:
        robot = robot.model_copy(update={"tool": _kept(block.tool, known)})
    return scenario.model_copy(update={"robot": robot})


def _kept(tool: ToolBlock | None, known: Container[str]) -> ToolBlock | None:
    """A tool, with what it may touch as far as that is known."""
    if tool is None:
        return None
    return tool.model_copy(update={"touches": tuple(n for n in tool.touches if n in known)})


def _names(parts: Iterable[Joint | RigidBody]) -> set[str]:
    """What parts may be called: by their names, or with their model's."""
    return {name for part in parts for name in (part.name(), scoped(part))}
