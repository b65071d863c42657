"""What drives the joints of a simulated robot, and what has to be known of the robot for it."""

from __future__ import annotations

from collections.abc import Sequence

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    BodyIndex,
    Joint,
    JointActuator,
    JointIndex,
    ModelInstanceIndex,
    PdControllerGains,
)

from drake_screw.robot.names import called
from drake_screw.typing import Array

STIFFNESS = 80.0  # 1/rad: position gains as multiples of a joint's greatest effort
DAMPING = 0.05  # s: velocity gains as multiples of position gains
LAG = 5e-3  # s: by no more than what a joint moves in that time does its friction hold it back
UNRATED = 100.0  # N m, greatest effort assumed for gains where the model states none that is true
MOST_EFFORT = 1e4  # N m; more than this is no statement
NEGLIGIBLE = 1e-12  # kg m^2 (kg, where it slides): no inertia at all


def motorise(plant: MultibodyPlant, robot: Sequence[ModelInstanceIndex]) -> None:
    """Position control of every joint with one degree of freedom, within the model's efforts."""
    driven = _motors(plant)
    for joint in _single(plant, robot):
        actuator = driven.get(joint.index()) or plant.AddJointActuator(joint.name(), joint)
        effort = actuator.effort_limit()
        p = STIFFNESS * (effort if effort < MOST_EFFORT else UNRATED)
        p = max(p, float(joint.default_damping_vector()[0]) / LAG)
        actuator.set_controller_gains(PdControllerGains(p=p, d=DAMPING * p))


def assumed_motors(
    plant: MultibodyPlant, robot: Sequence[ModelInstanceIndex], names: Sequence[str]
) -> tuple[str, ...]:
    """A line on those of the named joints whose greatest effort the model does not state, if any.

    Args:
        plant: with the model as it was read, without motors of ours.
        robot: its models.
        names: of joints.
    """
    driven = _motors(plant)

    def rated(joint: Joint) -> bool:
        motor = driven.get(joint.index())
        return motor is not None and motor.effort_limit() < MOST_EFFORT

    joints = {name: j for name in names for j in _single(plant, robot) if called(j, name)}
    unrated = [name for name, joint in joints.items() if not rated(joint)]
    if not unrated:
        return ()
    return (
        "no motor with an effort limit in the model (in URDF, a transmission): "
        f"{', '.join(unrated)} driven without limit, as stiffly as by {UNRATED:g} N m",
    )


def immovable(
    plant: MultibodyPlant, robot: Sequence[ModelInstanceIndex], positions: Array
) -> tuple[str, tuple[str, ...]] | None:
    """A joint that moves nothing with inertia, so that it cannot be simulated; None if all do.

    Args:
        plant: finalized.
        robot: whose joints to look at.
        positions: (plant.num_positions(),).

    Returns:
        Its name, and the names of the links without mass that it moves.
    """
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, positions)
    M = plant.CalcMassMatrix(context)
    for joint in _single(plant, robot):
        at = joint.velocity_start()
        if not M[at, at] > NEGLIGIBLE:
            moved = plant.GetBodiesKinematicallyAffectedBy([joint.index()])
            bodies = (plant.get_body(BodyIndex(index)) for index in moved)
            light = [b.name() for b in bodies if not b.get_mass(context) > 0.0]
            return joint.name(), tuple(light)
    return None


def _motors(plant: MultibodyPlant) -> dict[JointIndex, JointActuator]:
    """The model's first motor of each joint that has one."""
    found: dict[JointIndex, JointActuator] = {}
    for index in plant.GetJointActuatorIndices():
        actuator = plant.get_joint_actuator(index)
        found.setdefault(actuator.joint().index(), actuator)
    return found


def _single(plant: MultibodyPlant, robot: Sequence[ModelInstanceIndex]) -> list[Joint]:
    """The robot's joints with one degree of freedom."""
    joints = (plant.get_joint(i) for model in robot for i in plant.GetJointIndices(model))
    return [joint for joint in joints if joint.num_velocities() == 1]
