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
