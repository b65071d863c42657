"""Joint limits in a model's text that cannot be meant."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

from drake_screw.errors import ModelError


def check_joint_limits(root: ET.Element, file: Path) -> None:
    """Refuse joint limits that no motion keeps, by the joint's name.

    Args:
        root: of a URDF or SDF model.
        file: named in the error.

    Raises:
        ModelError: a lower limit above its upper limit, or a velocity limit below 0.
    """
    for name, limit in _limits(root):
        lower, upper, velocity = (_number(limit, what) for what in ("lower", "upper", "velocity"))
        if lower is not None and upper is not None and lower > upper:
            raise ModelError(
                f"joint '{name}': its lower limit {lower:g} is above its upper limit {upper:g}",
                remedy="Exchange them, say.",
                file=file,
            )
        if velocity is not None and velocity < 0.0 and root.tag == "robot":  # SDF's -1 is none
            raise ModelError(
                f"joint '{name}': its velocity limit {velocity:g} is below 0",
                remedy="Give the greatest speed, rad/s or m/s; 0 stands for none.",
                file=file,
            )


def _limits(root: ET.Element) -> Iterator[tuple[str, ET.Element]]:
    """Joints' names and the elements that have their limits."""
    for joint in root.iter("joint"):
        for limit in (*joint.findall("limit"), *joint.findall("axis/limit")):
            yield joint.get("name", ""), limit


def _number(limit: ET.Element, what: str) -> float | None:
    """A limit, an attribute in URDF and an element in SDF; None without one that is a number."""
    text = limit.get(what) or limit.findtext(what)
    try:
        return None if text is None else float(text)
    except ValueError:
        return None
