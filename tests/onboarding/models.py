"""A small arm of six joints as makers write theirs, with whatever hangs on it."""

from __future__ import annotations

AXES = ("0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1")
OUT = (0.2, 0.2, 0.45, 0.2, 0.25, 0.12)
"""m, from one joint to the next."""

LIMIT = '<limit lower="-2.6" upper="2.6" velocity="2" effort="100"/>'
INERTIAL = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
)
GRIPPER = "".join(
    f'<link name="{{0}}finger_{i}"><collision><origin xyz="0 0 0.03"/><geometry>'
    f'<box size="0.01 0.02 0.06"/></geometry></collision>{INERTIAL}</link>'
    f'<joint name="{{0}}finger_joint_{i}" type="prismatic"><parent link="{{0}}link_6"/>'
    f'<child link="{{0}}finger_{i}"/><origin xyz="{{1}}" rpy="{{2}}"/><axis xyz="{side} 0 0"/>'
    '<limit lower="0" upper="0.05" velocity="1" effort="10"/></joint>'
    for i, side in ((1, 1), (2, -1))
)


def links_and_joints(
    prefix: str = "", parent: str = "base", at: str = "0 0 0.2", gripper: bool = True
) -> str:
    """An arm that begins on a link; all of its names begin with the prefix."""
    text, before = "", parent
    for i, (axis, out) in enumerate(zip(AXES, OUT, strict=True), start=1):
        place = at if i == 1 else f"0 0 {OUT[i - 2]}"
        text += (
            f'<link name="{prefix}link_{i}"><visual><origin xyz="0 0 {out / 2}"/><geometry>'
            f'<cylinder radius="0.04" length="{out}"/></geometry></visual>{INERTIAL}</link>'
            f'<joint name="{prefix}joint_{i}" type="revolute"><parent link="{before}"/>'
            f'<child link="{prefix}link_{i}"/><origin xyz="{place}"/><axis xyz="{axis}"/>{LIMIT}'
            "</joint>"
        )
        before = f"{prefix}link_{i}"
    return text + (GRIPPER.format(prefix, "0 0 0.12", "0 0 0") if gripper else "")


def frame(name: str, parent: str, rpy: str, xyz: str = "0 0 0.12") -> str:
    """A link without shape, fixed to another."""
    return (
        f'<link name="{name}"/><joint name="{name}_joint" type="fixed"><parent link="{parent}"/>'
        f'<child link="{name}"/><origin xyz="{xyz}" rpy="{rpy}"/></joint>'
    )


def joint(name: str, kind: str, parent: str, child: str, limit: str = LIMIT, at: str = "") -> str:
    """Another joint and the link that it moves."""
    return (
        f'<link name="{child}">{INERTIAL}</link><joint name="{name}" type="{kind}">'
        f'<parent link="{parent}"/><child link="{child}"/><origin xyz="{at or "0 0 0"}"/>'
        f'<axis xyz="0 0 1"/>{limit}</joint>'
    )


def robot(*parts: str) -> str:
    """The URDF text of a robot whose root is "base"."""
    return f'<robot name="small"><link name="base">{INERTIAL}</link>{"".join(parts)}</robot>'
