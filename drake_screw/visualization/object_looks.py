"""How objects look, as shapes of Drake's."""

from __future__ import annotations

from pydrake.common import MemoryFile
from pydrake.geometry import InMemoryMesh, Mesh

from drake_screw.robot import ObjectConfig
from drake_screw.visualization import meshes


def bowl_look(item: ObjectConfig) -> Mesh:
    """A bowl as wide and high as an object, its foot at the object's origin, in m."""
    bowl = meshes.bowl(item.radius, item.height)
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in bowl.vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in (bowl.faces + 1).tolist()]
    text = "\n".join(lines) + "\n"
    return Mesh(mesh_data=InMemoryMesh(mesh_file=MemoryFile(text.encode(), ".obj", item.name)))
