"""Packages of robot models, found by name: what ``package://NAME/...`` in a model refers to."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from urllib.parse import unquote

from drake_screw.errors import ModelError
from drake_screw.resources import MODEL_SUFFIXES, find_resource

SCHEMES = ("package://", "model://")
"""Of an address that begins with a package's name."""

MARKS = ("package.xml", "model.config")
"""A folder with one of these is a package."""

PARTS = ("meshes", "urdf", "xacro", "robots", "models", "sdf", "mjcf")
"""A folder with one of these may be a package whose package.xml was left behind."""

DEPTH = 3
"""Folders below one of ROS_PACKAGE_PATH that are looked at."""

_NAME = re.compile(r"<name>\s*([^<\s]+)\s*</name>")


@dataclass(frozen=True)
class Packages:
    """Where packages are looked for, each only when it is asked for.

    The first of these that has it: what is given; the folders above the model's file, and those
    beside them; ``ROS_PACKAGE_PATH``; ``AMENT_PREFIX_PATH``; the installed Python packages.

    Attributes:
        given: folders by package name.
        near: the file of a model, whose own package and those beside it are looked at.
    """

    given: Mapping[str, Path] = field(default_factory=dict)
    near: Path | None = None

    def find(self, name: str) -> Path | None:
        """The folder of a package; None if there is none of that name.

        Raises:
            ModelError: the folder that is given for it does not exist.
        """
        if name in self.given:
            folder = Path(self.given[name])
            if not folder.is_dir():
                raise ModelError(
                    f"the folder given for package '{name}' does not exist: {folder}",
                    remedy="Mend its path in `packages` of the scenario's robot; it is relative to "
                    "the scenario file.",
                    file=self.near,
                )
            return folder
        found = next(self._candidates(name), None)
        return None if found is None else found.absolute()

    def folder(self, name: str) -> Path:
        """The folder of a package.

        Raises:
            ModelError: there is none of that name.
        """
        found = self.find(name)
        if found is None:
            raise ModelError(
                f"package '{name}' is not found",
                remedy=f"Say where it is: `packages: {{{name}: path/of/its/folder}}` in the "
                f"scenario's robot. Looked {', '.join(self._places())}.",
                file=self.near,
            )
        return found

    def path(self, address: str, folder: Path) -> Path:
        """The file an address refers to, whether or not it exists.

        Args:
            address: with one of `SCHEMES` or file://, or a path.
            folder: from which a relative path is seen.

        Raises:
            ModelError: it is of a package that is not found, or of another scheme.
        """
        split = split_address(address)
        if split is not None and split[0]:
            return self.folder(split[0]) / split[1]
        if address.startswith("file://"):
            return Path("/" + unquote(address.removeprefix("file://")).lstrip("/"))
        if "://" in address:
            raise ModelError(
                f"'{address}' is no address of a file",
                remedy="Use a path, or an address that begins with package://, model:// or file://",
                file=self.near,
            )
        return folder / address

    def _places(self) -> list[str]:
        places = [] if self.near is None else ["above and beside the model's file"]
        places += [
            f"in {variable}{'' if os.environ.get(variable) else ' (not set)'}"
            for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")
        ]
        return [*places, "among installed Python packages"]

    def _candidates(self, name: str) -> Iterator[Path]:
        """Folders of that name, the best first."""
        if not name or "/" in name or name in (".", ".."):
            return
        for above in () if self.near is None else self.near.parents:
            if above.name == name or package_name(above) == name:
                yield above
            if _looks_like_one(above / name):
                yield above / name
            if (above / MARKS[0]).is_file():
                yield from (f for f in _folders(above.parent) if package_name(f) == name)
        for folder in _listed("ROS_PACKAGE_PATH"):
            if _looks_like_one(folder / name):
                yield folder / name
            yield from (f for f in _packages_below(folder, DEPTH) if package_name(f) == name)
        for prefix in _listed("AMENT_PREFIX_PATH"):
            if (prefix / "share" / name).is_dir():
                yield prefix / "share" / name
        yield from self._installed(name)

    @staticmethod
    def _installed(name: str) -> Iterator[Path]:
        sites = [Path(p) for p in dict.fromkeys(sys.path) if p and os.path.isdir(p)]
        shares = [*(site / "cmeel.prefix" / "share" for site in sites), Path(sys.prefix) / "share"]
        for parent in (*shares, *sites):
            if _looks_like_one(parent / name):
                yield parent / name
        for parent in (*shares, *sites):
            yield from (f for f in _folders(parent) if package_name(f) == name)


@dataclass(frozen=True)
class ModelPlace:
    """A model as it is named, and the packages it is seen with.

    Attributes:
        model: a shipped model's name, a path, or an address in a package.
        given: folders by package name.
    """

    model: str
    given: Mapping[str, Path] = field(default_factory=dict)

    @cached_property
    def file(self) -> Path:
        """The model's file.

        Raises:
            ModelError: there is no such file, or its package is not found.
        """
        if split_address(self.model) is None:
            return find_resource("models", self.model, MODEL_SUFFIXES)
        file = Packages(self.given).path(self.model, Path())
        if not file.is_file():
            raise ModelError(
                f"there is no such file: '{self.model}'",
                remedy="The address is package://, the package's name, and the file's path in it.",
                file=file,
            )
        return file

    @cached_property
    def packages(self) -> Packages:
        """The packages that the model's addresses are about."""
        return Packages(self.given, self.file)


def split_address(address: str) -> tuple[str, str] | None:
    """The package of an address and the path in it, or None where it speaks of no package.

    >>> split_address("package://my_arm/meshes/hand.obj")
    ('my_arm', 'meshes/hand.obj')
    """
    for scheme in SCHEMES:
        if address.startswith(scheme):
            name, _, path = address.removeprefix(scheme).partition("/")
            return name, unquote(path).strip("/")
    return None


def package_name(folder: Path) -> str | None:
    """The name in a folder's package.xml; None if it has none that can be read."""
    try:
        text = (folder / MARKS[0]).read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    found = _NAME.search(re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL))
    return None if found is None else found[1]


def _looks_like_one(folder: Path) -> bool:
    return any((folder / name).is_file() for name in MARKS) or any(
        (folder / name).is_dir() for name in PARTS
    )


def _listed(variable: str) -> Iterator[Path]:
    yield from (Path(p) for p in os.environ.get(variable, "").split(os.pathsep) if p)


def _folders(parent: Path) -> list[Path]:
    try:
        return sorted(f for f in parent.iterdir() if f.is_dir() and not f.name.startswith("."))
    except OSError:
        return []


def _packages_below(folder: Path, depth: int) -> Iterator[Path]:
    """Packages in a folder, not those inside of one another."""
    if (folder / MARKS[0]).is_file():
        yield folder
    elif depth > 0:
        for inner in _folders(folder):
            yield from _packages_below(inner, depth - 1)
