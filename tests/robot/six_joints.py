"""An arm of six joints with a finger, as URDF text that can be told what to leave out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

NAMES = ("j1", "j2", "j3", "j4", "j5", "j6")
START = (0.6, 0.5, 1.9, 0.0, -0.83, 0.0)

LIMIT = 'velocity="2" effort="100"'
_LINKS = ("base", "shoulder", "upper_arm", "forearm", "wrist", "palm", "hand", "fingertip")
_JOINTS = {
    "j1": ("base", "shoulder", "0 0 0.2", "0 0 1", "revolute", (-2.9, 2.9)),
    "j2": ("shoulder", "upper_arm", "0 0 0.2", "0 1 0", "revolute", (-2.0, 2.0)),
    "j3": ("upper_arm", "forearm", "0 0 0.45", "0 1 0", "revolute", (-2.6, 2.6)),
    "j4": ("forearm", "wrist", "0 0 0.2", "0 0 1", "revolute", (-2.9, 2.9)),
    "j5": ("wrist", "palm", "0 0 0.25", "0 1 0", "revolute", (-2.1, 2.1)),
    "j6": ("palm", "hand", "0 0 0.12", "0 0 1", "revolute", (-3.1, 3.1)),
    "finger": ("hand", "fingertip", "0 0 0.05", "0 1 0", "prismatic", (0.0, 0.05)),
}


def urdf(
    *,
    transmissions: Sequence[str] = (),
    order: Sequence[str] | None = None,
    limits: Mapping[str, str] | None = None,
    shapes: Mapping[str, str] | None = None,
    inertia: bool | Sequence[str] = True,
    extra: str = "",
) -> str:
    """The model; its frame "hand" is a link.

    Args:
        transmissions: joints that have one, in the order of the tags.
        order: of the joints in the file.
        limits: attributes of <limit> beside the positions' for some joints; LIMIT for the others.
        shapes: collision geometries of some links, as URDF text.
        inertia: whether links have one, or which.
        extra: more of the model.
    """
    parts = ["<robot name='six'>"]
    for link in _LINKS:
        inertial = ""
        if inertia is True or (inertia and link in inertia):
            inertial = (
                "<inertial><origin xyz='0 0 0.05'/><mass value='1'/><inertia ixx='0.01' iyy='0.01' "
                "izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>"
            )
        shape = (shapes or {}).get(link, "")
        hull = shape and f"<collision name='{link}_hull'>{shape}</collision>"
        parts.append(f"<link name='{link}'>{inertial}{hull}</link>")
    for name in order or _JOINTS:
        parent, child, xyz, axis, kind, (lower, upper) = _JOINTS[name]
        limit = f"<limit lower='{lower}' upper='{upper}' {(limits or {}).get(name, LIMIT)}/>"
        parts.append(
            f"<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>"
            f"<origin xyz='{xyz}'/><axis xyz='{axis}'/>{limit}</joint>"
        )
    parts += [
        f"<transmission name='t_{name}'><type>transmission_interface/SimpleTransmission</type>"
        f"<joint name='{name}'><hardwareInterface>EffortJointInterface</hardwareInterface>"
        f"</joint><actuator name='m_{name}'/></transmission>"
        for name in transmissions
    ]
    return "".join([*parts, extra, "</robot>"])
