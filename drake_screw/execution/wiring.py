"""In which order a simulated robot's joints come at each of the plant's ports.

Positions, velocities and actuators of a Drake plant are each numbered on their own, and none of
them as the arm's joints are. Actuators have a port for each model that the robot is made of.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex, RigidBody
from pydrake.systems.framework import DiagramBuilder, OutputPort
from pydrake.systems.primitives import Adder, ConstantVectorSource, Gain, MatrixGain

from drake_screw.robot import Arm
from drake_screw.typing import Array


def resting(plant: MultibodyPlant, arm: Arm) -> Array:
    """Where the plant's positions rest (N,), with those of the arm's joints at 0.

    Args:
        plant: finalized; its defaults are where the robot's joints are parked.
        arm: of that plant.
    """
    parked = np.array(plant.GetDefaultPositions())
    parked[[joint.position_start() for joint in arm.joints]] = 0.0
    return parked


def measured_state(plant: MultibodyPlant, arm: Arm) -> Array:
    """(2n, N + M) picks an arm's q and v out of its plant's N positions and M velocities."""
    N, M = plant.num_positions(), plant.num_velocities()
    pick = np.zeros((2 * arm.n, N + M))
    for i, joint in enumerate(arm.joints):
        pick[i, joint.position_start()] = 1.0
        pick[arm.n + i, N + joint.velocity_start()] = 1.0
    return pick


def free_bodies(plant: MultibodyPlant, bodies: Sequence[RigidBody]) -> Array:
    """(7k, N + M) picks the positions of free bodies, one after the other, out of a plant's state.

    Args:
        plant: finalized, with N positions and M velocities.
        bodies: k of them.
    """
    pick = np.zeros((7 * len(bodies), plant.num_positions() + plant.num_velocities()))
    for i, body in enumerate(bodies):
        start = body.floating_positions_start()
        pick[7 * i : 7 * i + 7, start : start + 7] = np.eye(7)
    return pick


def encoders(
    builder: DiagramBuilder, n: int, state: OutputPort
) -> tuple[ConstantVectorSource, OutputPort, Adder]:
    """An arm's encoders, which may be off: they show less than its state by a constant.

    The motors hold the joints by them, so what the joints are told is off by as much.

    Args:
        builder: to add them to.
        n: joints of the arm.
        state: (2n,) q and v as they are.

    Returns:
        The source of the offsets (2n,); the state that they show (2n,); and what adds them to
        what the joints are told, at input port 0.
    """
    offsets = builder.AddNamedSystem("joint_offsets", ConstantVectorSource(np.zeros(2 * n)))
    less = builder.AddNamedSystem("less_offsets", Gain(-1.0, 2 * n))
    read = builder.AddNamedSystem("encoders", Adder(2, 2 * n))
    command = builder.AddNamedSystem("command_of_encoders", Adder(2, 2 * n))
    builder.Connect(offsets.get_output_port(), less.get_input_port())
    builder.Connect(state, read.get_input_port(0))
    builder.Connect(less.get_output_port(), read.get_input_port(1))
    builder.Connect(offsets.get_output_port(), command.get_input_port(1))
    return offsets, read.get_output_port(), command


def desired_state(
    plant: MultibodyPlant, model: ModelInstanceIndex, arm: Arm
) -> tuple[Array, Array]:
    """How the desired state of one model is made of the arm's.

    Drake has it in the order of the actuators, which is that of the model's transmissions as far
    as there are any, and not that of joints or positions.

    Args:
        plant: finalized; its defaults are where the robot's joints are parked.
        model: of the robot.
        arm: of that plant.

    Returns:
        Where the arm's q and v (2n,) go among those of the A actuators (2A, 2n), and what all
        others are told (2A,).
    """
    parked = resting(plant, arm)
    driven = [plant.get_joint_actuator(i).joint() for i in plant.GetJointActuatorIndices(model)]
    number = {joint.index(): i for i, joint in enumerate(arm.joints)}
    A, n = len(driven), arm.n
    spread, rest = np.zeros((2 * A, 2 * n)), np.zeros(2 * A)
    for a, joint in enumerate(driven):
        if joint.index() in number:
            i = number[joint.index()]
            spread[a, i] = spread[A + a, n + i] = 1.0
        else:
            rest[a] = parked[joint.position_start()]
    return spread, rest


def drive(
    builder: DiagramBuilder,
    plant: MultibodyPlant,
    models: Sequence[ModelInstanceIndex],
    arm: Arm,
    desired: OutputPort,
) -> None:
    """Connect the arm's desired state [q; v] (2n,) to the motors of all models of its robot."""
    motorised = [model for model in models if plant.GetJointActuatorIndices(model)]
    for model in motorised:
        of = f"_{plant.GetModelInstanceName(model)}" if len(motorised) > 1 else ""
        to_motors, rest = desired_state(plant, model, arm)
        spread = builder.AddNamedSystem(f"robot_of_arm{of}", MatrixGain(to_motors))
        idle = builder.AddNamedSystem(f"idle_joints{of}", ConstantVectorSource(rest))
        command = builder.AddNamedSystem(f"joint_command{of}", Adder(2, len(rest)))
        builder.Connect(desired, spread.get_input_port())
        builder.Connect(spread.get_output_port(), command.get_input_port(0))
        builder.Connect(idle.get_output_port(), command.get_input_port(1))
        builder.Connect(command.get_output_port(), plant.get_desired_state_input_port(model))
