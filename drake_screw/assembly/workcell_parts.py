"""What a scenario says of its workcell, as its parts take it."""

from __future__ import annotations

from drake_screw.robot import ObjectConfig, RobotConfig, TableConfig
from drake_screw.scenario.schema import Scenario
from drake_screw.tasks import ObjectArea, WorkArea


def robot_config(scenario: Scenario) -> RobotConfig:
    """Which arm of which model."""
    block = scenario.robot
    return RobotConfig(
        str(block.model),
        block.joints,
        block.end_effector,
        block.start,
        block.base,
        block.parked,
    )


def table_config(scenario: Scenario) -> TableConfig | None:
    """The table, if there is one."""
    block = scenario.table
    if block is None:
        return None
    return TableConfig(block.center, block.size, block.top, block.thickness)


def object_configs(scenario: Scenario) -> tuple[ObjectConfig, ...]:
    """Shapes of the objects."""
    return tuple(ObjectConfig(o.name, o.radius, o.height) for o in scenario.objects)


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
