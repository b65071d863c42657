"""In which order a simulated robot's joints come at each of the plant's ports.

Positions, velocities and actuators of a Drake plant are each numbered on their own, and none of
them as the arm's joints are.
"""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from drake_screw.robot import Arm
from drake_screw.typing import Array


def joint_places(plant: MultibodyPlant, robot: ModelInstanceIndex, arm: Arm) -> tuple[Array, Array]:
    """Where the arm's joints stand among the robot's N positions (n,), and where those rest (N,).

    Those of the arm rest at 0, which is to be replaced.
    """
    place = plant.GetPositionsFromArray(robot, np.arange(plant.num_positions(), dtype=float))
    columns = [
        int(np.flatnonzero(place == plant.GetJointByName(name, robot).position_start())[0])
        for name in arm.joint_names
    ]
    resting = arm.full_positions(np.zeros(arm.n))
    parked = np.zeros(len(place))
    for index in plant.GetJointIndices(robot):
        joint = plant.get_joint(index)
        if joint.num_positions() == 1:
            own = arm.plant.GetJointByName(joint.name()).position_start()
            parked[place == joint.position_start()] = resting[own]
    return np.array(columns), parked


def measured_state(plant: MultibodyPlant, robot: ModelInstanceIndex, arm: Arm) -> Array:
    """(2n, N + M) picks the arm's q and v out of the robot's N positions and M velocities."""
    q = plant.GetPositionsFromArray(robot, np.arange(plant.num_positions(), dtype=float))
    v = plant.GetVelocitiesFromArray(robot, np.arange(plant.num_velocities(), dtype=float))
    pick = np.zeros((2 * arm.n, len(q) + len(v)))
    for i, name in enumerate(arm.joint_names):
        joint = plant.GetJointByName(name, robot)
        pick[i, : len(q)] = q == joint.position_start()
        pick[arm.n + i, len(q) :] = v == joint.velocity_start()
    return pick


def desired_state(
    plant: MultibodyPlant, robot: ModelInstanceIndex, arm: Arm, parked: Array
) -> tuple[Array, Array]:
    """How the plant's desired state is made of the arm's.

    Drake has it in the order of the actuators, which is that of the model's transmissions as far
    as there are any, and not that of joints or positions.

    Args:
        plant: finalized.
        robot, arm: what is driven.
        parked: (N,) where the robot's joints rest, in the order of its positions.

    Returns:
        Where the arm's q and v (2n,) go among those of the A actuators (2A, 2n), and what all
        others are told (2A,).
    """
    place = plant.GetPositionsFromArray(robot, np.arange(plant.num_positions(), dtype=float))
    driven = [plant.get_joint_actuator(i).joint() for i in plant.GetJointActuatorIndices(robot)]
    A, n = len(driven), arm.n
    spread, rest = np.zeros((2 * A, 2 * n)), np.zeros(2 * A)
    for a, joint in enumerate(driven):
        if joint.name() in arm.joint_names:
            i = arm.joint_names.index(joint.name())
            spread[a, i] = spread[A + a, n + i] = 1.0
        else:
            rest[a] = parked[place == joint.position_start()][0]
    return spread, rest
