"""``drake-screw evaluate``: a code for each instance and demonstration."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from drake_screw import load_scenario
from drake_screw.runs import instance_files, outcome_table
from drake_screw.runs.outcome_table import tabulate_outcomes
from drake_screw.steps import Step

LAMP = "obstacles=[{name: lamp, sphere: {radius: 0.1}, xyz: [0.9, 0.3, 0.1]}]"
TURNED = "objects.0.symmetry=null"


def test_evaluate_writes_a_code_for_each_instance_and_demonstration(
    command, library, places
) -> None:
    code, out, _ = command(
        "evaluate", "pouring", "--demonstrations", library, "--instances", places,
        "--output", "out.csv",
    )  # fmt: skip
    assert code == 0
    rows = [line.split(",") for line in Path("out.csv").read_text().splitlines()]
    names = ["demo_01", "demo_02", "demo_03"]
    assert rows[0] == ["x", "y", *names, *(f"{name}:bowl" for name in names)]
    assert [row[:2] for row in rows[1:]] == [["0.8", "0.1"], ["0.9", "0.3"], ["1.07", "-0.23"]]
    cells = [cell for row in rows[1:] for cell in row[2:5]]
    turns = np.array([row[5:] for row in rows[1:]], dtype=float)
    assert (np.abs(turns) <= np.pi).all()
    assert all(re.fullmatch(r"0:0|[1-9]:([1-7]|n|c)", cell) for cell in cells)
    assert rows[1][2] == "0:0", "a demonstration solves the place it was given at"
    assert "3 instances x 3 demonstrations" in out


def test_what_the_scenario_fixes_needs_no_column(command, library, tmp_path) -> None:
    pouring = ("evaluate", "pouring", "--demonstrations", library)
    fixed = (*pouring, "--set", "objects.0.y=0.1", "--set", "regions.grid={x: 4}")
    (tmp_path / "x.csv").write_text("x\n0.8\n0.9\n")
    (tmp_path / "x_y.csv").write_text("x,y\n0.8,0.1\n0.9,0.3\n")
    code, out, _ = command(*fixed, "--instances", "x.csv", "--output", "out.csv")
    assert code == 0
    assert "note" not in out
    assert [row.split(",")[:2] for row in Path("out.csv").read_text().splitlines()[1:]] == [
        ["0.8", "0.1"],
        ["0.9", "0.1"],
    ]
    by_execution = ("--set", "coverage.success=execution")
    code, out, _ = command(*fixed, *by_execution, "--instances", "x_y.csv", "--output", "out.csv")
    assert code == 0
    assert "note: the scenario fixes y, and 1 instance has another one" in out
    assert "note: an instance is solved here if it has a plan" in out
    code, out, err = command(*pouring, "--instances", "x.csv", "--output", "other.csv")
    assert (code, out) == (2, "")
    assert "no column 'y', and it varies" in err
    assert not Path("other.csv").exists()


def test_another_model_needs_only_the_arm(command, library, places, shared) -> None:
    calibrated = shared / "reference" / "baxter_left_calibrated.sdf"
    code, _, err = command(
        "evaluate", "pouring", "--demonstrations", library, "--instances", places,
        "--output", "out.csv", "--model", calibrated,
    )  # fmt: skip
    assert (code, err) == (0, "")
    assert Path("out.csv").read_text().count("0:0") >= 2


@pytest.mark.parametrize("task", ["pouring", "scooping"])
def test_evaluate_agrees_with_the_outcomes_of_another_planner(
    command, shared, task, tmp_path
) -> None:
    lines = (shared / "reference" / f"outcomes_{task}.csv").read_text().splitlines()
    theirs = [line.split(",") for line in lines]
    places = tmp_path / "places.csv"
    places.write_text("\n".join(",".join(row[:2]) for row in theirs) + "\n")
    code, _, _ = command(
        "evaluate", f"{task}_paper", "--demonstrations", shared / "demos" / task,
        "--instances", places, "--output", "out.csv",
        "--model", shared / "reference" / "baxter_left_calibrated.sdf",
    )  # fmt: skip
    assert code == 0
    ours = [line.split(",") for line in Path("out.csv").read_text().splitlines()]
    assert ours[0] == theirs[0]
    a, b = (np.array([row[2:] for row in rows[1:]]) for rows in (ours, theirs))
    assert ((a == "0:0") == (b == "0:0")).mean() >= 0.994
    both = (a != "0:0") & (b != "0:0")
    segment = [np.array([c.split(":")[0] for c in codes[both]]) for codes in (a, b)]
    assert (segment[0] == segment[1]).mean() >= 0.97


def test_the_bodies_that_touch_have_a_column(command, library, places) -> None:
    code, out, _ = command(
        "evaluate", "pouring", "--demonstrations", library, "--instances", places,
        "--output", "out.csv", "--set", LAMP, "--set", TURNED,
    )  # fmt: skip
    assert code == 0
    rows = list(csv.DictReader(Path("out.csv").read_text().splitlines()))
    collided = 0
    for row in rows:
        for name in ("demo_01", "demo_02", "demo_03"):
            bodies = row.get(f"{name}:touches", "")
            assert bool(bodies) == row[name].endswith(":c")
            collided += bool(bodies)
            assert bodies == "" or bodies.endswith("-lamp")
    assert collided > 0
    assert rows[1]["demo_02"].endswith(":c")
    assert re.search(r"\d of \d failures are collisions: (\w+-lamp \d+%(, )?)+$", out, re.MULTILINE)


def test_a_table_is_the_same_however_it_is_divided_and_whatever_it_is_called(
    library, tmp_path, monkeypatch
) -> None:
    """Blocks of seven and portions of three, against all at once; CSV against Parquet."""
    scenario = load_scenario("pouring", [LAMP, TURNED])
    x = np.round(np.linspace(0.75, 1.05, 40), 3)
    y = np.round(np.tile([0.1, 0.3, 0.35, -0.2], 10), 3)
    places = tmp_path / "places.csv"
    rows = "".join(f"{a},{b},{i}\n" for i, (a, b) in enumerate(zip(x, y, strict=True)))
    places.write_text(f"x,y,note\n{rows}")
    pq.write_table(pa.table({"y": y, "x": x}), tmp_path / "places.parquet")
    whole = tabulate_outcomes(scenario, library, places, tmp_path / "whole.csv")
    assert whole.collisions is not None
    assert whole.collisions.collisions > 0
    monkeypatch.setattr(instance_files, "ROWS", 7)
    monkeypatch.setattr(outcome_table, "PORTION", (3, 3))
    told: list[Step] = []
    divided = tabulate_outcomes(
        scenario, library, tmp_path / "places.parquet", tmp_path / "out.csv", tell=told.append
    )
    columns = tabulate_outcomes(scenario, library, places, tmp_path / "out.parquet")
    assert (tmp_path / "out.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()
    for name in ("instances", "outside", "success_rates", "solved", "arms", "collisions"):
        assert getattr(whole, name) == getattr(divided, name) == getattr(columns, name)
    planned = [step for step in told if step.words == "planning instances"]
    assert [step.done for step in planned[:4]] == [0, 3, 6, 7]
    assert {step.total for step in planned} == {40}
    text = list(csv.DictReader((tmp_path / "whole.csv").open()))
    table = pq.read_table(tmp_path / "out.parquet")
    assert table.column_names == list(text[0])
    for name in table.column_names:
        values = table[name].to_pylist()
        words = [f"{v:.9g}" if isinstance(v, float) else v for v in values]
        assert words == [row[name] for row in text]


def test_a_wrong_row_deep_in_a_table_ends_it_before_anything_is_planned(
    command, library, tmp_path
) -> None:
    rows = "0.8,0.1\n" * 40_000
    (tmp_path / "places.csv").write_text(f"x,y\n{rows}0.8,O.1\n{rows}")
    Path("out.csv").write_text("as it was")
    code, out, err = command(
        "evaluate", "pouring", "--demonstrations", library, "--instances", "places.csv",
        "--output", "out.csv",
    )  # fmt: skip
    assert (code, out) == (2, "")
    assert err == ("error: places.csv:40002: y is 'O.1', expected a number from -1000 to 1000\n")
    assert Path("out.csv").read_text() == "as it was"
    assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ("none/out.csv", "none/out.csv: cannot be written: there is no folder 'none'"),
        ("out.parquet.gz", "out.parquet.gz: Parquet is compressed already"),
        ("{places}", "{places}: --instances and --output name one file"),
        ("pipe", "pipe: cannot be written: it is a device or a pipe, not a file"),
    ],
)
def test_where_no_table_can_be_is_said_first(command, library, places, output, message) -> None:
    os.mkfifo("pipe")
    code, out, err = command(
        "evaluate", "pouring", "--demonstrations", library, "--instances", places,
        "--output", output.format(places=places),
    )  # fmt: skip
    assert (code, out) == (2, "")
    assert err.startswith(f"error: {message.format(places=places)}")


@pytest.mark.slow
def test_what_was_executed_is_evaluated_again(command, certified, tmp_path) -> None:
    """The table of executions says where objects were as `evaluate` wants it."""
    run = shutil.copytree(certified, tmp_path / "run")
    code, *_ = command("execute", run, "--instance", "bowl=0.9,0.3", "--workers", "1")
    assert code == 0
    (table,) = (run / "executions").glob("*/executions.csv")
    code, *_ = command(
        "evaluate", "pouring", "--demonstrations", run / "demonstrations",
        "--instances", table, "--output", "out.csv", "--json", "out.json",
        "--set", TURNED,
    )  # fmt: skip
    assert code == 0
    assert Path("out.csv").read_text().splitlines()[1].startswith("0.9,0.3,")
    assert json.loads(Path("out.json").read_text())["solved"] == 1.0
