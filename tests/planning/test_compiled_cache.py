"""An arm is compiled once on a machine, and wherever its code can be kept."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

PROGRAM = """
import sys
import numpy as np
from drake_screw.planning import Cause
from drake_screw.planning.compiled import Kernel
from drake_screw.screws import exp

for pivot in map(float, sys.argv[1:]):
    screw = np.array([0.0, 0.0, 1.0, 0.0, -pivot, 0.0])
    kernel = Kernel(screw[None], np.eye(4), np.array([-1.0]), np.array([1.0]))
    before = kernel.compiled
    goals = exp(np.array([[0.5 * screw], [1.5 * screw]]))
    plans = kernel.plan([np.eye(4)[None]], [np.zeros(1, int)], goals, np.zeros(1))
    assert plans.cause.ravel().tolist() == [Cause.SUCCESS, Cause.JOINT_LIMIT], plans
    assert abs(plans.fraction[1, 0] - 1 / 1.5) < 1e-6
    loaded = sum(kernel._module.run.stats.cache_hits.values())
    print(before, kernel.compiled, loaded, kernel._module.__file__)
"""


def start(*pivots: float, **environment: str) -> list[tuple[bool, bool, int, Path]]:
    """Plan with arms of one joint, at these places in x, in a process of its own.

    Returns:
        For each arm: compiled before and after, how often loaded from numba's cache, and its file.
    """
    known = {k: v for k, v in os.environ.items() if k not in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME")}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *map(str, pivots)],
        env=known | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    lines = [line.split() for line in done.stdout.splitlines()]
    return [(b == "True", a == "True", int(n), Path(file)) for b, a, n, file in lines]


def test_arms_are_compiled_once_and_not_mixed_up(tmp_path: Path) -> None:
    where = {"XDG_CACHE_HOME": str(tmp_path)}
    files = []
    for pivot in (0.25, 0.75):
        ((before, after, loaded, file),) = start(pivot, **where)
        assert (before, after, loaded) == (False, True, 0)
        assert file.parent == tmp_path / "drake_screw"
        files.append(file)
    together = start(0.25, 0.75, **where)
    assert together == [(True, True, 1, file) for file in files]


def test_where_nothing_can_be_kept_it_works_all_the_same(tmp_path: Path) -> None:
    """A cache folder that cannot be made, be it on a read-only disk, gives way to the next."""
    (tmp_path / "file").touch()
    closed = str(tmp_path / "file" / "cache")
    home = str(tmp_path / "home")
    ((_, after, _, file),) = start(0.25, NUMBA_CACHE_DIR=closed, XDG_CACHE_HOME=home)
    assert after
    assert file.parent == tmp_path / "home" / "drake_screw"
    closed_too = {"NUMBA_CACHE_DIR": closed, "XDG_CACHE_HOME": closed, "TMPDIR": str(tmp_path)}
    ((_, after, _, file),) = start(0.25, **closed_too)
    assert after
    assert file.parents[1] == tmp_path
