"""What an exported plan is made for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from drake_screw.typing import Array

PERIOD = 0.01
"""s, between samples of an exported trajectory; the recorder's own."""


@dataclass(frozen=True, eq=False)
class Setting:
    """What a plan is made for; an exporter that has a parameter `setting` is given it.

    Attributes:
        base: name of the link or frame that the poses are seen from, the robot's base.
        X_WO: poses (4, 4) of the objects, by their names.
        robot: name of its model.
        task: what is done, in words.
    """

    base: str = ""
    X_WO: Mapping[str, Array] = field(default_factory=dict)
    robot: str = ""
    task: str = ""


NOWHERE = Setting()
"""Nothing is known but the plan."""
