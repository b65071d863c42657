"""The examples in docstrings run and print what they say."""

from __future__ import annotations

import doctest
import importlib
from pathlib import Path

import pytest

import drake_screw

PACKAGE = Path(drake_screw.__file__).parent
MODULES = [
    ".".join(file.relative_to(PACKAGE.parent).with_suffix("").parts)
    for file in sorted(PACKAGE.rglob("*.py"))
    if ">>>" in file.read_text()
]


def test_the_most_used_rooms_have_examples() -> None:
    rooms = {name.split(".")[1] for name in MODULES}
    assert {"screws", "bandits", "tasks", "demonstrations"} <= rooms


@pytest.mark.parametrize("name", MODULES)
def test_examples_of(name: str) -> None:
    found = doctest.testmod(importlib.import_module(name), raise_on_error=False)
    assert found.attempted > 0
    assert found.failed == 0
