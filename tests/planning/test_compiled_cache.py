"""An arm is compiled once on a machine, and wherever its code can be kept."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import sys
import numpy as np
from drake_screw.planning import Cause
from drake_screw.planning.compiled import Kernel
from drake_screw.screws import exp

screw = np.array([0.0, 0.0, 1.0, 0.0, float(sys.argv[1]), 0.0])
kernel = Kernel(screw[None], np.eye(4), np.array([-1.0]), np.array([1.0]))
before = kernel.compiled
goals = exp(np.array([[[0.5 * screw]], [[1.5 * screw]]]))[:, 0]
(plans,) = kernel.plan([np.eye(4)[None]], [np.zeros(1, int)], goals, np.zeros(1))
assert plans.cause.ravel().tolist() == [Cause.SUCCESS, Cause.JOINT_LIMIT]
assert abs(plans.fraction[1, 0] - 1 / 1.5) < 1e-6
loaded = sum(kernel._module.run.stats.cache_hits.values())
print(before, kernel.compiled, loaded, kernel._module.__file__)
"""

SLIDES = """
import sys
import numpy as np
from drake_screw.planning import Cause
from drake_screw.planning.compiled import Kernel

for n in map(int, sys.argv[1:]):
    screws, goals = np.zeros((n, 6)), np.tile(np.eye(4), (2, 1, 1, 1))
    screws[:, 3 : 3 + n] = np.eye(n)
    goals[0, 0, :n, 3], goals[1, 0, n - 1, 3] = 0.5, 1.5
    kernel = Kernel(screws, np.eye(4), -np.ones(n), np.ones(n))
    (plans,) = kernel.plan([np.eye(4)[None]], [np.zeros(1, int)], goals, np.zeros(n))
    assert plans.cause.ravel().tolist() == [Cause.SUCCESS, Cause.JOINT_LIMIT], (n, plans.cause)
    assert plans.joint[1, 0] == n - 1
    assert abs(plans.fraction[1, 0] - 1 / 1.5) < 1e-6
"""


@pytest.mark.slow
def test_arms_compiled_apart_share_no_code(tmp_path: Path) -> None:
    """The machine code of arms that never met may be loaded into one process, in any order."""
    for arms in (["1"], ["3"], ["1", "3"], ["3", "1"]):
        done = subprocess.run(
            [sys.executable, "-c", SLIDES, *arms],
            env=os.environ | {"XDG_CACHE_HOME": str(tmp_path), "NUMBA_CACHE_DIR": ""},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, (arms, done.stderr)


def start(screw: float, **environment: str) -> tuple[bool, bool, int, Path]:
    """In a process of its own: compiled before and after, loaded from numba's cache, where."""
    known = {k: v for k, v in os.environ.items() if k not in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME")}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(screw)],
        env=known | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    before, after, loaded, file = done.stdout.split()
    return before == "True", after == "True", int(loaded), Path(file)


@pytest.mark.slow
def test_the_second_process_loads_what_the_first_compiled(tmp_path: Path) -> None:
    where = {"XDG_CACHE_HOME": str(tmp_path)}
    assert start(-0.25, **where) == (False, True, 0, file := next(tmp_path.glob("*/arm_*.py")))
    assert file.parent == tmp_path / "drake_screw"
    assert start(-0.25, **where) == (True, True, 1, file)


@pytest.mark.slow
def test_where_nothing_can_be_kept_it_works_all_the_same(tmp_path: Path) -> None:
    """A cache folder that cannot be made, be it on a read-only disk, gives way to the next."""
    (tmp_path / "file").touch()
    closed = str(tmp_path / "file" / "cache")
    _, after, _, file = start(-0.25, NUMBA_CACHE_DIR=closed, XDG_CACHE_HOME=str(tmp_path / "home"))
    assert after
    assert file.is_relative_to(tmp_path / "home")
    _, after, _, file = start(
        -0.25, NUMBA_CACHE_DIR=closed, XDG_CACHE_HOME=closed, TMPDIR=str(tmp_path)
    )
    assert after
    assert file.parents[1] == tmp_path


TOLD = """
import logging, sys
import numpy as np
from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner
from drake_screw.robot import ScrewChain

logging.basicConfig(level=logging.INFO, stream=sys.stdout)
screw = np.array([[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]])
chain = ScrewChain(("slide",), screw, np.eye(4), np.array([-1.0]), np.array([1.0]))
one = np.eye(4)[None]
demonstration = Demonstration("d", one, np.zeros(1, int), one, one, np.zeros(1, int))
for X_WO in (np.zeros((0, 1, 4, 4)), one[None], one[None]):
    BatchPlanner(chain).any_success([demonstration], X_WO, np.zeros(1))
    print("planned", len(X_WO))
"""


@pytest.mark.slow
def test_whoever_waits_for_the_compiler_is_told_why(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", TOLD],
        env=os.environ | {"XDG_CACHE_HOME": str(tmp_path), "NUMBA_CACHE_DIR": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    first, told, *rest = done.stdout.splitlines()
    assert first == "planned 0"
    assert "compiling the planner for this arm" in told
    assert rest == ["planned 1", "planned 1"]
