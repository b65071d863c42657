"""The axis of the hand about which its roll is best left free, for an arm of five joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from drake_screw.robot import ScrewChain
from drake_screw.robot.directions import has, missing_turn
from drake_screw.screws import exp

HALFWAY: Mapping[str, float] = {"pouring": np.deg2rad(48.0), "scooping": np.deg2rad(33.0)}
"""rad, half of the roll about the hand's z axis, from level, that a task asks for."""

DIGITS = 2


def free_axis(
    chain: ScrewChain, q: Sequence[float], task: str
) -> tuple[float, float, float] | None:
    """An axis (3,) in E; None where the arm can do without, or lacks more than a turn.

    An arm of five joints lacks one turn of the hand on the spot, and can follow position and axis
    where that turn is not at right angles to the axis. As the hand rolls about its z axis during
    the task, the turn it lacks moves to the other side in E; halfway is the best of axes.

    Args:
        chain: the arm.
        q: (n,) the start.
        task: "pouring" or "scooping".
    """
    if chain.n != 5 or has(chain):
        return None
    lacks = missing_turn(chain, np.array([q]))[0]
    back = exp(np.array([0.0, 0.0, -HALFWAY[task], 0.0, 0.0, 0.0]))[:3, :3]
    axis = np.round(back @ lacks / max(np.linalg.norm(lacks), 1e-9), DIGITS) + 0.0
    if not axis.any() or not has(chain, axis):
        return None
    x, y, z = axis.tolist()
    return x, y, z
