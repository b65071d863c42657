"""A run that is killed at any moment, over and over, ends as one that was left alone."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from tests.commands.conftest import QUICK

RUN = [sys.executable, "-m", "drake_screw", "run"]
CHANGES = [*QUICK, "--set", "demonstrations.first=random", "--set", "coverage.strategy=naive_pac"]
KILLS = 20
SAME = ("status", "reason", "certificate", "demonstrations", "rounds")


def record(folder: Path) -> dict[str, object]:
    found = json.loads((folder / "run.json").read_text())
    return {name: found[name] for name in SAME}


@pytest.mark.slow
def test_kills_at_random_moments_change_nothing(tmp_path: Path) -> None:
    alone, folder = tmp_path / "alone", tmp_path / "killed"
    began = time.monotonic()
    subprocess.run([*RUN, "pouring", *CHANGES, "--output", str(alone), "-q"], check=True)
    whole = time.monotonic() - began
    rng, kills = np.random.default_rng(0), 0
    while kills < KILLS:
        command = [*RUN, "--resume", str(folder), "-q"]
        if not (folder / "run.json").exists():
            shutil.rmtree(folder, ignore_errors=True)
            command = [*RUN, "pouring", *CHANGES, "--output", str(folder), "-q"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as going:
            try:
                output, _ = going.communicate(timeout=rng.uniform(0.1, 1.0) * whole)
            except subprocess.TimeoutExpired:
                going.kill()
                kills += 1
                continue
        ended = b"this run has ended (certified)" in output  # killed when all was written
        assert going.returncode == 0 or ended, output.decode()
        assert record(folder) == record(alone)
        for round in alone.glob("round_*"):
            one, other = (np.load(f / round.name / "instances.npz") for f in (alone, folder))
            for name in one.files:
                np.testing.assert_array_equal(one[name], other[name])
        folder = folder.with_name(f"killed_{kills}")
