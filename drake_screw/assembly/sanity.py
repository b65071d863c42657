"""What a scenario's numbers must agree with once its robot's model is known."""

from __future__ import annotations

import numpy as np

from drake_screw.errors import ScenarioError
from drake_screw.robot import Arm
from drake_screw.scenario.schema import Scenario
from drake_screw.tasks import WorkArea

TOOL = 0.5
"""m. The end effector is never farther than this from the object that it works on."""


def check_start(scenario: Scenario, arm: Arm) -> None:
    """Check that the start configuration is strictly inside the joint limits.

    Raises:
        ScenarioError: it is not.
    """
    start = np.array(scenario.robot.start, dtype=float)
    margin = arm.margin(start)
    if (margin <= 0.0).any():
        i = int(np.argmin(margin))
        raise ScenarioError(
            f"robot.start: {arm.joint_names[i]} starts at {start[i]:.4f} rad, outside "
            f"its limits {arm.lower[i]:.4f} .. {arm.upper[i]:.4f}",
            remedy="Start from a configuration that is strictly inside all joint limits.",
            file=scenario.source,
        )


def check_reach(scenario: Scenario, arm: Arm, area: WorkArea) -> None:
    """Check that some of the work area can be reached.

    Raises:
        ScenarioError: none of an object's can.
    """
    chain = arm.screw_chain()
    for i, item in enumerate(area.objects):
        nearest = np.clip(chain.shoulder[:2], item.lower[:2], item.upper[:2])
        away = float(np.linalg.norm(np.append(nearest, item.z) - chain.shoulder))
        if away > chain.reach + TOOL:
            raise ScenarioError(
                f"objects.{i}: the work area of '{item.name}' is out of reach: its nearest "
                f"point is {away:.2f} m from the shoulder, the end effector gets "
                f"{chain.reach:.2f} m",
                remedy="Move the work area towards the robot; x, y and z are in metres, "
                f"seen from '{scenario.robot.base}'.",
                file=scenario.source,
            )
