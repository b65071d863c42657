"""Joint positions as per cent of their range, as servos that were calibrated by hand give them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from drake_screw.errors import RecordingError, suggestion
from drake_screw.robot import Arm
from drake_screw.typing import Array

FULL = 100.0
"""A joint is at one end of its range at minus so much, at the other one at so much."""

BEYOND = 5.0
"""Per cent, that a servo may go beyond the range it was calibrated to."""


def of_ranges(
    raw: Array, arm: Arm, ends: Mapping[str, tuple[float, float]], file: Path | None
) -> tuple[Array, str]:
    """Joint positions (m, n) in rad and m of per cent, -100 to 100, and how they were taken.

    Args:
        raw: (m, n) in per cent; not finite where there are none.
        arm: whose limits are the range of joints of which nothing is said.
        ends: rad or m by joint, at -100 and at 100.
        file: they are from, for errors.

    Raises:
        RecordingError: a range is of no joint of the arm, a joint has neither a range nor limits,
            or the values are no per cent.
    """
    for name in ends:
        if name not in arm.joint_names:
            raise RecordingError(
                f"ends: '{name}' is no joint of the arm",
                remedy=suggestion(name, arm.joint_names, "Joints"),
                file=file,
            )
    limits = zip(arm.joint_names, arm.lower.tolist(), arm.upper.tolist(), strict=True)
    both = np.array([ends.get(name, (lower, upper)) for name, lower, upper in limits])
    endless = [
        name for name, end in zip(arm.joint_names, both, strict=True) if not np.isfinite(end).all()
    ]
    if endless:
        raise RecordingError(
            f"per cent of what? {', '.join(endless)} has no limits",
            remedy=f"Say it under ends: {{{endless[0]}: [-3.14, 3.14]}}.",
            file=file,
        )
    most = float(np.nanmax(np.abs(raw), initial=0.0))
    if most > FULL + BEYOND:
        raise RecordingError(
            f"angles: percent, but there is a {most:g}; expected -100 to 100",
            remedy="Say angles: deg, or angles: rad.",
            file=file,
        )
    assumed = [name for name in arm.joint_names if name not in ends]
    said = "per cent of each joint's range, as said"
    if assumed:
        which = "all" if len(assumed) == arm.n else ", ".join(assumed)
        said += f"; of {which} that is taken to be the model's limits"
    return both[:, 0] + (raw + FULL) / (2.0 * FULL) * (both[:, 1] - both[:, 0]), said
