"""What MoveIt's description of a robot (SRDF) adds to its model: pairs, groups and states."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from drake_screw.errors import ModelError, suggestion
from drake_screw.robot.model_xml import parse_model
from drake_screw.robot.packages import ModelPlace, Packages, split_address
from drake_screw.robot.parts import RobotConfig
from drake_screw.robot.xacro_text import SUFFIX, expand


class IgnoredPair(NamedTuple):
    """Two links that are not looked at for touching one another, and why."""

    a: str
    b: str
    reason: str


@dataclass(frozen=True)
class Group:
    """Joints or links that go by one name, such as an arm.

    Attributes:
        name: of the group.
        joints, links: that it names.
        chains: pairs of its base link and its tip.
        groups: names of others that are part of it.
    """

    name: str
    joints: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    chains: tuple[tuple[str, str], ...] = ()
    groups: tuple[str, ...] = ()


@dataclass(frozen=True)
class GroupState:
    """A configuration that has a name; positions in rad or m by joint."""

    name: str
    group: str
    positions: Mapping[str, float]


@dataclass(frozen=True)
class Srdf:
    """An SRDF file.

    Attributes:
        file: it was read from.
        pairs: links that may touch one another.
        groups: arms, hands and the like.
        states: named configurations, of joints that have one position.
    """

    file: Path
    pairs: tuple[IgnoredPair, ...]
    groups: tuple[Group, ...]
    states: tuple[GroupState, ...]


def srdf_file(name: str, packages: Packages) -> Path:
    """The path of an SRDF file given by its path or its address in a package.

    Raises:
        ModelError: there is no such file, or no such package.
    """
    file = packages.path(name, Path())
    if not file.is_file():
        known = "" if split_address(name) is None else f" ('{name}')"
        raise ModelError(
            f"there is no such SRDF file{known}",
            remedy="Mend `srdf` in the scenario's robot, or leave it out.",
            file=file,
        )
    return file


def read_srdf(file: Path, packages: Packages | None = None) -> Srdf:
    """Read an SRDF file; one in xacro is expanded.

    Raises:
        ModelError: it cannot be read, or is not SRDF.
    """
    try:
        is_xacro = file.suffix.lower() == SUFFIX
        text = expand(file, {}, packages or Packages(near=file)) if is_xacro else file.read_bytes()
        root = parse_model(text)
    except (OSError, ET.ParseError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise ModelError(f"this SRDF cannot be read: {reason}", file=file) from error
    if root.tag != "robot" or root.find("joint/parent") is not None:
        raise ModelError(
            "not SRDF: expected groups and pairs of links in a 'robot'"
            if root.tag != "robot"
            else "a robot's model and not SRDF",
            remedy="Name the .srdf file that came with the model's MoveIt configuration.",
            file=file,
        )
    return Srdf(file, tuple(_pairs(root)), tuple(_groups(root)), tuple(_states(root, file)))


def state_positions(srdf: Srdf, name: str, joints: Sequence[str]) -> tuple[float, ...]:
    """Positions of joints, in rad or m, in a state.

    Args:
        srdf: has the state; several groups may have one of a name, and count together.
        name: of the state, or `GROUP/NAME`.
        joints: names.

    Raises:
        ModelError: there is no such state, it lacks a joint, or has two positions for one.
    """
    group, _, own = name.rpartition("/")
    named = [s for s in srdf.states if s.name == name]
    named = named or [s for s in srdf.states if s.name == own and group == s.group]
    if not named:
        raise ModelError(
            f"no state '{name}' in this SRDF",
            remedy=suggestion(name, dict.fromkeys(s.name for s in srdf.states), "States"),
            file=srdf.file,
        )
    found: dict[str, float] = {}
    for joint in joints:
        values = {s.positions[joint]: s.group for s in named if joint in s.positions}
        if not values:
            raise ModelError(
                f"state '{name}' has no position for joint '{joint}'",
                remedy=f"It has one for: {', '.join(k for s in named for k in s.positions)}. "
                "Give robot.start as numbers, or another state.",
                file=srdf.file,
            )
        if len(values) > 1:
            raise ModelError(
                f"state '{name}' has {len(values)} positions for joint '{joint}'",
                remedy=f"Say which: {' or '.join(f'{g}/{name}' for g in values.values())}.",
                file=srdf.file,
            )
        found[joint] = next(iter(values))
    return tuple(found[joint] for joint in joints)


def srdf_of(robot: RobotConfig) -> Path | None:
    """The file of a robot's SRDF, if it has one.

    Raises:
        ModelError: it cannot be found.
    """
    return None if robot.srdf is None else srdf_file(robot.srdf, _packages(robot))


def srdf_with(robot: RobotConfig) -> Srdf | None:
    """A robot's SRDF, if it has one.

    Raises:
        ModelError: it cannot be found or read.
    """
    file = srdf_of(robot)
    return None if file is None else read_srdf(file, _packages(robot))


def start_state(robot: RobotConfig, name: str) -> tuple[float, ...]:
    """Angles of the arm's joints in a state of the robot's SRDF.

    Raises:
        ModelError: there is no SRDF, or it lacks the state or a joint of it.
    """
    srdf = srdf_with(robot)
    if srdf is None:
        raise ModelError(f"there is no SRDF file with a state '{name}'", file=robot.model)
    return state_positions(srdf, name, robot.joints)


def _packages(robot: RobotConfig) -> Packages:
    return ModelPlace(robot.model, robot.packages).packages


def _pairs(root: ET.Element) -> Iterator[IgnoredPair]:
    seen = set()
    for entry in root.iterfind("disable_collisions"):
        a, b = entry.get("link1", ""), entry.get("link2", "")
        if a and b and a != b and frozenset((a, b)) not in seen:
            seen.add(frozenset((a, b)))
            yield IgnoredPair(a, b, entry.get("reason", "") or "no reason given")


def _groups(root: ET.Element) -> Iterator[Group]:
    def names(group: ET.Element, tag: str) -> tuple[str, ...]:
        return tuple(e.get("name", "") for e in group.iterfind(tag))

    for group in root.iterfind("group"):
        chains = tuple(
            (c.get("base_link", ""), c.get("tip_link", "")) for c in group.iterfind("chain")
        )
        yield Group(
            group.get("name", ""),
            names(group, "joint"),
            names(group, "link"),
            chains,
            names(group, "group"),
        )


def _states(root: ET.Element, file: Path) -> Iterator[GroupState]:
    for state in root.iterfind("group_state"):
        positions = {}
        for joint in state.iterfind("joint"):
            name, words = joint.get("name", ""), joint.get("value", "").split()
            try:
                values = [float(word) for word in words]
            except ValueError:
                raise ModelError(
                    f"state '{state.get('name')}' has '{joint.get('value')}' for joint '{name}'",
                    remedy="A number is expected, in rad or m.",
                    file=file,
                ) from None
            if len(values) == 1:
                positions[name] = values[0]
        yield GroupState(state.get("name", ""), state.get("group", ""), positions)
