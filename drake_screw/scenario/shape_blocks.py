"""What a scenario file may say of solid things: their shape, and where it is."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from drake_screw.scenario.block import Block, Problem
from drake_screw.scenario.values import METRES, RADIANS, MeshFile, Name, Positive

SHAPES = ("box", "cylinder", "sphere", "mesh")


class CylinderBlock(Block):
    radius: Annotated[Positive, METRES]
    """its radius"""
    length: Annotated[Positive, METRES]
    """its length, along its frame's z"""


class SphereBlock(Block):
    radius: Annotated[Positive, METRES]
    """its radius"""


class ShapeBlock(Block):
    box: Annotated[tuple[Positive, Positive, Positive] | None, METRES] = None
    """a box: its full sizes along x, y, z of its frame"""
    cylinder: CylinderBlock | None = None
    """a cylinder along z of its frame"""
    sphere: SphereBlock | None = None
    """a sphere"""
    mesh: MeshFile | None = None
    """a mesh, .obj, .gltf or tetrahedral .vtk, or one that is converted (.stl, .dae, .glb, .ply,
    .off, by `drake-screw[meshes]`), relative to the scenario file; it counts, and is
    drawn, as its convex hull"""
    scale: Positive | None = None
    """by how much a mesh's coordinates are multiplied to be in m; 1 if left out"""
    xyz: Annotated[tuple[float, float, float], METRES] = (0.0, 0.0, 0.0)
    """where the shape's frame is; that is the middle of a box, cylinder or sphere"""
    rpy: Annotated[tuple[float, float, float], RADIANS] = (0.0, 0.0, 0.0)
    """how it is turned: roll, pitch and yaw"""

    def broken_rules(self) -> Iterator[Problem]:
        given = [name for name in SHAPES if getattr(self, name) is not None]
        if len(given) != 1:
            yield Problem(
                (),
                f"expected one shape, found {' and '.join(given) or 'none'}",
                f"Give one of {', '.join(SHAPES)}.",
            )
        elif self.scale is not None and self.mesh is None:
            yield Problem(("scale",), f"a {given[0]} has no scale", "Leave it out.")


class _Named(Block):
    name: Name
    """name of the obstacle: letters, digits, - and _"""


class ObstacleBlock(ShapeBlock, _Named):
    """A shape in W, with a name."""
