"""Verbs that share work out on a cluster."""

from __future__ import annotations

import csv
import dataclasses
import pickle
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from distributed import LocalCluster

from drake_screw.assembly.setup import Setup
from drake_screw.errors import ModelError
from drake_screw.runs.shared_outcomes import JOB, SharedOutcomes
from drake_screw.scenario.loader import load_scenario
from tests.commands.conftest import Command


class Here:
    """An executor that does every call at once."""

    tries, width, lot_seconds = 1, 2, 0.25

    def submit(self, call: Callable[..., Any], *arguments: Any) -> Future:
        future: Future = Future()
        try:
            future.set_result(call(*pickle.loads(pickle.dumps(arguments))))
        except ModelError as error:
            future.set_exception(error)
        return future

    def watch(self) -> None:
        pass

    def lost(self, error: Exception) -> None:
        return None

    def close(self) -> None:
        pass


def test_outcomes_that_were_sent_are_those_of_this_process(library: Path) -> None:
    setup = Setup(load_scenario("pouring"))
    learned = [setup.learn(recording) for recording in setup.recordings(library)]
    rng = np.random.default_rng(3)
    places = np.zeros((2 * JOB + 7, 1, 3))
    places[:, 0, :2] = rng.uniform([0.7, -0.2], [1.1, 0.8], (len(places), 2))
    told: list[int] = []
    shared = SharedOutcomes(setup, learned, Here())
    found, expected = shared.plan(places, told.append), setup.evaluate(learned, places)
    for name in ("cause", "segment", "joint", "fraction", "variant", "pair", "arm"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    assert sorted(told) == [7, JOB, JOB]
    assert 0.0 < found.success.mean() < 1.0
    other = dataclasses.replace(setup.workcell.model, hash="0" * 64)
    setup.workcell = dataclasses.replace(setup.workcell, model=other)
    with pytest.raises(ModelError, match="not the one that the table was begun with"):
        SharedOutcomes(setup, learned, Here()).plan(places, told.append)


@pytest.mark.slow
def test_a_table_planned_on_a_cluster_is_that_of_this_machine(
    command: Command, library: Path
) -> None:
    x, y = np.meshgrid(np.linspace(0.7, 1.1, 37), np.linspace(-0.2, 0.8, 37))
    rows = [f"{a:.4f},{b:.4f}" for a, b in zip(x.ravel(), y.ravel(), strict=True)]
    Path("places.csv").write_text("\n".join(["x,y", *rows]))
    given = ["evaluate", "pouring", "--demonstrations", library, "--instances", "places.csv"]
    with LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, protocol="tcp", dashboard_address=":0"
    ) as local:
        for name, more in (("here", []), ("there", ["--scheduler", local.scheduler_address])):
            code, out, _ = command(*given, "--output", f"{name}.csv", *more)
            assert code == 0
    assert "shared out on 2 worker threads at tcp://" in out
    assert Path("here.csv").read_bytes() == Path("there.csv").read_bytes()
    assert len(Path("here.csv").read_text().splitlines()) == 1 + 37 * 37


@pytest.mark.slow
def test_executions_on_a_cluster_are_those_of_this_machine(
    command: Command, certified: Path
) -> None:
    tables = []
    with LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, protocol="tcp", dashboard_address=":0"
    ) as local:
        for more in (["--workers", 1], ["--scheduler", local.scheduler_address]):
            code, out, _ = command("execute", certified, "--instance", "0.9", "0.3", *more)
            assert code == 0
            folder = Path(out.splitlines()[-1].removeprefix("written to "))
            tables.append(list(csv.DictReader((folder / "executions.csv").open())))
    assert "shared out on 1 worker thread at tcp://" in out
    assert tables[0] == tables[1]
    assert len(tables[0]) == 1
