"""Materials of a URDF that Drake would refuse the whole model for."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable

PLAIN = "0.7 0.7 0.7 1"
"""Colour of what has none that can be had."""


def mend_materials(root: ET.Element, has_file: Callable[[str], bool]) -> bool:
    """Make materials such that Drake takes them; returns whether anything had to be changed.

    A texture that is missing goes; what is then, or was before, without any looks becomes grey;
    and where a name is defined otherwise before, the material is given another one: as ROS reads
    it, a material that a link defines is that link's.

    Args:
        root: of the model.
        has_file: whether there is a file at an address in the model.
    """
    changed = False
    defined: dict[str, tuple[str, ...]] = {}
    materials = list(root.iter("material"))
    for material in materials:
        texture = material.find("texture")
        if texture is not None and not has_file(texture.get("filename", "").strip()):
            material.remove(texture)
            if material.find("color") is None:
                ET.SubElement(material, "color", rgba=PLAIN)
            changed = True
        name, looks = material.get("name"), _looks(material)
        if not name or not looks:
            continue
        own, number = name, 2
        while defined.setdefault(own, looks) != looks:
            own, number = f"{name}_{number}", number + 1
        if own != name:
            material.set("name", own)
            changed = True
    for material in materials:
        if not _looks(material) and (name := material.get("name")) and name not in defined:
            ET.SubElement(material, "color", rgba=PLAIN)
            defined[name] = _looks(material)
            changed = True
    return changed


def _looks(material: ET.Element) -> tuple[str, ...]:
    """What it is defined as; nothing where it is only referred to."""
    color, texture = material.find("color"), material.find("texture")
    found = [" ".join(color.get("rgba", "").split())] if color is not None else []
    return (*found, *([texture.get("filename", "")] if texture is not None else []))
