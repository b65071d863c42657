"""Another robot model in a scenario, with the same names for what the scenario plans with."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_screw.robot import RobotConfig
from drake_screw.robot.workcell import add_robot
from drake_screw.scenario.schema import ModelName, Scenario


def swap_model(scenario: Scenario, model: Path) -> Scenario:
    """The scenario on another robot model.

    The model must have the arm's joints, the base and the end effector. Other joints that are
    parked and that it lacks (those of a second arm, say) are left out.

    Raises:
        ModelError: the model cannot be read or lacks the base.
    """
    block = replace(scenario.robot, model=ModelName(str(model.resolve())))
    plant = MultibodyPlant(0.0)
    parser = Parser(plant)
    add_robot(
        parser, RobotConfig(block.model, block.joints, block.end_effector, block.start, block.base)
    )
    names = {plant.get_joint(i).name() for i in plant.GetJointIndices()}
    parked = {name: value for name, value in block.parked.items() if name in names}
    return replace(scenario, robot=replace(block, parked=parked))
