"""How fast joints may move, where the model does not say, too.

Planning does without. What gives a motion its time law (a simulated teacher, exports, executions)
needs a limit for every joint.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from pydrake.multibody.tree import Joint

from drake_screw.errors import ModelError, suggestion
from drake_screw.typing import Array

TURNING = 1.0
"""rad/s, of a revolute joint without a limit."""
SLIDING = 0.25
"""m/s, of a prismatic one."""


def velocity_limits(
    joints: Sequence[Joint], given: Mapping[str, float], names: Sequence[str]
) -> tuple[Array, tuple[str, ...]]:
    """The arm's velocity limits, each finite and above 0.

    Args:
        joints: the arm's n joints, each with one degree of freedom.
        given: rad/s or m/s, limits that hold in place of the model's, by names.
        names: what the joints are called there.

    Returns:
        (n,) rad/s or m/s, and the names of joints that no one states a limit of.

    Raises:
        ModelError: a name is none of the joints'.
    """
    for name in given:
        if name not in names:
            raise ModelError(
                f"robot.velocity_limits: '{name}' is no joint of the arm",
                remedy=suggestion(name, list(names), "Joints"),
            )
    limits, assumed = [], []
    for joint, name in zip(joints, names, strict=True):
        stated = given.get(name, float(joint.velocity_upper_limits()[0]))
        if not (np.isfinite(stated) and stated > 0.0):
            stated = TURNING if joint.type_name() == "revolute" else SLIDING
            assumed.append(name)
        limits.append(stated)
    return np.array(limits), tuple(assumed)


def assumed_in_words(assumed: Sequence[str], units: Mapping[str, str]) -> tuple[str, ...]:
    """A line that names joints without a velocity limit, and what is taken; none without any.

    Args:
        assumed: names of joints.
        units: "rad" or "m" of each joint, by its name.
    """
    parts = [
        f"{value:g} {unit}/s for {', '.join(of_unit)}"
        for unit, value in (("rad", TURNING), ("m", SLIDING))
        if (of_unit := [name for name in assumed if units[name] == unit])
    ]
    if not parts:
        return ()
    return (
        f"no velocity limit in the model: {' and '.join(parts)} taken, in what is timed or "
        "simulated (robot.velocity_limits says otherwise)",
    )
