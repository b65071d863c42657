"""The versions of all that a result may depend on."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

_PACKAGES = ("drake-screw", "drake", "numpy", "scipy", "numba")


def versions() -> dict[str, str]:
    """Of Python and of packages, by name, as a run and a study record them."""
    return {"python": platform.python_version(), **{name: version(name) for name in _PACKAGES}}


@cache
def environment() -> dict[str, str]:
    """What has to be the same wherever a part of a result is computed.

    Python without its last number, the packages, whether there is OMPL, and this package's source,
    which its version alone does not tell where it is being worked on.
    """
    packages = {name: _version(name) for name in (*_PACKAGES, "ompl")}
    python = ".".join(platform.python_version_tuple()[:2])
    return {"python": python, **packages, "source of drake-screw": _source()}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _source() -> str:
    root = Path(__file__).parent
    digest = hashlib.sha256()
    for file in sorted(root.rglob("*.py")):
        digest.update(f"{file.relative_to(root)}\0".encode() + file.read_bytes())
    return digest.hexdigest()[:12]
