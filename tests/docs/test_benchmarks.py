"""Every program under benchmarks/ is where people look for it."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAMS = sorted(
    file.name for file in (ROOT / "benchmarks").glob("*.py") if "__main__" in file.read_text()
)


@pytest.mark.parametrize(
    ("page", "as_written"),
    [("CONTRIBUTING.md", "| `{}` |"), ("docs/benchmarks.md", "benchmarks/{}")],
)
def test_every_program_is_listed(page: str, as_written: str) -> None:
    text = (ROOT / page).read_text()
    assert len(PROGRAMS) > 15
    assert not [name for name in PROGRAMS if as_written.format(name) not in text]
