"""What is done with a finished run: report, inspect, export, execute."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.commands.conftest import QUICK


@pytest.mark.slow
def test_report_draws_again(command) -> None:
    command("run", "pouring", *QUICK, "--output", "here")
    for file in [*Path("here").rglob("*.png"), Path("here/meshcat.html")]:
        file.unlink()
    record = Path("here/run.json").read_text()
    code, out, _ = command("report", "here", "--svg")
    assert code == 0
    assert "certificate" in out
    assert Path("here/rounds.svg").exists()
    assert Path("here/round_01/heat_map.svg").exists()
    assert Path("here/meshcat.html").exists()
    assert Path("here/round_01/heat_map.png").exists()
    assert Path("here/run.json").read_text() == record


def test_a_run_can_be_looked_at_exported_and_executed(command) -> None:
    command("run", "pouring", *QUICK, "--output", "here", "-q")
    code, out, _ = command("inspect", "here", "--html", "page.html", "--round", 1)
    assert code == 0
    assert Path("page.html").stat().st_size > 1e6
    assert Path("page.csv").exists()
    code, _, _ = command("export", "here", "--instance", 0.85, 0.2, "--output", "plan.csv")
    assert code == 0
    assert Path("plan.csv").read_text().startswith("time,left_s0")
    code, out, _ = command("execute", "here", "--instance", 0.85, 0.2, "--workers", 1)
    assert code == 0
    assert re.search(r"done +1 of 1", out)
    code, out, _ = command("report", "here")
    assert code == 0
    assert Path("here/report.html").stat().st_size > 1e4
