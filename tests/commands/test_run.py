"""``drake-screw run``: to a certificate, to the end of the budget, and on after Ctrl-C."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

from tests.commands.conftest import NAIVE, QUICK


def test_run_leaves_a_certified_run(command, tmp_path) -> None:
    code, out, err = command("run", "pouring", *QUICK, "--seed", 3)
    assert (code, err) == (0, "")
    assert "certificate" in out
    (path,) = (tmp_path / "runs" / "pouring").iterdir()
    assert out.rstrip().endswith(str(path.relative_to(tmp_path)))
    record = json.loads((path / "run.json").read_text())
    assert record["status"] == "certified"
    assert record["strategy"] == "eprocess"
    assert record["seed"] == 3
    certificate = record["certificate"]
    assert certificate["certified"]
    assert certificate["fresh_instances"] == sum(record["rounds"][-1]["samples"])
    attempts = sum(r["verdict"]["attempted"] for r in record["rounds"])
    assert certificate["attempt"] == attempts
    assert certificate["delta_of_attempt"] == 0.05 / (attempts * (attempts + 1))
    assert f"attempt {attempts} to certify" in " ".join(out.split())
    assert len(record["demonstrations"]) == record["rounds"][-1]["demonstrations"]
    last = record["rounds"][-1]
    assert len(last["samples"]) == len(last["failure_rates"]) == 16
    assert max(last["failure_rates"]) < 1 - 0.7
    assert last["failure_rates"][last["weakest_region"]] == max(last["failure_rates"])
    for k in range(len(record["rounds"])):
        folder = path / f"round_{k + 1:02d}"
        for name in ("regions.csv", "instances.npz", "heat_map.png"):
            assert (folder / name).stat().st_size > 0
    for name in ("scenario.yaml", "run.log", "meshcat.html", "rounds.png"):
        assert (path / name).stat().st_size > 0
    assert not list(path.rglob("*.part"))


def test_a_run_ends_with_1_when_the_budget_does(command) -> None:
    code, out, _ = command(
        "run", "pouring", *QUICK, *NAIVE, "--set", "demonstrations.budget=1", "--output", "here"
    )
    record = json.loads(Path("here/run.json").read_text())
    assert code == 1
    assert record["status"] == "insufficient"
    assert "budget of 1" in out
    assert record["certificate"]["certified"] is False
    worst = max(record["rounds"][-1]["failure_rates"])
    assert record["certificate"]["coverage"] == pytest.approx(max(0, 1 - 0.15 - worst))


def test_recordings_are_asked_and_run_out(command, library) -> None:
    code, out, _ = command(
        "run", "pouring", "--demonstrations", library, "--output", "here",
        "--set", "coverage.beta=0.98", "--set", "coverage.epsilon=0.015",
        "--set", "regions.grid.x=1", "--set", "regions.grid.y=1",
    )  # fmt: skip
    record = json.loads(Path("here/run.json").read_text())
    names = [d["name"] for d in record["demonstrations"]]
    assert sorted(names) == sorted(set(names))
    assert set(names) <= {p.name for p in library.iterdir()}
    assert code == (0 if record["status"] == "certified" else 1)
    if code == 1:
        assert "all 3 recordings are used" in " ".join(out.split()).lower()


def strip(record: dict) -> dict:
    times = ("started", "finished")
    return {k: v for k, v in record.items() if k not in times}


def test_an_interrupted_run_resumes_to_the_same_result(command, monkeypatch) -> None:
    from drake_screw.acquisition import Evaluator

    command("run", "scooping", *QUICK, "--seed", 1, "--output", "whole")
    original = Evaluator.evaluate

    def interrupted(self, round, demonstrations, attempt):
        if round == 1:
            raise KeyboardInterrupt
        return original(self, round, demonstrations, attempt)

    with monkeypatch.context() as patch:
        patch.setattr(Evaluator, "evaluate", interrupted)
        code, out, _ = command("run", "scooping", *QUICK, "--seed", 1, "--output", "parts")
    assert code == 130
    assert "--resume parts" in out
    stopped = json.loads(Path("parts/run.json").read_text())
    assert stopped["status"] == "interrupted"
    assert len(stopped["rounds"]) == 1
    code, _, _ = command("run", "--resume", "parts")
    whole, parts = (json.loads(Path(p, "run.json").read_text()) for p in ("whole", "parts"))
    assert code == 0
    assert strip(whole) == strip(parts)
    for file in Path("whole").rglob("*.npz"):
        a, b = np.load(file), np.load(Path("parts") / file.relative_to("whole"))
        assert all(np.array_equal(a[name], b[name]) for name in a.files)
    code, _, err = command("run", "--resume", "parts")
    assert code == 2
    assert "has ended" in err


@pytest.mark.skipif(os.getuid() == 0, reason="root may write everywhere")
def test_an_unwritable_output_is_refused_as_a_user(command, tmp_path) -> None:
    tmp_path.chmod(0o500)
    code, _, err = command("run", "pouring", "--output", tmp_path / "sub")
    assert (code, "cannot be written" in err) == (2, True)


def test_an_output_that_cannot_be_made_is_refused(command) -> None:
    Path("file").write_text("in the way")
    code, _, err = command("run", "pouring", "--output", "file/sub")
    assert code == 2
    assert "cannot be written" in err
    code, _, err = command("run", "pouring", "--output", "file")
    assert code == 2
    assert "exists already" in err
    assert Path("file").read_text() == "in the way"
