"""What of a workcell is said before a run: arms, tools, objects, and how far away they are."""

from __future__ import annotations

from itertools import product

import numpy as np

from drake_screw.assembly.arm_setup import ArmSetup
from drake_screw.assembly.hints import hints
from drake_screw.assembly.preview_parts import PreviewedArm, PreviewedObject, PreviewedTool
from drake_screw.assembly.sanity import looks_aside
from drake_screw.assembly.setup import Setup


def previewed_arm(one: ArmSetup) -> PreviewedArm:
    """An arm that is planned for, by its name where there are several."""
    arm, several = one.arm, one.among_several
    return PreviewedArm(
        one.workcell.model_file.stem,
        arm.joint_names,
        arm.end_effector,
        arm.screw_chain().reach,
        one.name if several else None,
        previewed_tool(one) if several else None,
    )


def previewed_tool(one: ArmSetup) -> PreviewedTool | None:
    """What an arm holds, if that has a shape."""
    tool = one.robot.tool
    if tool is None:
        return None
    return PreviewedTool(str(tool.shape.solid), tool.frame, tool.touches)


def previewed_objects(setup: Setup) -> tuple[PreviewedObject, ...]:
    """Where the objects may stand."""
    found = []
    for o in setup.area.objects:
        x, y, yaw, _, roll, pitch = zip(o.least, o.greatest, strict=True)
        found.append(PreviewedObject(o.name, x, y, yaw, o.z, roll, pitch, o.any_orientation, o.on))
    return tuple(found)


def farthest_corner(setup: Setup) -> float:
    """m, of the work area from the shoulder, or the nearest of several shoulders."""
    corners = []
    for i, o in enumerate(setup.area.objects):
        x, y, _, z, *_ = zip(o.least, o.greatest, strict=True)
        X_WP = setup.area.X_WP(i)
        corners += [X_WP[:3, :3] @ corner + X_WP[:3, 3] for corner in product(x, y, z)]
    shoulders = [one.arm.screw_chain().shoulder for one in setup.arms]
    away = np.linalg.norm(np.array(corners)[:, None] - np.array(shoulders), axis=2)
    return float(away.min(axis=1).max())


def all_hints(setup: Setup) -> tuple[str, ...]:
    """What is likely to go wrong with any arm, each sentence once."""
    found = (hints(setup.scenario, one.arm, one.start) for one in setup.arms)
    return tuple(dict.fromkeys(sentence for each in found for sentence in each))


def all_that_look_aside(setup: Setup) -> str | None:
    """What is to be said of end effectors that do not point out of the hand."""
    places = (setup.scenario.robot.place(one.number) for one in setup.arms)
    found = [looks_aside(one.workcell, at) for one, at in zip(setup.arms, places, strict=True)]
    return "; ".join(said for said in found if said is not None) or None
