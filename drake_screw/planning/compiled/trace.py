"""The steps that plans take, written down on the way so that their joint paths are known.

Compiled as part of the code of an arm (kernel.py), and not on its own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.compiled.inner import inner
from drake_screw.planning.compiled.rows import LANES, PROGRESS, STEP, at

STEPS = 48
"""Steps of a plan that room is kept for, on average; most take about 15."""

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


NOTHING, SUCCESSES, ALL = range(3)
"""Of which plans the steps are kept."""


class Trace(NamedTuple):
    """Accepted steps of plans: of those at work, and of those that are done.

    Attributes:
        keep: NOTHING, SUCCESSES or ALL.
        lane_segment: (LANES, L) of the steps of the plans at work, as below; lane_s: (LANES, L, 2);
            lane_q: (LANES, L, 5, n).
        used: (3,) plans and steps that are kept, and plans that found no room.
        plan: (P, 2) the instance and the demonstration of each.
        first: (P + 1,) where the steps of each plan begin.
        segment: (T,) the segment that a step lies in, from 0.
        s: (T, 2) at its start and its end; 1 at both in a correction at a segment's end.
        part: (T,) how much of it the plan goes along: all of it, 1, unless it fails there.
        q: (T, 5, n) joint positions at its start and end; the velocities there, and `BEND` of those
            at all stages, each times the step.
    """

    keep: int
    lane_segment: Index
    lane_s: Array
    lane_q: Array
    used: Index
    plan: Index
    first: Index
    segment: Index
    s: Array
    part: Array
    q: Array

    def done(self) -> Trace:
        """The plans that are done, without the room for more."""
        plans, steps = int(self.used[0]), int(self.used[1])
        return self._replace(
            plan=self.plan[:plans],
            first=self.first[: plans + 1],
            segment=self.segment[:steps],
            s=self.s[:steps],
            part=self.part[:steps],
            q=self.q[:steps],
        )

    def of(self, order: Index) -> Trace:
        """The plans of an order (p,) of those that are done, one after the other."""
        lengths = np.diff(self.first)[order]
        first = np.concatenate([[0], np.cumsum(lengths)])
        steps = np.arange(first[-1]) + np.repeat(self.first[:-1][order] - first[:-1], lengths)
        return self._replace(
            plan=self.plan[order],
            first=first,
            segment=self.segment[steps],
            s=self.s[steps],
            part=self.part[steps],
            q=self.q[steps],
        )


def new_trace(
    n: int, keep: int = NOTHING, *, plans: int = 0, most: int = 0, times: int = 1
) -> Trace:
    """Room for plans of an arm of n joints.

    Args:
        keep: NOTHING, SUCCESSES or ALL.
        plans: how many.
        most: steps that each may take.
        times: of STEPS, that they may take on average.
    """
    steps = min(plans * times * STEPS + most, plans * most)
    lanes = LANES if keep != NOTHING else 0
    return Trace(
        keep,
        np.zeros((lanes, most), dtype=np.int64),
        np.zeros((lanes, most, 2)),
        np.zeros((lanes, most, 5, n)),
        np.zeros(3, dtype=np.int64),
        np.zeros((plans, 2), dtype=np.int64),
        np.zeros(plans + 1, dtype=np.int64),
        np.zeros(steps, dtype=np.int64),
        np.zeros((steps, 2)),
        np.zeros(steps),
        np.zeros((steps, 5, n)),
    )


def dense_output(q: Array, u: Array) -> Array:
    """Joint positions (m, n) in steps (m, 5, n) of a trace, at fractions u (m,) of them.

    A step of Dormand and Prince's pair is continued to a polynomial of fourth order between its
    ends (Hairer, Norsett and Wanner, section II.6).
    """
    q0, q1, d0, d1, bend = np.moveaxis(q, 1, 0)
    u = u[:, None]
    v = 1.0 - u
    return q0 + u * (q1 - q0) + u * v * (v * (d0 - q1 + q0) + u * (q1 - q0 - d1) + u * v * bend)


@inner
def trace_step(b, i, k, rows, segment, correction, trace):  # type: ignore[no-untyped-def]
    """Writes down a lane's step, its k-th, if there is room for it."""
    if k >= trace.lane_segment.shape[1]:
        return
    n, step = rows.q_stage - rows.q, b[at(STEP, i)]
    begin = b[at(PROGRESS, i)]
    end = begin + step if begin + step < 1.0 - 1e-9 else 1.0
    trace.lane_segment[i, k] = segment
    trace.lane_s[i, k, 0] = 1.0 if correction else begin
    trace.lane_s[i, k, 1] = end
    q = trace.lane_q[i, k]
    slope0 = rows.q_stage + 2 * n
    for j in range(n):
        bend = 0.0
        for stage in range(7):
            bend += BEND[stage] * b[at(slope0 + stage * n + j, i)]
        q[0, j] = b[at(rows.q + j, i)]
        q[1, j] = b[at(rows.q_stage + j, i)]
        q[2, j] = step * b[at(slope0 + j, i)]
        q[3, j] = step * b[at(slope0 + 6 * n + j, i)]
        q[4, j] = step * bend


@inner
def keep_plan(i, steps, instance, demonstration, part, trace):  # type: ignore[no-untyped-def]
    """Keeps the steps of a plan that is done, if there is room for them.

    Args:
        i: the lane.
        steps: that it took.
        part: how much of the last one the plan goes along.
    """
    plan, first = trace.used[0], trace.used[1]
    room = trace.lane_segment.shape[1]
    if steps > room or first + steps > len(trace.segment) or plan >= len(trace.plan):
        trace.used[2] += 1
        return
    for k in range(steps):
        trace.segment[first + k] = trace.lane_segment[i, k]
        trace.s[first + k, 0] = trace.lane_s[i, k, 0]
        trace.s[first + k, 1] = trace.lane_s[i, k, 1]
        trace.part[first + k] = 1.0
        for row in range(5):
            for j in range(trace.q.shape[2]):
                trace.q[first + k, row, j] = trace.lane_q[i, k, row, j]
    if steps > 0:
        trace.part[first + steps - 1] = part
    trace.plan[plan, 0], trace.plan[plan, 1] = instance, demonstration
    trace.first[plan + 1] = first + steps
    trace.used[0] += 1
    trace.used[1] += steps
