"""Small robot models written out as text, and arms made of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_screw.robot import Arm

INERTIAL = (
    "<inertial><mass>1</mass><inertia>"
    "<ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>"
)


@dataclass(frozen=True)
class JointText:
    """A joint, the pose "x y z roll pitch yaw" of its link in the link before, and its limits."""

    name: str
    pose: str
    axis: str = "0 0 1"
    kind: str = "revolute"
    limits: tuple[float, float] | None = (-2.5, 2.5)
    parent: str | None = None

    @property
    def link(self) -> str:
        return f"{self.name}_link"


SEVEN = (
    JointText("a1", "0.1 0.2 0.3 0.1 0 0.2"),
    JointText("a2", "0.05 0 0.1 1.5 0.1 0"),
    JointText("a3", "0.1 0.3 0 -1.5 0 0.1", limits=(-2.0, 1.5)),
    JointText("a4", "0 0.02 0.2 1.6 0 0"),
    JointText("a5", "0 0.2 0.1 -1.5 0.2 0"),
    JointText("a6", "0.03 0 0.1 1.5 0 0"),
    JointText("a7", "0 0.1 0 -1.6 0 0.3", axis="0 1 1"),
)
SLIDING = (
    JointText("rail", "0 0 0.2 0 0.1 0", axis="1 0 0", kind="prismatic", limits=(-0.2, 0.6)),
    JointText("turn", "0 0.1 0.3 0 0 0"),
    JointText("tilt", "0.1 0 0.1 1.5 0 0"),
    JointText("reach", "0.2 0 0 0 0 0.3", axis="1 0.5 0", kind="prismatic", limits=(0.0, 0.4)),
    JointText("roll", "0.3 0 0 0 1.5 0"),
)
PLANAR = (
    JointText("p1", "0 0 0.5 0 0 0"),
    JointText("p2", "0.4 0 0 0 0 0"),
    JointText("p3", "0.3 0 0 0 0 0"),
)


def sdf(
    joints: Sequence[JointText],
    *,
    base: str = "base",
    hand: str = "0.1 0 0.05 0.3 0.2 0.1",
    shapes: Mapping[str, str] | None = None,
    extra: str = "",
) -> str:
    """A model whose frame "hand" is fixed to the last link.

    `shapes` gives links an SDF geometry each.
    """
    parts = [f"<link name='{base}'>{_shape(base, shapes)}</link>"]
    before = base
    for joint in joints:
        parent = joint.parent or before
        limit = ""
        if joint.limits is not None:
            limit = "<limit><lower>{}</lower><upper>{}</upper></limit>".format(*joint.limits)
        axis = f"<axis><xyz>{joint.axis}</xyz>{limit}</axis>"
        parts.append(
            f"<link name='{joint.link}'><pose relative_to='{parent}'>{joint.pose}</pose>"
            f"{INERTIAL}{_shape(joint.link, shapes)}</link>"
            f"<joint name='{joint.name}' type='{joint.kind}'><parent>{parent}</parent>"
            f"<child>{joint.link}</child>{'' if joint.kind in ('fixed', 'ball') else axis}</joint>"
        )
        before = joint.link
    last = joints[-1].link
    frame = (
        f"<frame name='hand' attached_to='{last}'><pose relative_to='{last}'>{hand}</pose></frame>"
    )
    body = "".join(parts) + frame + extra
    return f"<?xml version='1.0'?><sdf version='1.9'><model name='small'>{body}</model></sdf>"


def plant_of(text: str, *, suffix: str = ".sdf", base: str = "base") -> MultibodyPlant:
    """A finalized plant of a model's text, its base fixed to the world."""
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(text, suffix)
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(base))
    plant.Finalize()
    return plant


def arm_of(joints: Sequence[JointText], **kwargs: object) -> Arm:
    """The arm of all movable joints of a model."""
    names = [joint.name for joint in joints if joint.kind in ("revolute", "prismatic")]
    return Arm(plant_of(sdf(joints)), names, "hand", **kwargs)


def _shape(link: str, shapes: Mapping[str, str] | None) -> str:
    if not shapes or link not in shapes:
        return ""
    return f"<collision name='{link}_hull'><geometry>{shapes[link]}</geometry></collision>"
