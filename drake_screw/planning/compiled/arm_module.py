"""The compiled code of an arm: written to a file of its own, compiled once, loaded ever after.

The file's name carries a hash of all that its machine code depends on, the processor included, so
that it is never stale, and numba keeps the machine code next to it.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import platform
import shutil
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from types import ModuleType

import llvmlite.binding  # type: ignore[import-untyped]
import numba

from drake_screw.cache_folder import cache_folder
from drake_screw.planning import contract, outcomes
from drake_screw.planning.compiled import (
    crossing,
    inner,
    lanes,
    lowering,
    rolling,
    rows,
    step_code,
    trace,
)
from drake_screw.planning.compiled.expressions import Program
from drake_screw.planning.compiled.link_frames import LinkFrames
from drake_screw.planning.compiled.lowering import lane_code
from drake_screw.typing import Array

_SOURCES = (contract, crossing, inner, lanes, lowering, outcomes, rolling, rows, trace)
"""Modules that are compiled into that of an arm."""

_TEXT = '''"""Plans of one arm, on blocks of lanes; written by drake_screw.planning.compiled.

The arm's programs (aim, blend_1, ...) are put in here before this text is run.
"""

from drake_screw.compile_cache import cached_njit
from drake_screw.planning.compiled.lanes import begin_plan, next_unit, save_start, settle
from drake_screw.planning.compiled.rows import LANES


@cached_njit(nogil=True, error_model="numpy")
def prepare(b, rows, q_start, start):
    """Fills start with what `arrive` says of the start configuration (n,)."""
    for j in range(len(q_start)):
        for i in range(LANES):
            b[(rows.q_stage + j) * LANES + i] = q_start[j]
    arrive(b)
    save_start(b, 0, rows, start)


@cached_njit(nogil=True, error_model="numpy")
def run(b, lanes, queue, units, rows, problem, answers):
    """Works through all units of work."""
    for i in range(LANES):
        next_unit(i, lanes, queue, units)
        if lanes[i, 0] >= 0:
            begin_plan(b, i, lanes, rows, problem)
    while True:
        aim(b)
        blend_1(b)
        rate(b)
        blend_2(b)
        rate(b)
        blend_3(b)
        rate(b)
        blend_4(b)
        rate(b)
        blend_5(b)
        rate(b)
        blend_6(b)
        arrive(b)
        judge(b)
        if settle(b, lanes, queue, units, rows, problem, answers) == 0:
            return
'''


def programs(
    frames: LinkFrames, lower: Array, upper: Array, settings: step_code.Settings
) -> tuple[tuple[Program, ...], int]:
    """All programs of an arm, and the number of rows of its blocks."""
    n, limits = len(frames.revolute), settings.limits(lower, upper)
    arrive, aim, count = step_code.arrive_and_aim(frames, settings, limits)
    blends = [step_code.blend(n, stage) for stage in range(1, len(step_code.TABLEAU) + 1)]
    judge = step_code.judge(lower, upper, settings)
    rate = step_code.rate(frames, limits, roll_free=settings.roll_free)
    return (*blends, rate, arrive, judge, aim), count


def load(programs: Sequence[Program]) -> ModuleType:
    """The module that runs these programs, from the cache if it was ever loaded before."""
    parts = [
        _TEXT,
        *map(str, programs),
        numba.__version__,
        platform.python_version(),
        llvmlite.binding.get_host_cpu_name(),
        *(Path(m.__file__ or "").read_text() for m in _SOURCES),
    ]
    name = "arm_" + hashlib.sha256("\0".join(parts).encode()).hexdigest()[:24]
    if name in sys.modules:
        return sys.modules[name]
    path = cache_folder() / f"{name}.py"
    if path.is_dir():
        shutil.rmtree(path)
    if not path.exists() or path.read_bytes() != _TEXT.encode():
        with tempfile.NamedTemporaryFile("w", dir=path.parent, delete=False) as file:
            file.write(_TEXT)
        os.chmod(file.name, 0o644)
        os.replace(file.name, path)
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    vars(module).update({program.name: lane_code(program, name) for program in programs})
    spec.loader.exec_module(module)
    return module


def is_compiled(module: ModuleType) -> bool:
    """Whether the module's machine code was made before, in this process or an earlier one."""
    return _mark(module).exists()


def mark_compiled(module: ModuleType) -> None:
    """Remember that the module has been used, and so compiled and cached."""
    if not is_compiled(module):
        with suppress(OSError):
            _mark(module).touch()


def _mark(module: ModuleType) -> Path:
    return Path(str(module.__file__)).with_suffix(".compiled")
