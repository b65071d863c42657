"""The arms of a robot: chains of joints from the base to a hand or a flange."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import takewhile

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, Joint, JointIndex

from drake_screw.errors import ModelError, ScenarioError, suggestion
from drake_screw.onboarding.reading import Robot
from drake_screw.robot.names import called, scoped, shown_name

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
    """

    name: str
    joints: tuple[str, ...]
    held: tuple[str, ...]
    base: str
    last_link: str
    fingers: tuple[str, ...]

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
    plant = robot.plant
    tree = _Tree(plant)
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

    It is the one that is wanted, the only one, or the left one of a pair.

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
    if len(arms) == 1:
        return arms[0], None
    pairs = [arm for arm in arms if _mirrored(arm) & {other.joints for other in arms}]
    if len(pairs) == 1 and len(arms) == 2:
        return pairs[0], f"the left one of {' and '.join(names)}"
    listed = "; ".join(f"{arm.name} ({arm.joints[0]} ... {arm.joints[-1]})" for arm in arms)
    raise ScenarioError(
        f"{len(arms)} arms are found", remedy=f"Choose one with --arm NAME. Arms: {listed}"
    )


class _Tree:
    """Joints that move, by the bodies that they move."""

    def __init__(self, plant: MultibodyPlant) -> None:
        self.plant = plant
        self.inboard: dict[BodyIndex, Joint] = {}
        for index in plant.GetJointIndices():
            joint = plant.get_joint(index)
            self.inboard[joint.child_body().index()] = joint
        self.moving = [
            index
            for index in plant.GetJointIndices()
            if plant.get_joint(index).type_name() in ("revolute", "prismatic")
        ]
        self.way = {index: self._way(index) for index in self.moving}
        self.next: dict[JointIndex, list[JointIndex]] = {index: [] for index in self.moving}
        for index, way in self.way.items():
            if len(way) > 1:
                self.next[way[-2]].append(index)

    def joint(self, index: JointIndex) -> Joint:
        return self.plant.get_joint(index)

    def name(self, index: JointIndex) -> str:
        """Plain where that tells it from all others, else with its model's before it."""
        joint = self.plant.get_joint(index)
        alike = [
            i for i in self.plant.GetJointIndices() if called(self.plant.get_joint(i), joint.name())
        ]
        return str(joint.name()) if len(alike) == 1 else scoped(joint)

    def _way(self, index: JointIndex) -> tuple[JointIndex, ...]:
        """Moving joints from the root to this one."""
        way, moving = [index], set(self.moving)
        body = self.plant.get_joint(index).parent_body().index()
        while body in self.inboard:
            joint = self.inboard[body]
            if joint.index() in moving:
                way.append(joint.index())
            body = joint.parent_body().index()
        return tuple(reversed(way))

    def root(self, index: JointIndex) -> str:
        """The link at the world, or the first that is fixed to it, on the way to a joint."""
        body = self.plant.get_joint(index).parent_body()
        world = self.plant.world_body().index()
        while body.index() in self.inboard:
            parent = self.inboard[body.index()].parent_body()
            if parent.index() == world:
                break
            body = parent
        return shown_name(body)

    def paths(self) -> list[tuple[JointIndex, ...]]:
        """From the root to each end."""
        return [self.way[index] for index in self.moving if not self.next[index]]

    def depth(self, index: JointIndex) -> int:
        """Joints of the longest chain from this one on."""
        return 1 + max((self.depth(j) for j in self.next[index]), default=0)

    def behind(self, index: JointIndex) -> list[JointIndex]:
        """Joints behind this one, nearest first."""
        return [j for child in self.next[index] for j in (child, *self.behind(child))]


def _without_fingers(
    tree: _Tree, path: tuple[JointIndex, ...], mimics: frozenset[str]
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


def _arm(tree: _Tree, chain: tuple[JointIndex, ...]) -> FoundArm:
    first = 0
    while len(chain) - first > FULL and _belongs_to_the_body(tree, chain[first]):
        first += 1
    joints = tuple(map(tree.name, chain[first:]))
    last = tree.joint(chain[-1])
    return FoundArm(
        name=_name(joints) or shown_name(last.child_body()),
        joints=joints,
        held=tuple(map(tree.name, chain[:first])),
        base=tree.root(chain[0]),
        last_link=shown_name(last.child_body()),
        fingers=tuple(map(tree.name, tree.behind(chain[-1]))),
    )


def _belongs_to_the_body(tree: _Tree, index: JointIndex) -> bool:
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
