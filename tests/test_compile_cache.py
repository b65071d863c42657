"""Compiled code that was kept is used again, and never trusted when it is damaged."""

from __future__ import annotations

import importlib.util
import itertools
import logging
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from drake_screw.said_once import warn_once

SOURCE = """
from drake_screw.compile_cache import cached_njit

@cached_njit()
def twice(x):
    return 2.0 * x
"""


@pytest.fixture(autouse=True)
def told_anew() -> None:
    warn_once.cache_clear()


def twice(folder: Path) -> Any:
    """The function as a new process would have it."""
    file = folder / "module_with_twice.py"
    if not file.exists():
        file.write_text(SOURCE)
    spec = importlib.util.spec_from_file_location("module_with_twice", file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.twice


def hits(function: Any) -> int:
    assert function(3.0) == 6.0
    return sum(function.stats.cache_hits.values())


def truncate(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-40])


def garble(file: Path) -> None:
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 0xFF
    file.write_bytes(bytes(content))


def empty(file: Path) -> None:
    file.write_bytes(b"")


def folder_instead(file: Path) -> None:
    file.unlink()
    file.mkdir()
    (file / "something").touch()


def test_damage_is_noticed_told_in_a_line_and_mended(tmp_path, caplog) -> None:
    assert hits(twice(tmp_path)) == 0
    assert hits(twice(tmp_path)) == 1
    cache = tmp_path / "__pycache__"
    (index,), (code,) = cache.glob("*.index"), cache.glob("*.code")
    harms: list[Callable[[Path], None]] = [truncate, garble, empty, folder_instead]
    for harm, file in itertools.product(harms, (index, code)):
        harm(file)
        warn_once.cache_clear()
        caplog.clear()
        with caplog.at_level(logging.WARNING, "drake_screw"):
            assert hits(twice(tmp_path)) == 0, (harm, file)
        (line,) = caplog.messages
        assert str(file) in line
        assert "compiled again" in line
        assert hits(twice(tmp_path)) == 1, (harm, file)


def test_where_nothing_can_be_written_it_works_and_says_so(tmp_path, caplog, monkeypatch) -> None:
    first = twice(tmp_path)
    cache = tmp_path / "__pycache__"
    shutil.rmtree(cache, ignore_errors=True)
    monkeypatch.setattr(first._cache._impl.locator, "ensure_cache_path", lambda: None)
    cache.touch()
    with caplog.at_level(logging.WARNING, "drake_screw"):
        assert hits(first) == 0
    (line,) = caplog.messages
    assert "cannot be kept: Not a directory" in line


ALGEBRA = """
import sys
import numpy as np
from drake_screw.compile_cache import cached_njit

@cached_njit()
def solved(A, b):
    if A.shape[0] != len(b):
        raise ValueError("of another size")
    return np.linalg.solve(A, b), [i for i in range(len(b))]

if __name__ == "__main__":
    x, places = solved(np.array([[2.0, 1.0], [0.0, 1.0]]), np.array([5.0, 1.0]))
    print(*x, *places)
    try:
        solved(np.eye(2), np.zeros(3))
    except ValueError as error:
        print(error)
    print(sum(solved.stats.cache_hits.values()))
"""


def test_what_was_kept_answers_in_a_new_process_as_it_did_when_it_was_compiled(tmp_path) -> None:
    """Loading it does not load all that numba can compile; what the code calls is there."""
    file = tmp_path / "algebra.py"
    file.write_text(ALGEBRA)
    compiled, kept = (
        subprocess.run([sys.executable, file], capture_output=True, text=True, check=False)
        for _ in range(2)
    )
    answer = ["2.0", "1.0", "0", "1", "of", "another", "size"]
    assert (compiled.stdout.split(), compiled.stderr) == ([*answer, "0"], "")
    assert (kept.stdout.split(), kept.stderr) == ([*answer, "1"], "")
