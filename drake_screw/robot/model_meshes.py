"""Meshes of a model: those that Drake cannot read are converted, and left out where that fails."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from drake_screw.errors import ModelError
from drake_screw.robot.addresses import DRAKE_S_OWN
from drake_screw.robot.mesh_files import content_hash, hull_file, look_file
from drake_screw.robot.packages import Packages, split_address
from drake_screw.robot.shapes import MESH_SUFFIXES

LARGE = 1_000_000
"""Bytes of an OBJ file that is too large to look at."""

Role = Literal["collision", "visual"]


@dataclass(frozen=True)
class LeftOut:
    """A shape of a link that is not there, as its mesh cannot be had.

    Attributes:
        role: "collision", so that this part of the link touches nothing, or "visual".
        link: its name.
        mesh: as the model has it.
        reason: what is wrong with it: "does not exist".
    """

    role: Role
    link: str
    mesh: str
    reason: str

    def __str__(self) -> str:
        return f"link '{self.link}': the mesh '{self.mesh}' {self.reason}"


@dataclass(frozen=True)
class MeshesRead:
    """What became of a model's meshes.

    Attributes:
        left_out: shapes that are not there.
        converted: by link and mesh, hashes of the contents of collision meshes that were converted.
        changed: whether the model's text had to be changed.
    """

    left_out: tuple[LeftOut, ...] = ()
    converted: tuple[tuple[str, str, str], ...] = ()
    changed: bool = False


def read_meshes(root: ET.Element, folder: Path, packages: Packages) -> MeshesRead:
    """Put meshes that Drake reads in the place of others, in the model's own tree.

    Args:
        root: of URDF or SDF; changed where anything has to be.
        folder: from which relative paths are seen.
        packages: those that addresses are about.

    Raises:
        ModelError: a package is not found.
    """
    left_out: list[LeftOut] = []
    converted: list[tuple[str, str, str]] = []
    changed = False
    for link, role, shape, mesh in list(_meshes(root)):
        address = address_of(mesh)
        name = link.get("name", "")
        file = None if _leads_nowhere(address) else packages.path(address, folder)
        try:
            read = _readable(file, role)
        except ModelError as error:
            left_out.append(LeftOut(role, name, address, error.message))
            link.remove(shape)
            changed = True
            continue
        if read != file:
            set_address(mesh, str(read))
            changed = True
            if role == "collision" and file is not None:
                converted.append((name, address, content_hash(file)))
    return MeshesRead(tuple(left_out), tuple(converted), changed)


def make_absolute(root: ET.Element, folder: Path, packages: Packages) -> None:
    """Write out where the files are that a model names, so that its text may be put anywhere."""
    for element in (*root.iter("mesh"), *root.iter("texture"), *root.iter("include")):
        address = address_of(element)
        split = split_address(address)
        if not address or (split is None and "://" in address):
            continue
        if split is not None and (not split[0] or split[0] in DRAKE_S_OWN):
            continue
        with suppress(ModelError):
            set_address(element, str(packages.path(address, folder)))


def address_of(element: ET.Element) -> str:
    """The address of a mesh, a texture, or a model that is included."""
    return (element.get("filename") or element.findtext("uri") or "").strip()


def set_address(element: ET.Element, address: str) -> None:
    """Put another address in its place."""
    if element.get("filename") is not None:
        element.set("filename", address)
    for uri in element.iterfind("uri"):
        uri.text = address


def _meshes(root: ET.Element) -> Iterator[tuple[ET.Element, Role, ET.Element, ET.Element]]:
    """Links with the role, the shape, and its mesh."""
    roles: tuple[Role, ...] = ("collision", "visual")
    for link in root.iter("link"):
        for role in roles:
            for shape in link.iterfind(role):
                mesh = shape.find("geometry/mesh")
                if mesh is not None and address_of(mesh):
                    yield link, role, shape, mesh


def _leads_nowhere(address: str) -> bool:
    """Whether an address names no package, or is of a kind that nobody follows."""
    split = split_address(address)
    if split is not None:
        return not split[0]
    return "://" in address and not address.startswith("file://")


def _light(file: Path) -> Path:
    """A look that pages can carry: a large OBJ file is coarsened, where that can be done."""
    if file.suffix.lower() != ".obj" or file.stat().st_size < LARGE:
        return file
    try:
        return look_file(file)
    except ModelError:
        return file


def _readable(file: Path | None, role: Role) -> Path:
    """A file with the mesh, or its hull where that is what matters, that Drake reads."""
    if file is None:
        raise ModelError("is at an address that leads nowhere")
    if not file.is_file():
        raise ModelError("does not exist")
    if file.suffix.lower() in MESH_SUFFIXES:
        return _light(file) if role == "visual" else file
    convert: dict[Role, Callable[[Path], Path]] = {"collision": hull_file, "visual": look_file}
    return convert[role](file)
