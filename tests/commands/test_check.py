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
    assert "asks       earliest; at the corner farthest from the shoulder first" in out
    assert "1,440 in a first round where nothing fails (90 in each region)" in " ".join(out.split())


def test_check_tells_where_it_would_ask(command) -> None:
    def asks(*changes: str) -> str:
        code, out, _ = command("check", "pouring", *(a for c in changes for a in ("--set", c)))
        assert code == 0
        return next(line for line in out.splitlines() if line.startswith("asks")).split(None, 1)[1]

    middle = "demonstrations={ask: densest, first: middle}"
    assert asks(middle) == "densest; in the middle first"
    assert asks(middle, "demonstrations.initial=0") == "densest"


def test_an_end_effector_that_points_aside_is_noted(command) -> None:
    _, out, _ = command("check", "pouring_iiwa")
    assert "out of the hand" not in out
    turned = "robot.end_effector_rotation=[0, 1.5708, 0]"
    code, out, _ = command("check", "pouring_iiwa", "--set", turned)
    assert code == 0
    assert "'hand_turned' is 90 degrees from what looks like out of the hand" in out


def test_check_tells_of_executions_and_refuses_what_a_run_would(command) -> None:
    execution = ("--set", "coverage.success=execution")
    code, out, _ = command("check", "pouring", *execution)
    assert code == 0
    assert "success    each instance's best plan is executed in simulation" in out
    assert "planning alone, executing each takes seconds more" in " ".join(out.split())
    code, out, error = command("check", "pouring", *execution, "--set", "objects.0.z=0.1")
    assert code == 2
    assert "has to stand on something" in " ".join((out + error).split())
