"""A robot's model made ready for Drake: found, expanded, its meshes in formats that are read."""

from __future__ import annotations

import hashlib
import logging
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pydrake.multibody.parsing import PackageMap

from drake_screw.errors import ModelError
from drake_screw.files import file_hash
from drake_screw.robot.addresses import add_packages
from drake_screw.robot.directives import is_directives
from drake_screw.robot.included import mend_directives, mend_includes
from drake_screw.robot.kept_files import holds, keep, kept_folder
from drake_screw.robot.model_limits import check_joint_limits
from drake_screw.robot.model_materials import mend_materials
from drake_screw.robot.model_meshes import LeftOut, MeshesRead, make_absolute, read_meshes
from drake_screw.robot.model_text import check_collision_shapes
from drake_screw.robot.model_xml import model_xml, parse_model
from drake_screw.robot.packages import ModelPlace
from drake_screw.robot.xacro_text import SUFFIX, expand
from drake_screw.said_once import warn_once

KINDS = {"robot": ".urdf", "sdf": ".sdf"}
"""Suffixes that Drake knows models by, by their root element."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class ModelFile:
    """A model as the user has it, and as Drake reads it.

    Attributes:
        file: the user's.
        read: which Drake is to read: the same where nothing has to be changed.
        hash: of what was read; that of the file's contents where Drake reads it as it is.
        left_out: shapes whose meshes cannot be had.
    """

    file: Path
    read: Path
    hash: str
    left_out: tuple[LeftOut, ...] = ()

    @property
    def incomplete(self) -> tuple[str, ...]:
        """Links that lack a collision shape."""
        return tuple(dict.fromkeys(s.link for s in self.left_out if s.role == "collision"))

    @property
    def collision_left_out(self) -> int:
        """How many collision shapes are left out."""
        return sum(s.role == "collision" for s in self.left_out)

    @property
    def looks_left_out(self) -> tuple[LeftOut, ...]:
        """Shapes that are not shown."""
        return tuple(s for s in self.left_out if s.role == "visual")


def model_file(
    place: ModelPlace, arguments: Mapping[str, object] | None = None, *, shapes: bool = True
) -> ModelFile:
    """Make a model ready for Drake.

    What has to be changed in its text is changed in a copy in the cache folder.

    Args:
        place: where it is.
        arguments: of a model in xacro.
        shapes: whether its meshes matter; for kinematics alone they do not.

    Raises:
        ModelError: it cannot be found or expanded, has a collision shape that Drake would take for
            another one, or speaks of a package that is not found.
    """
    file, arguments = place.file, arguments or {}
    is_xacro = file.suffix.lower() == SUFFIX
    if arguments and not is_xacro:
        raise ModelError(
            f"arguments for xacro ({', '.join(arguments)}), but the model is not written in xacro",
            remedy=f"Leave `xacro` out, or name the {SUFFIX} file.",
            file=file,
        )
    if is_directives(file):
        return _directives(place, shapes=shapes)
    if not is_xacro and file.suffix.lower() not in KINDS.values():
        return ModelFile(file, file, file_hash(file))
    try:
        text = expand(file, arguments, place.packages) if is_xacro else file.read_bytes()
        root = parse_model(text)
    except (ET.ParseError, OSError) as error:
        if is_xacro:
            raise ModelError(f"expanded, it is not XML: {error}", file=file) from error
        return ModelFile(file, file, file_hash(file))
    check_collision_shapes(root, file)
    check_joint_limits(root, file)
    if is_xacro and root.tag not in KINDS:
        raise ModelError(
            f"expanded, it is a '{root.tag}' and no robot",
            remedy="Name the file that describes the whole robot; files of macros alone do not.",
            file=file,
        )
    original = model_xml(root)
    meshes = read_meshes(root, file.parent, place.packages) if shapes else MeshesRead()
    for shape in meshes.left_out:
        _log.debug("%s: %s shape left out: %s", file, shape.role, shape)
    changed = _mend(root, place, shapes=shapes) if root.tag == "robot" else False
    put, included = mend_includes(root, file.parent, place.packages, _mender(place, shapes=shapes))
    changed = changed or put
    left_out = (*meshes.left_out, *(s for _, part in included for s in part.left_out))
    if not is_xacro and not meshes.changed and not changed:
        return ModelFile(file, file, _together(file_hash(file), included), left_out)
    make_absolute(root, file.parent, place.packages)
    suffix = KINDS.get(root.tag, file.suffix.lower())
    hash = file_hash(file) if not is_xacro else hashlib.sha256(original.encode()).hexdigest()
    missing = [(s.link, s.mesh, "") for s in meshes.left_out if s.role == "collision"]
    if missing or meshes.converted:
        told = [hash, *("\0".join(entry) for entry in (*missing, *meshes.converted))]
        hash = hashlib.sha256("\n".join(told).encode()).hexdigest()
    read = _kept(model_xml(root), f"{_stem(file)}{suffix}")
    return ModelFile(file, read, _together(hash, included), left_out)


Parts = Sequence[tuple[Path, ModelFile]]
"""Files that a model is put together of, and what became of them."""


def _directives(place: ModelPlace, *, shapes: bool) -> ModelFile:
    """As `model_file`, of Drake's model directives."""
    file, packages = place.file, PackageMap()
    add_packages(packages, file, place.packages, meshes=shapes)
    text, parts = mend_directives(file, packages, _mender(place, shapes=shapes))
    left_out = tuple(s for _, part in parts for s in part.left_out)
    read = file if text is None else _kept(text, file.name)
    return ModelFile(file, read, _together(file_hash(file), parts), left_out)


def _mender(place: ModelPlace, *, shapes: bool) -> Callable[[Path], ModelFile]:
    """Makes models ready that one is put together of."""
    return lambda file: model_file(ModelPlace(str(file), place.given), shapes=shapes)


def _together(hash: str, parts: Parts) -> str:
    """The hash of a model and of all that it is put together of."""
    if not parts:
        return hash
    return hashlib.sha256("\n".join([hash, *(part.hash for _, part in parts)]).encode()).hexdigest()


def _mend(root: ET.Element, place: ModelPlace, *, shapes: bool) -> bool:
    """Mend what Drake refuses a URDF for though it is of no matter; whether there was anything."""
    changed = shapes and mend_materials(root, _has_file(place))
    if not root.get("name"):
        root.set("name", _stem(place.file))
        changed = True
    joints = {joint.get("name"): joint.get("type") for joint in root.iterfind("joint")}
    for joint in root.iterfind("joint"):
        mimic = joint.find("mimic")
        if mimic is not None and joint.get("type") == "fixed":
            joint.remove(mimic)
            changed = True
        elif mimic is not None and joints.get(mimic.get("joint")) in (None, "fixed"):
            joint.remove(mimic)
            changed = True
            warn_once(
                _log,
                f"{place.file}: joint '{joint.get('name')}' is to follow '{mimic.get('joint')}', "
                "which does not move; it is a joint of its own now",
            )
    for transmission in root.findall("transmission"):
        if any(joint.get("name") not in joints for joint in transmission.iterfind("joint")):
            root.remove(transmission)
            changed = True
    return changed


def _has_file(place: ModelPlace) -> Callable[[str], bool]:
    def has_file(address: str) -> bool:
        try:
            return place.packages.path(address, place.file.parent).is_file()
        except ModelError:
            return False

    return has_file


def _stem(file: Path) -> str:
    return file.name.split(".")[0]


def _kept(text: str, name: str) -> Path:
    kept = kept_folder("models", hashlib.sha256(text.encode()).hexdigest()[:32]) / name
    if not holds(kept, text):
        keep(kept, text)
    return kept
