"""``drake-screw check``: what would run."""

from __future__ import annotations

import re

from tests.commands.conftest import NAIVE


def test_check_tells_what_would_run(command) -> None:
    code, out, _ = command("check", "pouring", *NAIVE)
    assert code == 0
    assert "K = 16" in out
    assert "32,308 in each region, 516,928 a round" in out
    assert re.search(r"about [\d,]+ s a round", out)
    code, out, _ = command("check", "pouring")
    assert code == 0
    assert "strategy   eprocess" in out
    assert "1,440 in a first round where nothing fails (90 in each region)" in " ".join(out.split())
