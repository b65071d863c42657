"""What a scenario says of its workcell, as its parts take it."""

from __future__ import annotations

from dataclasses import replace

from pydrake.math import RollPitchYaw

from drake_screw.planning.symmetry import TOOL
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
from drake_screw.robot.overlap import ObjectsOverlap
from drake_screw.robot.parts import turned_frame
from drake_screw.robot.srdf import start_state
from drake_screw.scenario.object_blocks import ObjectBlock
from drake_screw.scenario.schema import Scenario
from drake_screw.scenario.shape_blocks import ShapeBlock
from drake_screw.tasks import ObjectArea, WorkArea


def robot_configs(scenario: Scenario) -> tuple[RobotConfig, ...]:
    """Which arms of which model, and what they hold; for each arm the others rest.

    Raises:
        ModelError: one starts in a state of an SRDF file that does not have it.
    """
    block, arms = scenario.robot, scenario.robot.each_arm
    alone = [_robot_config(scenario, number) for number in range(len(arms))]
    starts = [dict(zip(one.joints, one.start, strict=False)) for one in alone]
    found = []
    for number, robot in enumerate(alone):
        others = [other for other in range(len(arms)) if other != number]
        parked = dict(block.parked)
        for other in others:
            parked |= starts[other]
        held = (_tool_config(scenario, other, turned=False) for other in others)
        found.append(
            replace(robot, parked=parked, others_hold=tuple(t for t in held if t is not None))
        )
    return tuple(found)


def _robot_config(scenario: Scenario, number: int) -> RobotConfig:
    """One arm, as if it were alone."""
    block, arm = scenario.robot, scenario.robot.each_arm[number]
    robot = RobotConfig(
        str(block.model),
        arm.joints,
        arm.end_effector,
        () if isinstance(arm.start, str) else arm.start,
        block.base,
        block.parked,
        _tool_config(scenario, number),
        velocity_limits={k: v for k, v in block.velocity_limits.items() if k in arm.joints},
        ignore_collisions=block.ignore_collisions,
        end_effector_rotation=arm.end_effector_rotation,
        packages=block.packages,
        xacro=block.xacro,
        srdf=block.srdf,
    )
    start = arm.start
    return replace(robot, start=start_state(robot, start)) if isinstance(start, str) else robot


def _tool_config(scenario: Scenario, number: int, *, turned: bool = True) -> ToolConfig | None:
    """What the end effector of an arm holds, if that has a shape.

    Args:
        scenario: says it.
        number: of the arm.
        turned: whether the plant has the end effector's frame as it is turned; the tool's pose is
            given in the frame before that otherwise.
    """
    robot, arm = scenario.robot, scenario.robot.each_arm[number]
    block = arm.tool
    if block is None or block.shape is None:
        return None
    name = TOOL if robot.arms is None else f"{arm.name}_{TOOL}"
    place = f"{robot.place(number)}.tool"
    frame, xyz, rpy = block.frame, block.xyz, block.rpy
    if arm.end_effector_rotation is not None and frame in (None, turned_frame(arm.end_effector)):
        frame = turned_frame(arm.end_effector)
        if not turned:
            R_NE = RollPitchYaw(arm.end_effector_rotation).ToRotationMatrix()
            x, y, z = R_NE.matrix() @ xyz
            frame, xyz = arm.end_effector, (float(x), float(y), float(z))
            R_NT = R_NE.multiply(RollPitchYaw(rpy).ToRotationMatrix())
            roll, pitch, yaw = RollPitchYaw(R_NT).vector()
            rpy = float(roll), float(pitch), float(yaw)
    shape = placed_shape(block.shape)
    return ToolConfig(frame or arm.end_effector, shape, xyz, rpy, block.touches, name, place)


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
    area = WorkArea(tuple(_object_area(o) for o in scenario.objects))
    if not scenario.apart:
        return area
    return area.apart(ObjectsOverlap(object_configs(scenario), area.related))


def _object_area(o: ObjectBlock) -> ObjectArea:
    return ObjectArea(
        o.name,
        (o.x.lower, o.y.lower, o.yaw.lower),
        (o.x.upper, o.y.upper, o.yaw.upper),
        o.z.written(),
        o.roll.written(),
        o.pitch.written(),
        o.orientation == "any",
        o.on,
    )
