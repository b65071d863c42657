"""The arms of a robot: chains of joints from the base to a hand or a flange."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import takewhile

import numpy as np
from pydrake.multibody.tree import JointIndex

from drake_screw.errors import ModelError, ScenarioError, suggestion
from drake_screw.onboarding.joint_tree import JointTree
from drake_screw.onboarding.reading import Robot
from drake_screw.robot.names import shown_name

FULL, MOST = 6, 7
"""Joints of an arm: from so many on the hand can be led anywhere; more than MOST are unusual."""

LEAST = 4
"""Joints below which a chain is not an arm but a head, a wheel or a finger."""

SHORT = 5
"""Joints at most of a finger."""

FINGER_TRAVEL = 0.12
"""m, the most that a sliding finger travels."""

_FINGER = re.compile(
    r"finger|gripper|grip(?!_?arm)|knuckle|thumb|index|middle|ring_|pinky|jaw|claw|robotiq|"
    r"hand_j|driver|coupler|spring_link|follower",
    re.IGNORECASE,
)
_LEG = re.compile(r"hip|knee|ankle|leg_|_leg|foot|wheel|caster|head|neck|eye", re.IGNORECASE)
_BODY = re.compile(r"torso|lift|waist|spine|rail|base|odom|column|chest|back_", re.IGNORECASE)
_LEFT = ((r"left", "right"), (r"(?<![a-z])l(?=_)", "r"), (r"(?<=_)l(?![a-z])", "r"))


@dataclass(frozen=True)
class FoundArm:
    """A chain of joints that ends in a hand.

    Attributes:
        name: what to call it by: the beginning its joints' names share, or its last link.
        joints: names, base to hand.
        held: joints between the root and the arm that are left out of it.
        base: the root link.
        last_link: that the last joint moves.
        fingers: joints behind the last one.
        only_by_name: whether it is taken only where it is asked for, as a group of joints is that
            an SRDF names.
    """

    name: str
    joints: tuple[str, ...]
    held: tuple[str, ...]
    base: str
    last_link: str
    fingers: tuple[str, ...]
    only_by_name: bool = False

    @property
    def remark(self) -> str | None:
        """What is unusual about the number of joints."""
        n = len(self.joints)
        if n < FULL:
            return f"{n} joints: the hand cannot be turned and moved in all {FULL} directions"
        return f"{n} joints: more than the usual {MOST}" if n > MOST else None


def find_arms(robot: Robot) -> tuple[FoundArm, ...]:
    """All arms, the likeliest first.

    Raises:
        ModelError: there is none.
    """
    tree = JointTree(robot.plant)
    chains: dict[tuple[JointIndex, ...], None] = {}
    for path in tree.paths():
        chain = _without_fingers(tree, path, robot.mimics)
        if len(chain) >= LEAST and not any(_LEG.search(tree.name(j)) for j in chain):
            chains[chain] = None
    longest = [c for c in chains if not any(o != c and o[: len(c)] == c for o in chains)]
    if not longest:
        raise ModelError(
            "no arm is found: no chain of at least "
            f"{LEAST} revolute or prismatic joints that ends in a hand or a flange",
            remedy=f"Joints: {', '.join(map(tree.name, tree.moving)) or 'none'}. "
            "Write the scenario by hand, see docs/another_robot.md.",
            file=robot.file,
        )
    arms = [_arm(tree, chain) for chain in longest]
    return tuple(sorted(_named_apart(arms), key=_rank))


def choose_arm(arms: Sequence[FoundArm], wanted: str | None) -> tuple[FoundArm, str | None]:
    """The arm to take, and why it is that one, where there was a choice.

    It is the one that is wanted, the only one, or the left one of a pair; one that is taken only
    by its name if there is no other.

    Raises:
        ScenarioError: there is no such arm, or several and none is wanted.
    """
    names = [arm.name for arm in arms]
    if wanted is not None:
        for arm in arms:
            if wanted in (arm.name, arm.last_link):
                return arm, None
        raise ScenarioError(
            f"no arm '{wanted}' in this model", remedy=suggestion(wanted, names, "Arms")
        )
    arms = [arm for arm in arms if not arm.only_by_name] or arms
    if len(arms) == 1:
        return arms[0], None
    names = [arm.name for arm in arms]
    pairs = [arm for arm in arms if _mirrored(arm) & {other.joints for other in arms}]
    if len(pairs) == 1 and len(arms) == 2:
        return pairs[0], f"the left one of {' and '.join(names)}"
    listed = "; ".join(f"{arm.name} ({arm.joints[0]} ... {arm.joints[-1]})" for arm in arms)
    raise ScenarioError(
        f"{len(arms)} arms are found", remedy=f"Choose one with --arm NAME. Arms: {listed}"
    )


def _without_fingers(
    tree: JointTree, path: tuple[JointIndex, ...], mimics: frozenset[str]
) -> tuple[JointIndex, ...]:
    """The part of a path before the first joint of a finger."""
    for i, index in enumerate(path):
        name = tree.name(index)
        before = tree.next[path[i - 1]] if i else []
        branches = len(before) > 1 and (i >= FULL or all(tree.depth(j) <= SHORT for j in before))
        joint = tree.joint(index)
        travel = joint.position_upper_limits()[0] - joint.position_lower_limits()[0]
        slides = joint.type_name() == "prismatic" and travel <= FINGER_TRAVEL
        late = i >= LEAST
        if name in mimics or _FINGER.search(name) or (late and (branches or slides)):
            return path[:i]
    return path


def _arm(tree: JointTree, chain: tuple[JointIndex, ...]) -> FoundArm:
    first = 0
    while len(chain) - first > FULL and _belongs_to_the_body(tree, chain[first]):
        first += 1
    return arm_of(tree, chain[first:])


def arm_of(tree: JointTree, chain: tuple[JointIndex, ...], name: str | None = None) -> FoundArm:
    """The arm of some joints, each behind the one before; by its joints' names if not called so."""
    joints, link = tuple(map(tree.name, chain)), shown_name(tree.joint(chain[-1]).child_body())
    return FoundArm(
        name=name or _name(joints) or link,
        joints=joints,
        held=tuple(tree.name(j) for j in tree.way[chain[-1]] if j not in chain),
        base=tree.root(tree.way[chain[-1]][0]),
        last_link=link,
        fingers=tuple(map(tree.name, tree.behind(chain[-1]))),
        only_by_name=name is not None,
    )


