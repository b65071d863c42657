"""The turns that a scenario declares to leave its task as it is."""

from __future__ import annotations

from pydrake.math import RollPitchYaw

from drake_screw.planning import Symmetries
from drake_screw.robot import Arm
from drake_screw.scenario.robot_blocks import ToolBlock
from drake_screw.scenario.schema import Scenario
from drake_screw.screws import pose
from drake_screw.tasks import Symmetry


def symmetries(scenario: Scenario, arm: Arm, tool: ToolBlock | None) -> Symmetries:
    """Of the objects, and of the tool that an arm's end effector holds.

    Raises:
        ModelError: the tool's frame is not one that the end effector carries.
    """
    objects = object_symmetries(scenario)
    tried, chain = scenario.planner.turns, arm.screw_chain()
    if tool is None:
        return Symmetries.of(chain, objects, tried=tried)
    rotation = RollPitchYaw(tool.rpy).ToRotationMatrix().matrix()
    X_ET = arm.held(tool.frame or arm.end_effector) @ pose(rotation, tool.xyz)
    held = None if tool.symmetry is None else tool.symmetry.symmetry
    return Symmetries.of(chain, objects, held, X_ET, tried)


def object_symmetries(scenario: Scenario) -> list[Symmetry | None]:
    """Of each object, None where it has none."""
    return [None if o.symmetry is None else o.symmetry.symmetry for o in scenario.objects]
