"""Joints that mimic another one, as fingers do: where they rest follows from where that rests."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from drake_screw.errors import ModelError
from drake_screw.robot.names import called, find_joint


@dataclass(frozen=True)
class Mimic:
    """``follower = multiplier * leader + offset``, rad or m."""

    follower: str
    leader: str
    multiplier: float = 1.0
    offset: float = 0.0


def mimics_in(file: Path, model: str | None = None) -> tuple[Mimic, ...]:
    """What a URDF, SDF or MJCF file says of joints that mimic others.

    A file of another kind, or one that cannot be parsed, says nothing: that is left to Drake.

    Args:
        file: the model's.
        model: put before the names of joints, where a directive gives the model one.
    """
    try:
        root = ET.parse(file).getroot()
        found = tuple(_mimics(root))
    except (ET.ParseError, OSError, ValueError):
        return ()
    if model is None:
        return found
    return tuple(
        Mimic(f"{model}::{one.follower}", f"{model}::{one.leader}", one.multiplier, one.offset)
        for one in found
    )


def _mimics(root: ET.Element) -> Iterator[Mimic]:
    for joint in root.iter("joint"):
        for element in joint.iter():
            if element.tag.rpartition("}")[2] != "mimic":
                continue
            numbers = {
                name: float(element.get(name) or element.findtext(name) or default)
                for name, default in (("multiplier", 1.0), ("offset", 0.0), ("reference", 0.0))
            }
            offset = numbers["offset"] - numbers["multiplier"] * numbers["reference"]
            leader = element.get("joint", "")
            yield Mimic(joint.get("name", ""), leader, numbers["multiplier"], offset)
    for equality in root.iterfind("equality/joint"):
        first, second = equality.get("joint1"), equality.get("joint2")
        terms = [float(word) for word in (equality.get("polycoef") or "0 1").split()]
        if first and second and not any(terms[2:]):
            yield Mimic(first, second, terms[1] if len(terms) > 1 else 1.0, terms[0])


def follow(
    plant: MultibodyPlant,
    robot: Sequence[ModelInstanceIndex],
    mimics: Sequence[Mimic],
    *,
    joints: Collection[str],
    parked: Collection[str],
) -> None:
    """Make the defaults of joints that mimic others follow those of the others.

    Args:
        plant: before it is finalized, the defaults of its other joints set.
        robot: its models.
        mimics: which joints follow.
        joints: names of those that are planned for.
        parked: names of those that rest where they are put, whatever they mimic.

    Raises:
        ModelError: a joint of the arm follows another one, or is followed by one.
    """
    for _ in mimics:  # one may follow one that follows
        for mimic in mimics:
            follower = find_joint(plant, mimic.follower, robot)
            leader = find_joint(plant, mimic.leader, robot)
            for joint in joints:
                if called(follower, joint) or called(leader, joint):
                    raise ModelError(
                        f"joint '{mimic.follower}' mimics joint '{mimic.leader}', and "
                        f"'{joint}' is a joint of the arm",
                        remedy="An arm's joints move by themselves, and nothing else moves with "
                        "them: leave the joint out of the arm, or take <mimic> out of the model.",
                    )
            if any(called(follower, name) for name in parked):
                continue
            if leader.num_positions() == follower.num_positions() == 1:
                value = mimic.multiplier * float(leader.default_positions()[0]) + mimic.offset
                follower.set_default_positions([value])
