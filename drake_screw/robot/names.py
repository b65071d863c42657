"""Names in a plant, of a robot's own parts above all: plain, or scoped by their model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    BodyIndex,
    Frame,
    FrameIndex,
    Joint,
    ModelInstanceIndex,
    RigidBody,
)

from drake_screw.errors import ModelError, unknown

Instances = Sequence[ModelInstanceIndex]
"""The models that a robot is made of."""

_Part = TypeVar("_Part", Frame, Joint, RigidBody)


def find_frame(
    plant: MultibodyPlant,
    name: str,
    robot: Instances | None = None,
    *,
    kind: str = "frame",
    where: str = "the robot model",
) -> Frame:
    """The frame of that name; frames of links are called as the links.

    Args:
        plant: with the frame.
        name: plain, or scoped where two models have it: "left::hand".
        robot: only frames of these models; of all where None.
        kind, where: what is looked for, and in what, as messages call them.

    Raises:
        ModelError: there is none, or more than one.
    """
    frames = [plant.get_frame(FrameIndex(i)) for i in range(plant.num_frames())]
    made = _made_by_drake(plant)
    return _the_one(kind, name, _of(frames, robot), lambda F: F.name() not in made, where)


def find_joint(plant: MultibodyPlant, name: str, robot: Instances | None = None) -> Joint:
    """The joint of that name; see `find_frame`."""
    joints = [plant.get_joint(i) for i in plant.GetJointIndices()]
    return _the_one("joint", name, _of(joints, robot), lambda j: j.num_positions() == 1)


def find_body(
    name: str,
    bodies: Sequence[RigidBody],
    *,
    key: str,
    kind: str,
    many: str,
    where: str,
    choices: Sequence[RigidBody],
) -> RigidBody:
    """The body of that name, plain or scoped, among some that a key of the scenario speaks of.

    Args:
        name: as the scenario has it.
        bodies: among which.
        key: of the scenario, "robot.tool.touches".
        kind, many, where: what it is, what several are, and where it is looked for, in messages.
        choices: bodies that messages list.

    Raises:
        ModelError: there is none, or more than one.
    """
    matches = [body for body in bodies if called(body, name)]
    if len(matches) == 1:
        return matches[0]
    if matches:
        raise ModelError(
            f"{key}: {len(matches)} {many} are called '{name}'",
            remedy=f"Name one with its model: {', '.join(map(scoped, matches))}",
        )
    message, remedy = unknown(kind, name, where, [body.name() for body in choices])
    raise ModelError(f"{key}: {message}", remedy=remedy)


def called(part: Frame | Joint | RigidBody, name: str) -> bool:
    """Whether a part goes by a name: its own, or that with its model's before it."""
    return name in (part.name(), scoped(part))


def scoped(part: Frame | Joint | RigidBody) -> str:
    """A part's name with that of its model before it, "left::hand"."""
    model = part.GetParentPlant().GetModelInstanceName(part.model_instance())
    return f"{model}::{part.name()}"


def shown_name(body: RigidBody) -> str:
    """A body's name as people are shown it: scoped only where another body has the plain one."""
    plant = body.GetParentPlant()
    names = [plant.get_body(BodyIndex(i)).name() for i in range(plant.num_bodies())]
    alike = names.count(body.name())
    return body.name() if alike == 1 else scoped(body)


def _of(parts: Sequence[_Part], robot: Instances | None) -> list[_Part]:
    if robot is None:
        return list(parts)
    return [part for part in parts if part.model_instance() in robot]


def _the_one(
    kind: str,
    name: str,
    parts: Sequence[_Part],
    listed: Callable[[_Part], bool],
    where: str = "the robot model",
) -> _Part:
    matches = [part for part in parts if called(part, name)]
    if len(matches) == 1:
        return matches[0]
    if matches:
        raise ModelError(
            f"{len(matches)} {kind}s are called '{name}'",
            remedy=f"Name one of them with its model: {', '.join(sorted(map(scoped, matches)))}",
        )
    plain = [part.name() for part in parts]
    choices = [
        part.name() if plain.count(part.name()) == 1 else scoped(part)
        for part in parts
        if listed(part)
    ]
    message, remedy = unknown(kind, name, where, choices)
    raise ModelError(message, remedy=remedy)


def _made_by_drake(plant: MultibodyPlant) -> set[str]:
    """Names of the frames that Drake makes for joints and welds, and of the world."""
    joints = [plant.get_joint(i).name() for i in plant.GetJointIndices()]
    frames = [plant.get_frame(FrameIndex(i)).name() for i in range(plant.num_frames())]
    made = {f"{joint}_{end}" for joint in joints for end in ("parent", "child")}
    made |= {f"{joint}_{name}_{end}" for joint in joints for name in frames for end in ("F", "M")}
    return {"world", *made, *(name for name in frames if name.startswith("_"))}


def check_apart(plant: MultibodyPlant, kind: str, names: Iterable[str]) -> None:
    """Check that things to be added to a plant are named unlike one another and all models there.

    Each will be a model of its own, so links, frames and joints of the robot may be called alike.

    Args:
        plant: before they are added.
        kind: what they are, with its article: "an object".
        names: theirs.

    Raises:
        ModelError: one is not.
    """
    instances = map(ModelInstanceIndex, range(plant.num_model_instances()))
    taken = set(map(plant.GetModelInstanceName, instances))
    for name in names:
        if name in taken:
            raise ModelError(
                f"the name '{name}' of {kind} is taken",
                remedy="Name it unlike the table, other objects and obstacles, and the robot's "
                "model.",
            )
        taken.add(name)
