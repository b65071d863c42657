"""``drake-screw study``: from the scenario to the table."""

from __future__ import annotations

from pathlib import Path

from tests.commands.conftest import QUICK


def test_a_study_can_be_small(command, library) -> None:
    code, out, _ = command(
        "study", "pouring", "--demonstrations", library, "--regions", "1,2", "--runs", 2,
        "--workers", 1, "--output", "study", *QUICK,
    )  # fmt: skip
    assert code == 0
    assert len(Path("study/runs.csv").read_text().splitlines()) == 5
    assert "study directory: study" in out
