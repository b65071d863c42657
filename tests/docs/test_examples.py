"""The Python in the documentation runs: every block of a page, in order, in one namespace."""

from __future__ import annotations

import re
import sys
import types
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
FENCE = re.compile(r"^```python(?P<no_run> no-run)?\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(page: Path) -> Iterator[tuple[int, str]]:
    """The line on which each block's code begins, and the code."""
    text = page.read_text()
    for found in FENCE.finditer(text):
        if not found["no_run"]:
            yield text.count("\n", 0, found.start("code")) + 1, found["code"]


WITH_CODE = [page for page in PAGES if any(blocks(page))]


def test_there_is_something_to_run_and_no_fence_that_is_not_understood() -> None:
    assert {"README.md", "extending.md", "python.md"} <= {page.name for page in WITH_CODE}
    for page in PAGES:
        fences = re.findall(r"^ *```[ \t]*py.*$", page.read_text(), re.MULTILINE)
        assert set(fences) <= {"```python", "```python no-run"}, page.name


@pytest.mark.parametrize("page", WITH_CODE, ids=lambda page: page.name)
def test_examples_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    module = types.ModuleType("example")
    monkeypatch.setitem(sys.modules, "example", module)  # dataclasses look their module up
    for line, code in blocks(page):
        place = "\n" * (line - 1)  # so that a traceback names the line of the page
        exec(compile(place + code, str(page), "exec"), module.__dict__)
