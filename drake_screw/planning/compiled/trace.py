"""The steps that plans take, written down on the way so that their joint paths are known.

Compiled as part of the code of an arm (kernel.py), and not on its own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from drake_screw.planning.compiled.rows import PROGRESS, STEP, at

Array = NDArray[np.float64]
Index = NDArray[np.int64]

BEND = (
    -12715105075 / 11282082432,
    0.0,
    87487479700 / 32700410799,
    -10690763975 / 1880347072,
    701980252875 / 199316789632,
    -1453857185 / 822651844,
    69997945 / 29380423,
)
"""Weights of the velocities at a step's seven stages in the fourth-order continuous extension of
Dormand and Prince's pair: Shampine, "Some practical Runge-Kutta formulas" (1986); Hairer, Norsett
and Wanner, Solving Ordinary Differential Equations I, section II.6."""


class Trace(NamedTuple):
    """Accepted steps of plans, each instance planned with one demonstration.

    Attributes:
        steps: (N,) how many each plan takes; (0,) if no trace is kept.
        first: (N + 1,) where the steps of each plan begin; those that find no place are counted.
        segment: (T,) the segment that a step lies in, from 0.
        s: (T, 2) at its start and its end; 1 at both in a correction at a segment's end.
        part: (T,) how much of it the plan goes along: all of it, 1, unless it fails there.
        q: (T, 5, n) joint positions at its start and end; the velocities there, and `BEND` of those
            at all stages, each times the step.
    """

    steps: Index
    first: Index
    segment: Index
    s: Array
    part: Array
    q: Array


def new_trace(places: Index, n: int) -> Trace:
    """A trace for N plans of an arm of n joints, with a number (N,) of places for each."""
    first = np.cumsum([0, *places], dtype=np.int64)
    T = int(first[-1])
    steps = np.zeros(len(places), dtype=np.int64)
    segment, q = np.zeros(T, dtype=np.int64), np.zeros((T, 5, n))
    return Trace(steps, first, segment, np.zeros((T, 2)), np.zeros(T), q)


@njit(error_model="numpy", _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True)
def trace_step(b, i, rows, plan, segment, correction, trace):  # type: ignore[no-untyped-def]
    """Writes down a lane's step, if there is a place left for it; counts it in any case."""
    k = trace.first[plan] + trace.steps[plan]
    trace.steps[plan] += 1
    if k >= trace.first[plan + 1]:
        return
    n, step = rows.q_stage - rows.q, b[at(STEP, i)]
    begin = b[at(PROGRESS, i)]
    end = begin + step if begin + step < 1.0 - 1e-9 else 1.0
    trace.segment[k] = segment
    trace.s[k, 0] = 1.0 if correction else begin
    trace.s[k, 1] = end
    trace.part[k] = 1.0
    slope0 = rows.q_stage + 2 * n
    for j in range(n):
        bend = 0.0
        for stage in range(7):
            bend += BEND[stage] * b[at(slope0 + stage * n + j, i)]
        trace.q[k, 0, j] = b[at(rows.q + j, i)]
        trace.q[k, 1, j] = b[at(rows.q_stage + j, i)]
        trace.q[k, 2, j] = step * b[at(slope0 + j, i)]
        trace.q[k, 3, j] = step * b[at(slope0 + 6 * n + j, i)]
        trace.q[k, 4, j] = step * bend


@njit(error_model="numpy", _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True)
def end_trace(plan, part, trace):  # type: ignore[no-untyped-def]
    """Writes down how much of its last step a plan goes along."""
    k = trace.first[plan] + trace.steps[plan] - 1
    if k < trace.first[plan + 1]:
        trace.part[k] = part
