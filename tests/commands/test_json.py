"""``--json``: results for programs, with the keys that docs/file_formats.md promises."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drake_screw.commands.output import Output
from drake_screw.studies.findings import Finding, Findings
from tests.commands.conftest import QUICK, Command

PAGE = Path(__file__).parents[2] / "docs" / "file_formats.md"


def promised(verb: str) -> dict[str, str]:
    """Keys of a verb's result and what is said of them."""
    text = PAGE.read_text().split(" Results as JSON\n", 1)[1].split("\n## ", 1)[0]
    table = next(part for part in text.split("**`")[1:] if verb in part.split("`**")[0].split(", "))
    return dict(re.findall(r"^\| `(\w+)` \| (.+) \|$", table, re.MULTILINE))


def check_keys(verb: str, result: dict[str, Any]) -> None:
    """Every key is promised, and no other; those of objects within are named beside theirs."""
    table = promised(verb)
    assert list(table) == list(result)
    for key, value in result.items():
        items = value if isinstance(value, list) else [value]
        for item in items:
            if isinstance(item, dict) and key not in ("success_rates", "certificate"):
                assert [name for name in item if f"`{name}`" not in table[key]] == [], key


def test_run_and_report_give_the_same(command: Command) -> None:
    code, out, err = command("run", "pouring", *QUICK, "--output", "here", "--json", "run.json")
    assert (code, err) == (0, "")
    assert "certificate" in out
    result = json.loads(Path("run.json").read_text())
    check_keys("run", result)
    record = json.loads(Path("here/run.json").read_text())
    assert result["directory"] == "here"
    assert result["status"] == "certified"
    assert result["certificate"] == record["certificate"]
    assert result["demonstrations"] == [entry["name"] for entry in record["demonstrations"]]
    assert [r["instances"] for r in result["rounds"]] == [
        sum(r["samples"]) for r in record["rounds"]
    ]
    code, out, err = command("report", "here", "--json", "-")
    assert code == 0
    assert json.loads(out) == result
    assert "certificate" in err
    assert "written: here/report.html" in err


def test_an_end_without_certificate_is_a_result(command: Command) -> None:
    code, out, _ = command(
        "run", "pouring", "--set", "demonstrations.budget=1", "--set", "objects.0.symmetry=null",
        "--output", "here", "-q", "--json", "-",
    )  # fmt: skip
    result = json.loads(out)
    assert code == 1
    assert (result["status"], result["certificate"]["certified"]) == ("insufficient", False)
    assert result["reason"] in result["statement"][0].lower()


@pytest.mark.parametrize(
    "args",
    [
        ["pouring"],
        ["pouring", "--set", "coverage.strategy=naive_pac"],
        ["pouring", "--set", "coverage.strategy=lucb"],
        ["pouring", "--set", "regions={adaptive: {}}"],
        ["pouring", "--set", "teacher={kind: interactive}"],
        ["pouring_iiwa"],
        ["pouring_both", "--set", "teacher={kind: interactive}"],
    ],
)
def test_check(command: Command, args: list[str]) -> None:
    code, out, err = command("check", *args, "--json", "-")
    result = json.loads(out)
    assert code == 0
    check_keys("check", result)
    assert result["objects"][0]["name"] == "bowl"
    assert (result["regions"] is None) == (result["adaptive"] is not None)
    assert (result["plans_per_second"] is None) == (result["teacher"] == "interactive")
    assert "goal       every region" in err


def test_evaluate(command: Command, library: Path, places: Path) -> None:
    code, _, _ = command(
        "evaluate", "pouring", "--demonstrations", library, "--instances", places,
        "--output", "out.csv", "--json", "result.json",
    )  # fmt: skip
    result = json.loads(Path("result.json").read_text())
    assert code == 0
    check_keys("evaluate", result)
    rows = [line.split(",") for line in Path("out.csv").read_text().splitlines()]
    for j, name in enumerate(rows[0][2:5], start=2):
        share = np.mean([row[j] == "0:0" for row in rows[1:]])
        assert result["success_rates"][name] == pytest.approx(share)
    assert (result["instances"], result["outside"], result["output"]) == (3, 0, "out.csv")


def test_execute(command: Command, certified: Path) -> None:
    shutil.copytree(certified, "here")
    args = ("execute", "here", "--workers", 1, "--json", "-", "--instance")
    code, out, err = command(*args, 0.85, 0.2)
    result = json.loads(out)
    assert code == 0
    check_keys("execute", result)
    summary = result["summary"]
    assert (summary["instances"], summary["executed"], summary["done"]) == (1, 1, 1)
    assert summary["flawless"] == 1
    assert 0.0 < summary["worst"]["tracking"]["position"] < 5e-3
    assert Path(result["folder"], "executions.csv").is_file()
    assert "done                       1 of 1" in err
    code, out, _ = command(*args, 5, 5)
    nothing = json.loads(out)["summary"]
    assert (code, nothing["executed"], nothing["flawless"], nothing["worst"]) == (1, 0, 0, None)
    (remark,) = nothing["without_plan"]
    assert remark["x_y_yaw"] == [[5.0, 5.0, 0.0]]
    assert remark["text"].startswith("no plan: ")


def test_study(command: Command, library: Path) -> None:
    code, _, _ = command(
        "study", "pouring", "--demonstrations", library, "--regions", "1,2", "--runs", 2,
        "--workers", 1, "--output", "study", *QUICK, "--json", "study.json",
    )  # fmt: skip
    result = json.loads(Path("study.json").read_text())
    assert code == 0
    check_keys("study", result)
    assert [found["K"] for found in result["regions"]] == [1, 2]
    for found in result["regions"]:
        assert sum(found["counts"].values()) == found["certified"] <= found["runs"] == 2


def test_what_is_not_known_is_null(capsys: pytest.CaptureFixture[str]) -> None:
    never = Finding(K=1, runs=2, certified=0, mean=float("nan"), most=0, counts={})
    Output("-").write(Findings(Path("x"), "pouring", 0, "eprocess", (never,)))
    found = json.loads(capsys.readouterr().out)
    assert (found["directory"], found["regions"][0]["mean"]) == ("x", None)


def test_a_result_that_fails_leaves_the_old_file(command: Command) -> None:
    Path("result.json").write_text("old")
    code, _, _ = command(
        "check", "pouring", "--set", "objects.0.x=[3.0, 4.0]", "--json", "result.json"
    )
    assert code == 2
    assert Path("result.json").read_text() == "old"
    assert list(Path().iterdir()) == [Path("result.json")]
