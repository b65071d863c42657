"""Verbs that share work out on a cluster."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
from distributed import LocalCluster

from tests.commands.conftest import Command


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
