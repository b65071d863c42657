"""What a scenario says of its workcell, as its parts take it."""

from __future__ import annotations

from dataclasses import replace

from drake_screw.robot import (
    BoxShape,
    CylinderShape,
    MeshShape,
    ObjectConfig,
    ObstacleConfig,
    PlacedShape,
    RobotConfig,
    SphereShape,
    TableConfig,
    ToolConfig,
)
from drake_screw.robot.parts import turned_frame
from drake_screw.robot.srdf import start_state
from drake_screw.scenario.schema import Scenario
from drake_screw.scenario.shape_blocks import ShapeBlock
from drake_screw.tasks import ObjectArea, WorkArea


def robot_config(scenario: Scenario) -> RobotConfig:
    """Which arm of which model, and what it holds.

    Raises:
        ModelError: it starts in a state of an SRDF file that does not have it.
    """
    block = scenario.robot
    start = block.start
    robot = RobotConfig(
        str(block.model),
        block.joints,
        block.end_effector,
        () if isinstance(start, str) else start,
        block.base,
        block.parked,
        tool_config(scenario),
        velocity_limits=block.velocity_limits,
        ignore_collisions=block.ignore_collisions,
        end_effector_rotation=block.end_effector_rotation,
        packages=block.packages,
        xacro=block.xacro,
        srdf=block.srdf,
    )
    return replace(robot, start=start_state(robot, start)) if isinstance(start, str) else robot


def tool_config(scenario: Scenario) -> ToolConfig | None:
    """What the end effector holds, if that has a shape."""
    block = scenario.robot.tool
    if block is None or block.shape is None:
        return None
    robot = scenario.robot
    turned = robot.end_effector_rotation is not None
    own = turned_frame(robot.end_effector) if turned else robot.end_effector
    frame = block.frame or own
    return ToolConfig(frame, placed_shape(block.shape), block.xyz, block.rpy, block.touches)


def table_config(scenario: Scenario) -> TableConfig | None:
    """The table, if there is one."""
    block = scenario.table
    if block is None:
        return None
    return TableConfig(block.center, block.size, block.top, block.thickness)


def object_configs(scenario: Scenario) -> tuple[ObjectConfig, ...]:
    """Shapes of the objects."""
    return tuple(
        ObjectConfig(o.name, o.radius, o.height, o.mass, o.friction) for o in scenario.objects
    )


def obstacle_configs(scenario: Scenario) -> tuple[ObstacleConfig, ...]:
    """Other things in the workcell."""
    return tuple(ObstacleConfig(o.name, placed_shape(o)) for o in scenario.obstacles)


def placed_shape(block: ShapeBlock) -> PlacedShape:
    """A shape, and where it is."""
    solid: BoxShape | CylinderShape | SphereShape | MeshShape
    if block.box is not None:
        solid = BoxShape(block.box)
    elif block.cylinder is not None:
        solid = CylinderShape(block.cylinder.radius, block.cylinder.length)
    elif block.sphere is not None:
        solid = SphereShape(block.sphere.radius)
    else:
        assert block.mesh is not None
        solid = MeshShape(block.mesh, 1.0 if block.scale is None else block.scale)
    return PlacedShape(solid, block.xyz, block.rpy)


def work_area(scenario: Scenario) -> WorkArea:
    """Where the objects may stand."""
    return WorkArea(
        tuple(
            ObjectArea(
                o.name,
                (o.x.lower, o.y.lower, o.yaw.lower),
                (o.x.upper, o.y.upper, o.yaw.upper),
                o.z,
            )
            for o in scenario.objects
        )
    )
