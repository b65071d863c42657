"""Groups of joints that an SRDF names, as arms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from pydrake.multibody.tree import JointIndex

from drake_screw.errors import ModelError
from drake_screw.onboarding.arms import LEAST, FoundArm, arm_of, find_arms
from drake_screw.onboarding.joint_tree import JointTree
from drake_screw.onboarding.reading import Robot
from drake_screw.robot.names import called
from drake_screw.robot.srdf import Group, srdf_with


def arms_by_name(robot: Robot) -> tuple[FoundArm, ...]:
    """All arms: those that are found, called as its SRDF calls them, and its other groups.

    Raises:
        ModelError: there is none.
    """
    groups = _group_arms(robot)
    try:
        found = find_arms(robot)
    except ModelError:
        if not groups:
            raise
        return groups
    names = {arm.joints: arm.name for arm in reversed(groups)}
    others = (arm for arm in groups if arm.joints not in {other.joints for other in found})
    return (*(replace(a, name=names.get(a.joints, a.name)) for a in found), *others)


def _group_arms(robot: Robot) -> tuple[FoundArm, ...]:
    """Groups whose joints are one behind the other, and enough for an arm."""
    srdf = srdf_with(robot.given)
    if srdf is None:
        return ()
    tree, groups = JointTree(robot.plant), {group.name: group for group in srdf.groups}
    arms = []
    for group in srdf.groups:
        own = _joints(tree, group, groups, ())
        own -= {j for j in own if tree.name(j) in robot.mimics}
        last = max(own, key=lambda j: len(tree.way[j]), default=None)
        if last is not None and len(own) >= LEAST and own <= set(tree.way[last]):
            arms.append(arm_of(tree, tuple(j for j in tree.way[last] if j in own), group.name))
    return tuple(arms)


def _joints(
    tree: JointTree, group: Group, groups: Mapping[str, Group], inside: Sequence[str]
) -> set[JointIndex]:
    """Joints of a group that move: named, before a link that is named, on a chain, of a part."""
    found = set()
    for index in tree.moving:
        joint = tree.joint(index)
        named = any(called(joint, name) for name in group.joints)
        if named or any(called(joint.child_body(), name) for name in group.links):
            found.add(index)
    for base, tip in group.chains:
        found |= set(tree.between(base, tip))
    for name in group.groups:
        if name in groups and name not in (*inside, group.name):
            found |= _joints(tree, groups[name], groups, (*inside, group.name))
    return found
