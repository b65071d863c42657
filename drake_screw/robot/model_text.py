"""Collision shapes as a model's file has them, of which Drake would make something else."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

from drake_screw.errors import ModelError

SIZES = {
    "box": ("size",),
    "capsule": ("radius", "length"),
    "cylinder": ("radius", "length"),
    "ellipsoid": ("radii",),
    "sphere": ("radius",),
}
"""What a shape has to say of itself in SDF, lengths in m."""

OTHERS = ("mesh", "plane", "empty")
"""Shapes whose sizes are not numbers."""

LARGEST = 1000.0
"""m; queries of Drake that meet a larger shape may end the process."""

HALF_AXES = ("a", "b", "c")
"""Of Drake's own ellipsoids, in place of radii."""


def check_collision_shapes(root: ET.Element, file: Path) -> None:
    """Refuse collision shapes that the reader of SDF replaces or leaves out without an error.

    A size that is missing or not above 0 is taken for 1 m, and a shape that Drake does not know is
    left out; of URDF Drake says so itself, but not of which link.

    Args:
        root: of a model, as `parse_model` has it: URDF, or SDF.
        file: it is from.

    Raises:
        ModelError: there is one.
    """
    sdf = root.tag == "sdf"
    for link in root.iter("link"):
        for collision in link.iterfind("collision"):
            for shape in collision.iterfind("geometry/*"):
                if wrong := _wrong(shape, sdf):
                    name = collision.get("name")
                    which = f"collision shape '{name}'" if name else "a collision shape"
                    raise ModelError(
                        f"{which} of link '{link.get('name')}' {wrong[0]}",
                        remedy=wrong[1],
                        file=file,
                    )


def _wrong(shape: ET.Element, sdf: bool) -> tuple[str, str] | None:
    """What is wrong with a shape, and the remedy; None if nothing is."""
    prefix, _, kind = shape.tag.rpartition(":")
    if prefix and prefix != "drake":
        return None
    if kind not in SIZES:
        if kind in OTHERS or not sdf:
            return None
        return f"is a {kind}, which Drake leaves out", f"Shapes: {', '.join([*SIZES, 'mesh'])}"
    own = HALF_AXES if kind == "ellipsoid" and (prefix or not sdf) else SIZES[kind]
    a_kind = f"an {kind}" if kind == "ellipsoid" else f"a {kind}"
    remedy = "Every length has to be above 0, in m; a thin part may be 0.001."
    for name in own:
        text = _text(shape, name, sdf)
        if not text.strip():
            return f"is {a_kind} without {name}", remedy
        if not all(length > 0.0 for length in _numbers(text)):
            return f"is {a_kind} with {name} {' '.join(text.split())}", remedy
        if not all(length <= LARGEST for length in _numbers(text)):
            found = f"is {a_kind} with {name} {' '.join(text.split())}, over {LARGEST:,.0f} m"
            return found, "Lengths are in m."
    return None


def _text(shape: ET.Element, name: str, sdf: bool) -> str:
    if not sdf:
        return shape.get(name, "")
    return next((e.text or "" for e in shape if e.tag.rpartition(":")[2] == name), "")


def _numbers(text: str) -> list[float]:
    """Numbers in a text; none where there is something else, of which Drake complains itself."""
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        return []
