"""Marks on an object's rim: how it is turned, and which turns leave it as it is."""

from __future__ import annotations

import numpy as np

from drake_screw.tasks import Symmetry
from drake_screw.typing import Array


def mark_angles(symmetry: Symmetry | None) -> Array | None:
    """Angles in rad about the object's z axis, from its x axis, at which its rim has a mark.

    One at x where it has no symmetry about z, else one for each turn that leaves it the same; None
    for a body of revolution, which has no mark that could show a turn.

    >>> mark_angles(Symmetry(turns=4)).round(2).tolist(), mark_angles(None).tolist()
    ([0.0, 1.57, 3.14, 4.71], [0.0])
    """
    if symmetry is None or abs(symmetry.axis[2]) < 1.0 - 1e-9:
        return np.zeros(1)
    if symmetry.turns is None:
        return None
    return 2.0 * np.pi * np.arange(symmetry.turns) / symmetry.turns
