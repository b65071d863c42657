"""What happens to one lane of a block at a time: start a plan, end a segment, end the plan.

Compiled as part of the code of an arm (kernel.py), and not on its own.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import uintp
from numpy.typing import NDArray

from drake_screw.planning.compiled.crossing import first_crossing
from drake_screw.planning.compiled.inner import inner
from drake_screw.planning.compiled.rolling import roll_target
from drake_screw.planning.compiled.rows import (
    ACCEPTED,
    AIM,
    EVENT,
    HAND,
    LANES,
    MARGIN,
    NEXT_STEP,
    OFF_PLACE,
    OFF_TURN,
    POSE,
    PROGRESS,
    RATE_END,
    RATE_START,
    RESIDUAL,
    STEP,
    TARGET,
    at,
)
from drake_screw.planning.compiled.trace import ALL, NOTHING, Trace, keep_plan, trace_step
from drake_screw.planning.contract import POSITION_TOLERANCE, ROTATION_TOLERANCE
from drake_screw.planning.outcomes import Cause

CORRECTIONS = 3
"""A segment that misses its guiding pose is followed by a small one to it, at most this often."""

SUCCESS, JOINT_LIMIT = int(Cause.SUCCESS), int(Cause.JOINT_LIMIT)
UNREACHABLE = int(Cause.UNREACHABLE)

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class Bounds(NamedTuple):
    """What a plan must keep to.

    Attributes:
        limits: (2, n) lower and upper joint limits.
        rate2, residual2: squares of the bounds on |dq/ds| and on the residual, per unit of
            end-effector motion.
        step: of s, at least.
    """

    limits: Array
    rate2: float
    residual2: float
    step: float


class Problem(NamedTuple):
    """What to plan. B is the arm's base frame, N instances, D demonstrations, k objects.

    Attributes:
        X_BO: (N, k, 4, 4) object poses.
        X_OE: (g, 4, 4) guiding poses of all demonstrations, one after the other.
        objects: (g,) the object each belongs to.
        first: (D + 1,) where each demonstration's begin; the last entry is g.
        order: (N or 1, D) demonstrations in the order in which to try them.
        starts: (S, ...) start configurations, with what `arrive` says of each.
        begins: (D,) which of them each demonstration begins at.
        bounds: to keep to.
        roll_free: whether the roll about the end effector's z axis is not followed.
    """

    X_BO: Array
    X_OE: Array
    objects: Index
    first: Index
    order: Index
    starts: Array
    begins: Index
    bounds: Bounds
    roll_free: bool


class Places(NamedTuple):
    """Rows of a block that depend on the arm: of q, q_stage and kept values; their number."""

    q: int
    q_stage: int
    kept: int
    end: int


class Answers(NamedTuple):
    """(N, D) arrays, by instance and demonstration, and the trace of the steps.

    `pair` is that of bodies that touch, or -1.
    """

    cause: NDArray[np.uint8]
    segment: NDArray[np.int16]
    joint: NDArray[np.int8]
    fraction: NDArray[np.float32]
    pair: NDArray[np.int16]
    steps: NDArray[np.int32]
    trace: Trace

    def part(self, index: Any) -> Answers:
        """The answers at an index, with the same trace."""
        return Answers(
            self.cause[index],
            self.segment[index],
            self.joint[index],
            self.fraction[index],
            self.pair[index],
            self.steps[index],
            self.trace,
        )


ITEM, END, GUIDE, INSTANCE, DEMONSTRATION, CORRECTION, STEPS, KEPT = range(8)
"""Columns of the integer state of the lanes, (LANES, 8): the present item of work, instance times D
plus rank in the order (-1: none left); where its run of items ends; the guiding pose ahead; ..."""


@inner
def settle(b, lanes, queue, units, rows, problem, answers):  # type: ignore[no-untyped-def]
    """Decides for every lane with an event, and starts plans in lanes that are free.

    Args:
        b: the block.
        lanes: (LANES, 8) int64.
        queue: (1,) int64: the next unit of work.
        units: (U, 2) int64: the first item of each and the one after its last.
        rows: Places.

    Returns:
        The number of lanes at work.
    """
    busy = 0
    for i in range(LANES):
        if lanes[i, ITEM] < 0:
            b[at(NEXT_STEP, i)] = 1.0
            continue
        busy += 1
        lanes[i, STEPS] += 1
        if answers.trace.keep != NOTHING and b[at(ACCEPTED, i)] != 0.0:
            segment = lanes[i, GUIDE] - problem.first[lanes[i, DEMONSTRATION]]
            correction = lanes[i, CORRECTION] > 0
            trace_step(b, i, lanes[i, KEPT], rows, segment, correction, answers.trace)
            lanes[i, KEPT] += 1
        if b[at(EVENT, i)] == 0.0:
            continue
        cause, joint, fraction, part = decide(b, i, lanes, rows, problem)
        if cause < 0:
            continue
        if answers.trace.keep == ALL or (answers.trace.keep != NOTHING and cause == SUCCESS):
            whole = 1.0 if b[at(ACCEPTED, i)] == 0.0 else part
            keep_plan(
                i, lanes[i, KEPT], lanes[i, INSTANCE], lanes[i, DEMONSTRATION], whole, answers.trace
            )
        plan = lanes[i, INSTANCE], lanes[i, DEMONSTRATION]
        answers.cause[plan] = cause
        done = cause == SUCCESS
        answers.segment[plan] = (
            -1 if done else lanes[i, GUIDE] - problem.first[lanes[i, DEMONSTRATION]]
        )
        answers.joint[plan] = joint
        answers.fraction[plan] = fraction
        answers.steps[plan] = lanes[i, STEPS]
        lanes[i, ITEM] += 1
        if done or lanes[i, ITEM] == lanes[i, END]:
            next_unit(i, lanes, queue, units)
        if lanes[i, ITEM] >= 0:
            begin_plan(b, i, lanes, rows, problem)
        else:
            busy -= 1
    return busy


@inner
def next_unit(i, lanes, queue, units):  # type: ignore[no-untyped-def]
    """Gives a lane the next unit of work, if any is left."""
    if queue[0] == len(units):
        lanes[i, ITEM] = -1
        return
    lanes[i, ITEM] = units[queue[0], 0]
    lanes[i, END] = units[queue[0], 1]
    queue[0] += 1


@inner
def begin_plan(b, i, lanes, rows, problem):  # type: ignore[no-untyped-def]
    """Puts a lane at its start configuration, aiming at the first guiding pose."""
    instance, rank = divmod(lanes[i, ITEM], problem.order.shape[1])
    demonstration = problem.order[min(instance, problem.order.shape[0] - 1), rank]
    lanes[i, INSTANCE] = instance
    lanes[i, DEMONSTRATION] = demonstration
    lanes[i, GUIDE] = problem.first[demonstration]
    lanes[i, STEPS] = 0
    lanes[i, KEPT] = 0
    load_start(b, i, rows, problem.starts, uintp(problem.begins[demonstration]))
    b[at(ACCEPTED, i)] = 1.0
    aim_at_guide(b, i, lanes, problem)


@inner
def load_start(b, i, rows, starts, k):  # type: ignore[no-untyped-def]
    """Puts a lane at the end of a step that ended in start configuration k."""
    n = rows.q_stage - rows.q
    for j in range(n):
        b[at(rows.q_stage + j, i)] = starts[k, uintp(j)]
    for m in range(12):
        b[at(POSE + m, i)] = starts[k, uintp(n + m)]
    for m in range(rows.end - rows.kept):
        b[at(rows.kept + m, i)] = starts[k, uintp(n + 12 + m)]


@inner
def save_start(b, i, rows, start):  # type: ignore[no-untyped-def]
    """The opposite of load_start."""
    n = rows.q_stage - rows.q
    for j in range(n):
        start[j] = b[at(rows.q_stage + j, i)]
    for k in range(12):
        start[n + k] = b[at(POSE + k, i)]
    for k in range(rows.end - rows.kept):
        start[n + 12 + k] = b[at(rows.kept + k, i)]


@inner
def aim_at_guide(b, i, lanes, problem):  # type: ignore[no-untyped-def]
    """Starts the segment to the guiding pose ahead: X_BG = X_BO X_OE.

    Where the roll is free, G is rolled as far as the end effector is from the guiding pose before.
    """
    guide = lanes[i, GUIDE]
    m, k = uintp(lanes[i, INSTANCE]), uintp(problem.objects[guide])
    g = uintp(guide)
    X_BO, X_OE = problem.X_BO, problem.X_OE
    for r in range(3):
        for c in range(4):
            value = X_BO[m, k, r, 3] if c == 3 else 0.0
            for a in range(3):
                value += X_BO[m, k, r, a] * X_OE[g, a, c]
            b[at(TARGET + 4 * r + c, i)] = value
    if problem.roll_free and guide > problem.first[lanes[i, DEMONSTRATION]]:
        roll_target(b, i, m, uintp(problem.objects[guide - 1]), uintp(guide - 1), X_BO, X_OE)
    lanes[i, CORRECTION] = 0
    b[at(AIM, i)] = 1.0


@inner
def decide(b, i, lanes, rows, problem):  # type: ignore[no-untyped-def]
    """What the event of a lane means.

    Where a step ends beyond the bound on |dq/ds|, 1 / |dq/ds|^2 is taken to fall linearly, as it
    does at the end of the arm's reach, to decide whether a joint reaches its limit before.

    Returns:
        cause (-1: the plan goes on), joint, fraction of the segment, part of the step.
    """
    progress, step = b[at(PROGRESS, i)], b[at(STEP, i)]
    hand2, start2, end2 = b[at(HAND, i)], b[at(RATE_START, i)], b[at(RATE_END, i)]
    bound = problem.bounds.rate2 * hand2
    if lanes[i, CORRECTION] > 0:
        progress, step = 1.0, 0.0
    residuals = b[at(RESIDUAL, i)] > problem.bounds.residual2 * hand2
    if b[at(ACCEPTED, i)] == 0.0 or start2 > bound or residuals:
        return UNREACHABLE, -1, progress, 0.0
    near_singular = (1.0 - start2 / bound) / (1.0 - start2 / end2) if end2 > bound else 2.0
    if b[at(MARGIN, i)] <= 0.0:
        joint, u = first_crossing(b, i, rows, problem.bounds.limits)
        if joint >= 0 and u <= near_singular:
            return JOINT_LIMIT, joint, progress + u * step, u
    if near_singular <= 1.0:
        return UNREACHABLE, -1, progress + near_singular * step, near_singular
    progress += step
    if progress < 1.0 - 1e-9:
        cause = UNREACHABLE if b[at(NEXT_STEP, i)] < problem.bounds.step else -1
        return cause, -1, progress, 1.0
    if (
        b[at(OFF_PLACE, i)] <= POSITION_TOLERANCE**2
        and b[at(OFF_TURN, i)] <= 2.0 * ROTATION_TOLERANCE**2
    ):
        lanes[i, GUIDE] += 1
        if lanes[i, GUIDE] == problem.first[lanes[i, DEMONSTRATION] + 1]:
            return SUCCESS, -1, 1.0, 1.0
        aim_at_guide(b, i, lanes, problem)
        return -1, -1, 0.0, 1.0
    lanes[i, CORRECTION] += 1
    b[at(AIM, i)] = 2.0
    return UNREACHABLE if lanes[i, CORRECTION] > CORRECTIONS else -1, -1, 1.0, 1.0