def _belongs_to_the_body(tree: JointTree, index: JointIndex) -> bool:
    """Whether a joint moves more than one arm: a lift, a waist, a rail, a base that drives."""
    branches = len(tree.next[index]) > 1
    slides = tree.joint(index).type_name() == "prismatic"
    return branches or slides or _BODY.search(tree.name(index)) is not None


def _name(joints: Sequence[str]) -> str:
    letters = zip(*joints, strict=False)
    shared = "".join(c[0] for c in takewhile(lambda c: len(set(c)) == 1, letters))
    return re.sub(r"([_-]?(joint|arm_joint|j|a|actuator))?[_\-\d]*$", "", shared)


def _named_apart(arms: Sequence[FoundArm]) -> Iterable[FoundArm]:
    names = [arm.name for arm in arms]
    for arm in arms:
        alike = names.count(arm.name) > 1
        yield FoundArm(**{**vars(arm), "name": arm.last_link}) if alike else arm


def _mirrored(arm: FoundArm) -> set[tuple[str, ...]]:
    """Joints of the arm on the other side, by every way in which names tell left from right."""
    ways = (tuple(re.sub(left, right, j) for j in arm.joints) for left, right in _LEFT)
    return {way for way in ways if way != arm.joints}


def _rank(arm: FoundArm) -> tuple[int, str]:
    n = len(arm.joints)
    return int(np.maximum(FULL - n, 0) + np.maximum(n - MOST, 0)), arm.name
