"""Addresses in a model's text: which packages it speaks of."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from pydrake.multibody.parsing import PackageMap

from drake_screw.errors import ModelError
from drake_screw.robot.packages import Packages, split_address

DRAKE_S_OWN = ("drake", "drake_models")
"""Packages that Drake brings or would fetch, whose models need no looking after."""

CONFIG, UNNAMED = "model.config", "model.sdf"
"""In a model's folder: what names its file, and the file where nothing does."""

_ADDRESS = re.compile(r"(?:package|model)://[^\s\"'<>,\]}]+")


def add_packages(drake: PackageMap, file: Path, packages: Packages, *, meshes: bool = True) -> None:
    """Tell Drake of the packages that a model and those it includes speak of, and of those given.

    What Drake knows by itself (its own models) stays.

    Args:
        drake: of the parser.
        file: the model.
        packages: where they are found.
        meshes: whether those that only meshes are in are needed.

    Raises:
        ModelError: one is not found.
    """
    for name in packages.given:
        _put(drake, name, packages.folder(name))
    seen, waiting = set(), [file]
    while waiting:
        model = waiting.pop()
        if model in seen:
            continue
        seen.add(model)
        shapes, included = addresses(model)
        if model != file:
            packages = replace(packages, near=model)
        for address in (*included, *(shapes if meshes else ())):
            split = split_address(address)
            if split is not None and not drake.Contains(split[0]):
                _put(drake, split[0], packages.folder(split[0]))
        waiting += filter(None, (_included(drake, a, model, packages) for a in included))


def _included(drake: PackageMap, address: str, model: Path, packages: Packages) -> Path | None:
    """The file of a model that `model` includes; None where it is not for us to look into."""
    split = split_address(address)
    if split is None:
        with suppress(ModelError):
            path = packages.path(address, model.parent)
            return path if path.is_file() else None
        return None
    if split[0] in DRAKE_S_OWN:
        return None
    path = Path(drake.GetPath(split[0])) / split[1]
    return model_at(path)


def model_at(path: Path) -> Path | None:
    """A model's file, by itself or by its folder, as an SDF includes either; None if there is none.

    In a folder `CONFIG` says which it is. Of several versions Drake takes the last one that it
    knows, and it knows all that are written.
    """
    if path.is_file():
        return path
    named: list[str] = []
    with suppress(OSError, ET.ParseError):
        named = [e.text.strip() for e in ET.parse(path / CONFIG).getroot().iter("sdf") if e.text]
    models = [path / name for name in (UNNAMED, *named) if (path / name).is_file()]
    return models[-1] if models else None


def addresses(file: Path) -> tuple[list[str], list[str]]:
    """Addresses in a model's file: of its meshes, and of the models it includes.

    None where the file cannot be read, which is for Drake to say.
    """
    suffix = file.suffix.lower()
    try:
        if suffix in (".yaml", ".yml"):
            lines = file.read_text(encoding="utf-8").splitlines()
            text = "\n".join(line.partition(" #")[0] for line in lines if line.strip()[:1] != "#")
            files = re.findall(r"\bfile:\s*[\"']?([^\s\"',}]+)", text)
            return [], list(dict.fromkeys([*files, *_ADDRESS.findall(text)]))
        root = ET.parse(file).getroot()
    except (ET.ParseError, OSError, UnicodeDecodeError):
        return [], []
    looks = (*root.iter("mesh"), *root.iter("texture"))
    meshes = [e.get("filename") or e.findtext("uri") or "" for e in looks]
    included = [e.findtext("uri") or "" for e in root.iter("include")]
    return [m.strip() for m in meshes if m], [i.strip() for i in included if i]


def _put(drake: PackageMap, name: str, folder: Path) -> None:
    if drake.Contains(name):
        drake.Remove(name)
    drake.Add(name, str(folder))
