"""Files shipped with drake_screw, found by name: robot models and scenarios."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from drake_screw.errors import DrakeScrewError, ModelError, ScenarioError, nearest
from drake_screw.typing import PathLike

Kind = Literal["models", "scenarios"]

MODEL_SUFFIXES = (".sdf", ".urdf", ".xml", ".dmd.yaml", ".xacro")
SCENARIO_SUFFIXES = (".yaml", ".yml")

_ERRORS: dict[Kind, type[DrakeScrewError]] = {"models": ModelError, "scenarios": ScenarioError}


def list_resources(kind: Kind, suffixes: Sequence[str] = ()) -> tuple[str, ...]:
    """Names of the shipped files of a kind, sorted, without suffix.

    Args:
        kind: the folder to look in.
        suffixes: list only files that end in one of these; all files where empty.
    """
    folder = _folder(kind)
    if not folder.is_dir():
        return ()
    wanted = tuple(suffixes) or ("",)
    files = (f.name for f in folder.iterdir() if f.is_file() and not f.name.startswith("."))
    return tuple(sorted({name.split(".")[0] for name in files if name.endswith(wanted)}))


def find_resource(kind: Kind, name_or_path: PathLike, suffixes: Sequence[str]) -> Path:
    """The absolute path of a shipped file given by name, or of any file given by path.

    What contains a folder or ends in one of `suffixes` is a path, seen from the working
    directory. Anything else is a shipped name or, where none is shipped under it, a file.

    Raises:
        ModelError, ScenarioError: by `kind`, where there is no such file; lists the shipped names.
    """
    text = os.fspath(name_or_path)
    if not looks_like_path(text, suffixes):
        for suffix in suffixes:
            shipped = _folder(kind) / f"{text}{suffix}"
            if os.path.isfile(shipped):
                return shipped
    if os.path.isfile(text):
        return Path(os.path.abspath(text))
    raise _missing(kind, text, suffixes)


def looks_like_path(text: str, suffixes: Sequence[str]) -> bool:
    """Whether a text names a file by its path rather than a shipped file by its name."""
    return os.sep in text or text.endswith(tuple(suffixes))


def _folder(kind: Kind) -> Path:
    package = Path(__file__).parent
    installed = package / kind
    return installed if installed.is_dir() else package.parent / kind


def _missing(kind: Kind, text: str, suffixes: Sequence[str]) -> DrakeScrewError:
    singular = kind.removesuffix("s")
    shipped = list_resources(kind, suffixes)
    listed = f"Shipped {kind}: {', '.join(shipped) or 'none'}."
    if os.path.isdir(text):
        guess = next((os.path.join(text, f) for f in _files(text, suffixes)), None)
        message = f"'{text}' is a folder, not a {singular} file"
    else:
        folder, name = os.path.split(text)
        stem = next((name.removesuffix(s) for s in suffixes if name.endswith(s)), name)
        beside = nearest(name, _files(folder or ".", suffixes))
        guess = os.path.join(folder, beside) if beside else nearest(stem, shipped)
        message = f"no {'file' if looks_like_path(text, suffixes) else singular} '{text}'"
    hint = f"Did you mean '{guess}'? " if guess else ""
    *others, last = suffixes
    either = f"{', '.join(others)} or {last}" if others else last
    remedy = f"{hint}{listed} Or give the path of a {either} file."
    return _ERRORS[kind](message, remedy=remedy)


def _files(folder: str, suffixes: Sequence[str]) -> list[str]:
    try:
        return sorted(name for name in os.listdir(folder) if name.endswith(tuple(suffixes)))
    except OSError:
        return []
