"""The robot in Drake: workcell, arm, and the arm as a product of exponentials."""

from drake_screw.robot.arm import Arm
from drake_screw.robot.screw_chain import ScrewChain
from drake_screw.robot.workcell import (
    ObjectConfig,
    RobotConfig,
    TableConfig,
    Workcell,
    build_workcell,
)

__all__ = [
    "Arm",
    "ObjectConfig",
    "RobotConfig",
    "ScrewChain",
    "TableConfig",
    "Workcell",
    "build_workcell",
]
