"""The files that Drake's model directives add."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from pydrake.multibody.parsing import (
    FlattenModelDirectives,
    LoadModelDirectives,
    PackageMap,
)

from drake_screw.errors import ModelError
from drake_screw.robot.model_text import check_collision_shapes
from drake_screw.robot.model_xml import parse_model

SUFFIX = ".dmd.yaml"


def model_files(file: Path, packages: PackageMap) -> tuple[tuple[str | None, Path], ...]:
    """The files of the models that a model file adds, and what each is called.

    A file of directives adds any number, of names that it gives them; another file adds what it
    has, under names of its own (None).

    Raises:
        ModelError: directives cannot be read, or name a file or package that there is not.
    """
    if not file.name.endswith(SUFFIX):
        return ((None, file),)
    try:
        flat = FlattenModelDirectives(LoadModelDirectives(str(file)), packages)
        return tuple(
            (one.add_model.name, Path(packages.ResolveUrl(one.add_model.file)))
            for one in flat.directives
            if one.add_model is not None
        )
    except (RuntimeError, ValueError, SystemExit) as error:
        raise ModelError(
            f"Drake cannot read these model directives: {error}",
            remedy="Each add_model names a file as package://NAME/PATH, a package being a folder "
            "that has a package.xml.",
            file=file,
        ) from error


def check_models(files: Iterable[tuple[str | None, Path]]) -> None:
    """Look at the collision shapes of models that directives add, as of one that stands alone.

    Raises:
        ModelError: Drake would not take one as it is.
    """
    for name, file in files:
        if name is None or file.suffix.lower() not in (".sdf", ".urdf"):
            continue
        with suppress(ET.ParseError, OSError):
            check_collision_shapes(parse_model(file.read_bytes()), file)
