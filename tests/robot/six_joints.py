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
    lift: tuple[float, float] | None = None,
    extra: str = "",
) -> str:
    """The model; its frame "hand" is a link.

    Args:
        transmissions: joints that have one, in the order of the tags.
        order: of the joints in the file.
        limits: attributes of <limit> beside the positions' for some joints; LIMIT for the others.
        shapes: collision geometries of some links, as URDF text.
        inertia: whether links have one, or which.
        lift: the range in m of a joint "lift" below the others, if there is to be one.
        extra: more of the model.
    """
    parts = ["<robot name='six'>"]
    joints, links = dict(_JOINTS), list(_LINKS)
    if lift is not None:
        joints["lift"] = ("base", "column", "0 0 0", "0 0 1", "prismatic", lift)
        joints["j1"] = ("column", *joints["j1"][1:])
        links.append("column")
    for link in links:
        inertial = ""
        if inertia is True or (inertia and link in inertia):
            inertial = (
                "<inertial><origin xyz='0 0 0.05'/><mass value='1'/><inertia ixx='0.01' iyy='0.01' "
                "izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>"
            )
        shape = (shapes or {}).get(link, "")
        hull = shape and f"<collision name='{link}_hull'>{shape}</collision>"
        parts.append(f"<link name='{link}'>{inertial}{hull}</link>")
    for name in order or joints:
        parent, child, xyz, axis, kind, (lower, upper) = joints[name]
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


def fingers(gap: float = 0.0, *, half: float = 0.0123) -> str:
    """Two fingers of boxes on the hand, so far apart (m) where they rest: more of the model.

    Args:
        gap: m.
        half: m, of a finger's thickness.
    """
    parts = []
    for name, side in (("left", 1), ("right", -1)):
        y = side * (half + gap / 2.0)
        parts.append(
            f"<link name='{name}'><inertial><mass value='0.1'/><inertia ixx='1e-4' iyy='1e-4' "
            "izz='1e-4' ixy='0' ixz='0' iyz='0'/></inertial>"
            f"<collision name='{name}_box'><origin xyz='0 {y} 0.03'/>"
            f"<geometry><box size='0.02 {2 * half} 0.06'/></geometry></collision></link>"
            f"<joint name='{name}_slide' type='prismatic'><parent link='hand'/>"
            f"<child link='{name}'/><origin xyz='0 0 0.05'/><axis xyz='0 {side} 0'/>"
            "<limit lower='0' upper='0.04' velocity='1' effort='10'/></joint>"
        )
    return "".join(parts)


def scenario(
    model: str = "six.urdf", *, robot: str = "", more: str = "", lift: float | None = None
) -> str:
    """A scenario of pouring with the arm, as YAML text.

    Args:
        model: file of the model.
        robot: more lines of the block `robot`, indented by two.
        more: further blocks.
        lift: m, where the joint "lift" starts, if it belongs to the arm.
    """
    names = NAMES if lift is None else ("lift", *NAMES)
    start = START if lift is None else (lift, *START)
    return f"""
name: six
robot:
  model: {model}
  joints: [{", ".join(names)}]
  end_effector: hand
  start: [{", ".join(map(str, start))}]
{robot}
table: {{center: [0.35, 0.0], size: [1.1, 1.3], top: 0.0}}
objects:
  - {{name: bowl, x: [0.5, 0.7], y: [-0.2, 0.2], z: 0.0, radius: 0.08, height: 0.06}}
regions:
  grid: {{x: 1, y: 2}}
coverage: {{beta: 0.7, epsilon: 0.15}}
teacher: {{kind: simulated, motion: pouring}}
{more}
"""
