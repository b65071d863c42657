"""Models written in xacro, expanded to what they stand for."""

from __future__ import annotations

import contextlib
import importlib
import io
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.parsers.expat import ExpatError

from drake_screw.errors import ModelError
from drake_screw.robot.packages import Packages

SUFFIX = ".xacro"

_turn = threading.Lock()
"""xacro keeps the file it is at in variables of its own."""


def expand(file: Path, arguments: Mapping[str, object], packages: Packages) -> str:
    """The text of a model in xacro, ``$(find NAME)`` answered by `packages`.

    Args:
        file: of the model.
        arguments: values of its ``xacro:arg``, by name.
        packages: where packages are found.

    Raises:
        ModelError: xacro is not installed, or finds something wrong.
    """
    try:
        xacro: Any = importlib.import_module("xacro")
        substitution: Any = importlib.import_module("xacro.substitution_args")
    except ImportError as error:
        raise ModelError(
            "this model is written in xacro, which is not installed",
            remedy="Install it: pip install 'drake-screw[xacro]'. Or expand the file where it is "
            "installed, and give the URDF.",
            file=file,
        ) from error
    given = {name: _text(value) for name, value in arguments.items()}
    quiet = io.StringIO()
    with _turn, _finding(substitution, packages), contextlib.redirect_stderr(quiet):
        try:
            document = xacro.process_file(str(file), mappings=given)
            text: str = document.toxml()
        except ModelError:
            raise
        except Exception as error:
            inner = getattr(error, "exc", None)
            if isinstance(inner, ModelError):
                raise inner from error
            raise _refusal(error, file, list(xacro.filestack)) from error
    return text


@contextlib.contextmanager
def _finding(substitution: Any, packages: Packages) -> Iterator[None]:
    """Let xacro ask `packages` in place of ament's index."""

    def find(name: str) -> str:
        return str(packages.folder(name))

    functions = substitution._eval_dict
    own, listed = substitution._eval_find, functions.get("find")
    substitution._eval_find = find
    functions["find"] = find
    try:
        yield
    finally:
        substitution._eval_find = own
        functions["find"] = listed


def _refusal(error: Exception, file: Path, stack: list[str]) -> ModelError:
    at = Path(stack[-1]) if stack else file
    message = " ".join(str(error).split()) or type(error).__name__
    if isinstance(error, ExpatError):
        return ModelError(f"not XML: {error}", file=at, line=error.lineno)
    remedy = None
    if "Undefined substitution argument" in message:
        remedy = "Give its value in the scenario: `xacro: {NAME: value}` in `robot`."
    elif isinstance(error, FileNotFoundError) or "No such file" in message:
        remedy = "Paths of included files are relative to the file that includes them."
    return ModelError(f"xacro cannot expand this model: {message}", remedy=remedy, file=at)


def _text(value: object) -> str:
    """As a command line of xacro has it."""
    return str(value).lower() if isinstance(value, bool) else str(value)
