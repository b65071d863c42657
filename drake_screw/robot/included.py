"""Models that another one is put together of: an SDF includes them, directives add them."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Protocol, TypeVar

from pydrake.multibody.parsing import LoadModelDirectives, PackageMap

from drake_screw.errors import ModelError
from drake_screw.robot.addresses import model_at
from drake_screw.robot.directives import directives_error
from drake_screw.robot.model_meshes import address_of, set_address
from drake_screw.robot.packages import Packages


class _Mended(Protocol):
    @property
    def read(self) -> Path:
        """What Drake is to read in place of a file."""


_Model = TypeVar("_Model", bound=_Mended)


def mend_includes(
    root: ET.Element, folder: Path, packages: Packages, mend: Callable[[Path], _Model]
) -> tuple[bool, list[tuple[Path, _Model]]]:
    """Have an SDF include models as they are made ready for Drake.

    Models that cannot be found are left to Drake. It knows no paths here, only addresses.

    Args:
        root: of the SDF; changed where a model had to be.
        folder: from which relative paths are seen.
        packages: those that addresses are about.
        mend: makes a model's file ready.

    Returns:
        Whether the SDF was changed; the files that are included, and what became of them.
    """
    found, changed = [], False
    for include in root.iter("include"):
        address = address_of(include)
        if not address:
            continue
        file = None
        with suppress(ModelError):
            file = model_at(packages.path(address, folder))
        if file is None:
            continue
        mended = mend(file)
        found.append((file, mended))
        if mended.read != file or "://" not in address:
            set_address(include, mended.read.absolute().as_uri())
            changed = True
    return changed, found


def mend_directives(
    file: Path, packages: PackageMap, mend: Callable[[Path], _Model]
) -> tuple[str | None, list[tuple[Path, _Model]]]:
    """Have directives add models as they are made ready for Drake.

    Args:
        file: of the directives.
        packages: that their addresses are about.
        mend: makes the file of a model ready, or that of other directives.

    Returns:
        Their text if it had to be changed, and the files that they add, with what became of them.

    Raises:
        ModelError: they cannot be read, or name a file or a package that there is not.
    """
    try:
        listed = LoadModelDirectives(str(file)).directives
        added = [one.add_model or one.add_directives for one in listed]
        files = {one.file: Path(packages.ResolveUrl(one.file)) for one in added if one is not None}
    except (RuntimeError, ValueError, SystemExit) as error:
        raise directives_error(file, error) from error
    found = {address: (one, mend(one)) for address, one in files.items()}
    text = None
    for address, (one, mended) in found.items():
        if mended.read != one:
            text = file.read_text(encoding="utf-8") if text is None else text
            whole = rf"(?<![^\s'\"]){re.escape(address)}(?![^\s'\",}}])"
            text = re.sub(whole, mended.read.as_uri().replace("\\", r"\\"), text)
    return text, list(found.values())
