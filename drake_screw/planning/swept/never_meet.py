"""Links that cannot touch, whatever the joints between them do: they need not be looked at."""

from __future__ import annotations

import numpy as np

from drake_screw.planning.swept.along import Touches, say_if_it_takes_long, touches_along
from drake_screw.planning.swept.cell import Cell, room_for
from drake_screw.screws.endless import within_a_turn
from drake_screw.typing import Array

SPACING = 0.1
"""rad (or m), between the values of the first of two joints at which the second one is swept."""

MOST = 2
"""Joints between two links at most; of more, there would be too much to look at."""


def never_meet(cell: Cell) -> bool:
    """Whether two links of an arm stay apart within the joint limits.

    The last joint between them is swept through its range. If there is another one, that is done
    at values SPACING apart of that one, with as much more clearance as it may take away in between.

    Args:
        cell: looks at all pairs of shapes of the two links, and at no others.
    """
    a, b = cell.pairs[0]
    joints = np.arange(cell.joint[a] + 1, cell.joint[b] + 1)
    lower, upper = within_a_turn(*cell.limits[:, joints])
    if len(joints) > MOST or not (np.isfinite(lower).all() and np.isfinite(upper).all()):
        return False
    values, more = np.zeros(1), 0.0
    if len(joints) == MOST:
        parts = int(np.ceil((upper[0] - lower[0]) / SPACING)) + 1
        values = np.linspace(lower[0], upper[0], parts)
        half = 0.5 * (upper[0] - lower[0]) / max(parts - 1, 1)
        more = half * max(_lever(cell, joints, int(b)) for b in np.unique(cell.pairs[:, 1]))
    q = np.zeros((len(values), 5, cell.limits.shape[1]))
    q[:, 0, joints[-1]], q[:, 1, joints[-1]] = lower[-1], upper[-1]
    q[:, 2:4, joints[-1]] = upper[-1] - lower[-1]
    if len(joints) == MOST:
        q[:, :2, joints[0]] = values[:, None]
    # The joints before the two links do not matter; they stay where they may be.
    still = np.setdiff1d(np.arange(q.shape[2]), joints)
    q[:, :2, still] = np.clip(0.0, *cell.limits[:, still])
    found = Touches.none(len(q), q.shape[2])
    k = int(cell.object.max(initial=-1)) + 1
    X_WO = np.broadcast_to(np.eye(4), (len(q), k, 4, 4))
    wider = cell._replace(clearance=cell.clearance + more)
    say_if_it_takes_long()
    first = np.arange(len(q) + 1)
    touches_along(wider, room_for(wider), q, first, np.ascontiguousarray(X_WO), found)
    return bool((found.step < 0).all() and (found.questions == 0).all())


def _lever(cell: Cell, joints: Array, b: int) -> float:
    """m for a rad (or m) of the first of two joints that a point of shape b moves at most.

    The second joint turns it about a point of its axis, which the first one moves along.
    """
    S1, S2 = cell.screws[joints]
    center, reach = cell.X_WG[b, :, 3], float(cell.reach[b])
    if np.linalg.norm(S1[:3]) < 0.5:
        return 1.0
    turns = np.linalg.norm(S2[:3]) > 0.5
    on_axis = center
    if turns:
        foot = np.cross(S2[:3], S2[3:])
        on_axis = foot + S2[:3] * ((center - foot) @ S2[:3])
        reach += float(np.linalg.norm(center - on_axis))
    else:
        reach += float(np.abs(cell.limits[:, joints[1]]).max())
    return float(np.linalg.norm(np.cross(S1[:3], on_axis) + S1[3:])) + reach
