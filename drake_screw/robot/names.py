"""Names in a plant: each stands for one thing."""

from __future__ import annotations

from collections.abc import Iterable

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FrameIndex, ModelInstanceIndex

from drake_screw.errors import ModelError


def taken_names(plant: MultibodyPlant) -> set[str]:
    """Names of a plant's model instances, frames (those of its bodies among them) and joints."""
    instances = map(ModelInstanceIndex, range(plant.num_model_instances()))
    frames = map(FrameIndex, range(plant.num_frames()))
    return {
        *map(plant.GetModelInstanceName, instances),
        *(plant.get_frame(i).name() for i in frames),
        *(plant.get_joint(i).name() for i in plant.GetJointIndices()),
    }


def given_frames(plant: MultibodyPlant) -> list[str]:
    """Names that people gave to frames of a robot's model, those of its links among them.

    Not the world, what stands around, or the frames that Drake makes for joints and welds.
    """
    joints = [plant.get_joint(i) for i in plant.GetJointIndices()]
    moving = [joint for joint in joints if joint.num_positions() == 1]
    robots = {joint.model_instance() for joint in moving}
    if plant.is_finalized():
        carried = plant.GetBodiesKinematicallyAffectedBy([joint.index() for joint in moving])
        robots |= {plant.get_body(index).model_instance() for index in carried}
    frames = [plant.get_frame(FrameIndex(i)) for i in range(plant.num_frames())]
    names = {frame.name() for frame in frames}
    made = {f"{joint.name()}_{end}" for joint in joints for end in ("parent", "child")}
    made |= {
        f"{joint.name()}_{name}_{end}" for joint in joints for name in names for end in ("F", "M")
    }
    return [
        frame.name()
        for frame in frames
        if frame.model_instance() in robots
        and frame.name() not in made
        and not frame.name().startswith("_")
    ]


def check_apart(plant: MultibodyPlant, kind: str, names: Iterable[str]) -> None:
    """Check that things to be added to a plant are named unlike one another and all there is.

    Args:
        plant: before they are added.
        kind: what they are, with its article: "an object".
        names: theirs.

    Raises:
        ModelError: one is not.
    """
    taken = taken_names(plant)
    for name in names:
        if name in taken:
            raise ModelError(
                f"the name '{name}' of {kind} is taken",
                remedy="Name it unlike the table, other objects and obstacles, and the robot's "
                "links, frames and joints.",
            )
        taken.add(name)
