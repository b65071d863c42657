"""The robot in Drake: workcell, arm, and the arm as a product of exponentials."""

from drake_screw.robot.arm import Arm
from drake_screw.robot.obstacles import ObstacleConfig
from drake_screw.robot.parts import ObjectConfig, RobotConfig, TableConfig
from drake_screw.robot.screw_chain import ScrewChain
from drake_screw.robot.shapes import (
    BoxShape,
    CylinderShape,
    MeshShape,
    PlacedShape,
    SphereShape,
)
from drake_screw.robot.tool import ToolConfig
from drake_screw.robot.workcell import Workcell, build_workcell

__all__ = [
    "Arm",
    "BoxShape",
    "CylinderShape",
    "MeshShape",
    "ObjectConfig",
    "ObstacleConfig",
    "PlacedShape",
    "RobotConfig",
    "ScrewChain",
    "SphereShape",
    "TableConfig",
    "ToolConfig",
    "Workcell",
    "build_workcell",
]
