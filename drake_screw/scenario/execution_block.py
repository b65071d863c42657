"""What a scenario file may say of executions: what they may do, and what is not known exactly."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from drake_screw.scenario.block import Block
from drake_screw.scenario.values import METRES, RADIANS

NEWTONS = Field(json_schema_extra={"unit": "N"})
Deviation = Annotated[float, Field(ge=0.0, le=1.0)]


class NoiseBlock(Block):
    object_position: Annotated[Deviation, METRES] = 0.0
    """standard deviation of x and of y at which an object is measured, from where it stands"""
    object_yaw: Annotated[Deviation, RADIANS] = 0.0
    """standard deviation of the yaw at which an object is measured; one that may be turned by any
    angle about z has none to mistake"""
    joint_offset: Annotated[Deviation, RADIANS] = 0.0
    """standard deviation of each revolute joint of the arm from what its encoder says, the same for
    a whole execution"""
    slide_offset: Annotated[Deviation, METRES] = 0.0
    """standard deviation of each prismatic joint, likewise"""


class ExecutionBlock(Block):
    position: Annotated[Annotated[float, Field(gt=0.0)], METRES] = 0.01
    """distance that the end effector may be from where it ought to be at that time"""
    rotation: Annotated[Annotated[float, Field(gt=0.0)], RADIANS] = 0.1
    """angle that it may be turned from how it ought to be at that time"""
    displacement: Annotated[Annotated[float, Field(gt=0.0)], METRES] = 0.002
    """distance that an object may be pushed, where objects are free"""
    turn: Annotated[Annotated[float, Field(gt=0.0)], RADIANS] = 0.05
    """angle that an object may be turned or tipped, where objects are free"""
    contact_force: Annotated[Annotated[float, Field(ge=0.0)], NEWTONS] = 0.0
    """force with which the robot may touch something; with 0 it must touch nothing"""
    noise: NoiseBlock = NoiseBlock()
    """what is not known exactly when instances are executed for a certificate (`coverage.success:
    execution`): normally distributed about 0, and drawn for each instance"""
