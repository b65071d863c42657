"""One Runge-Kutta step of a block of lanes, as programs.

The pair is Dormand and Prince's 5(4), "A family of embedded Runge-Kutta formulae" (1980). A step is

    blend_1, rate, ..., blend_5, rate   stages 1..5; stage 0 is known from the step before
    blend_6, arrive                     the end of the step: dq/ds, the pose of the end effector,
                                        and what aim needs
    judge                               error, limits, velocities: is the step good, what comes next
    aim                                 take good steps, and aim again at the guiding pose

Between judge and aim the lanes that need a decision get it one by one (lanes.py).

Of the arm, blend and judge know the number of joints and the limits alone. As plain compiled code,
with loops over the joints, they take longer: measured for seven joints, judge 95 ns a lane instead
of 17, of 340 for a whole step, and blend 5.7 instead of 3.8.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass, replace
from functools import reduce
from typing import Any, cast

import numpy as np

from drake_screw.planning.compiled import rows as r
from drake_screw.planning.compiled.arm_code import Kinematics, kinematics, orientation
from drake_screw.planning.compiled.expressions import (
    Block,
    Condition,
    Expression,
    Program,
    Value,
    ceil,
    maximum,
    minimum,
    sqrt,
    varies,
    where,
)
from drake_screw.planning.compiled.functions import cos_sin, log_between
from drake_screw.planning.compiled.link_frames import LinkFrames
from drake_screw.planning.contract import (
    CHARACTERISTIC_LENGTH,
    ORIENTATION_MIN,
    RATE_LIMIT,
    RESIDUAL_LIMIT,
    STILL,
    Redundancy,
)
from drake_screw.screws.endless import is_endless
from drake_screw.typing import Array

TABLEAU = (
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
ERROR = (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)
"""Fifth minus fourth order weights."""


@dataclass(frozen=True)
class Settings:
    """What is integrated, and constants of the integrator; the defaults are measured.

    Attributes:
        tolerance: bound on the estimated error of a step, rad (m for prismatic joints).
        motion: bound on the motion of a joint in a step, rad.
        first_motion: the same for the first step of a segment.
        approach: part of the way to the next singularity that a step may take. At the end of the
            arm's reach, at s*, |dq/ds|^2 grows as 1 / (s* - s), so that s* follows from two values.
        step_min: of s; where smaller steps are needed the end effector cannot follow.
        rate_max: bound on |dq/ds| per unit of end-effector motion (see `contract.motion_size`),
            rad.
        residual_max: bound on the part of the end-effector motion that the joints cannot give.
        redundancy: what more joints than six do with the motion that the end effector leaves free.
        roll_free: whether the roll about the end effector's z axis is not followed.
    """

    tolerance: float = 1e-4
    motion: float = 0.7
    first_motion: float = 0.6
    approach: float = 0.6
    step_min: float = 1e-6
    rate_max: float = RATE_LIMIT
    residual_max: float = RESIDUAL_LIMIT
    redundancy: Redundancy = "least_norm"
    roll_free: bool = False

    @property
    def directions(self) -> int:
        """How many directions of the end effector's motion are followed."""
        return 5 if self.roll_free else 6

    def limits(self, lower: Array, upper: Array) -> Array | None:
        """Joint limits (2, n) that joints are to move away from; None where they are not to."""
        return np.stack([lower, upper]) if self.redundancy == "away_from_limits" else None


def blend(n: int, stage: int) -> Program:
    """Joint positions of a stage from the velocities at those before it."""
    b, rows = Block(), r.Rows(n)
    step, weights = b[r.STEP], np.array(TABLEAU[stage - 1])
    for j in range(n):
        slopes = [b[rows.slope(s) + j] for s in range(stage)]
        if stage > 1:
            slopes[-1] = b[rows.rate + j]
            b[rows.slope(stage - 1) + j] = slopes[-1]
        b[rows.q_stage + j] = b[rows.q + j] + step * (weights @ np.array(slopes))
    return b.program(f"blend_{stage}")


def rate(frames: LinkFrames, limits: Array | None = None, *, roll_free: bool = False) -> Program:
    """dq/ds at q_stage; limits and roll_free as for `kinematics`."""
    b, rows = Block(), r.Rows(len(frames.revolute))
    arm, _ = kinematics(frames, b[rows.q_stage : rows.rate], limits, roll_free=roll_free)
    V = arm.to_middle(b[r.TWIST : r.TWIST + 6])
    b[rows.rate : rows.slope(0)] = arm.joint_velocities(V)
    return b.program("rate")


def arrive_and_aim(
    frames: LinkFrames, settings: Settings, limits: Array | None = None
) -> tuple[Program, Program, int]:
    """The two programs, and the number of rows in a block.

    arrive: dq/ds and the pose of the end effector at the end of the step.
    aim: takes good steps, and aims again at the guiding pose.
    """
    n, d = len(frames.revolute), settings.directions
    b, rows = Block(), r.Rows(n, d)
    q = b[rows.q_stage : rows.rate]
    arm, X_BE = kinematics(frames, q, limits, roll_free=settings.roll_free)
    V = arm.to_middle(b[r.TWIST : r.TWIST + 6])
    b[rows.slope(6) : rows.slope(7)] = arm.joint_velocities(V)
    if n <= d:
        J_start = np.where(varies(arm.J), b[rows.columns : rows.kept].reshape(n, d).T, arm.J)
        b[r.ORIENTATION] = orientation(J_start, arm.J)
        b[r.VOLUME_END] = arm.factor.determinant
    b[r.POSE : r.POSE + 12] = X_BE.ravel()
    off = X_BE - b[r.TARGET : r.TARGET + 12].reshape(3, 4)
    turned = off[:, 2] * off[:, 2] * 2.0 if settings.roll_free else off[:, :3] * off[:, :3]
    b[r.OFF_TURN] = np.sum(turned)
    b[r.OFF_PLACE] = off[:, 3] @ off[:, 3]
    later = Block()
    kept = Kept(rows.kept, b, later)
    aim = _aim(later, kept.keep(arm), settings)
    return b.program("arrive"), aim, kept.end


class Kept:
    """Values that `arrive` stores and `aim` loads again; constants stay constants.

    Attributes:
        end: the first row after theirs.
    """

    def __init__(self, first_row: int, arrive: Block, aim: Block) -> None:
        self.end = first_row
        self._arrive, self._aim = arrive, aim
        self._loaded: dict[Expression, Expression] = {}

    def keep(self, values: Any) -> Any:
        """What `aim` has of a value, an array, or a dataclass of such."""
        if is_dataclass(values) and not isinstance(values, Expression):
            parts = {f.name: self.keep(getattr(values, f.name)) for f in fields(values)}
            return replace(cast(Any, values), **parts)
        return np.frompyfunc(self._keep, 1, 1)(values)

    def _keep(self, value: Value) -> Value:
        if not isinstance(value, Expression) or value.number is not None:
            return value
        if value not in self._loaded:
            if value.row is None:
                self._arrive[self.end] = value
                self._loaded[value] = self._aim[self.end]
                self.end += 1
            else:
                self._loaded[value] = self._aim[value.row]
        return self._loaded[value]


def _aim(b: Block, arm: Kinematics, settings: Settings) -> Program:
    n, d = len(arm.q), settings.directions
    rows = r.Rows(n, d)
    taken, begins = b[r.ACCEPTED] > 0.5, b[r.AIM] > 0.5
    begins_segment = begins & (b[r.AIM] < 1.5)
    done = where(taken, b[r.PROGRESS] + b[r.STEP], b[r.PROGRESS])
    done = where(begins, 0.0, done)
    left = 1.0 - done
    b[r.PROGRESS] = done

    def update(row: int | slice, new: Any, condition: Condition = taken) -> Any:
        value = where(condition, new, b[row])
        b[row] = value
        return value

    X_BE, X_BG = (b[row : row + 12].reshape(3, 4) for row in (r.POSE, r.TARGET))
    if settings.roll_free:
        ahead = where(begins, 0.0, left) * b[r.TWIST : r.TWIST + 3]
        X_BG = _rolled(X_BE, X_BG, ahead, begins_segment)
        for j, k in np.ndindex(3, 2):
            update(r.TARGET + 4 * j + k, X_BG[j, k])
    new_twist = (1.0 / left) * log_between(X_BE, X_BG)
    twist = update(slice(r.TWIST, r.TWIST + 6), new_twist)
    w, travel = twist[:3], (twist[3:] + np.cross(twist[:3], X_BE[:, 3])) / CHARACTERISTIC_LENGTH
    if settings.roll_free:
        w = X_BE[:, :2].T @ w
        update(r.HAND, w @ w + travel @ travel + STILL**2, begins_segment)
    else:
        update(r.HAND, w @ w + travel @ travel, begins_segment)

    V = arm.to_middle(new_twist)
    velocities = arm.joint_velocities(V)
    update(r.RESIDUAL, arm.residual(V, velocities) * left * left)
    slope = update(slice(rows.slope(0), rows.slope(1)), velocities)
    update(slice(rows.q, rows.q_stage), b[rows.q_stage : rows.rate])
    if n <= d:
        update(r.VOLUME_START, arm.factor.determinant)
        for j, k in np.argwhere(varies(arm.J.T)).tolist():
            update(rows.columns + d * j + k, arm.J[k, j])
    limit = settings.motion / (reduce(maximum, abs(slope)) + 1e-9)
    first = settings.first_motion / settings.motion * limit
    step = where(begins, first, minimum(b[r.NEXT_STEP], limit))
    b[r.STEP] = left / ceil(left / step)
    return b.program("aim")


def _rolled(X_BE: Array, X_BG: Array, ahead: Array, begins: Condition) -> Array:
    """The guiding pose (3, 4), rolled about its z axis as far as E is where it is aimed at again.

    Args:
        X_BE: (3, 4) where the end effector is.
        X_BG: (3, 4) what it was aimed at until now.
        ahead: (3,) rad, the turn that was left by then: E would be at R^T R_BG had it not rolled.
        begins: of a segment, when it is aimed at as it is.
    """
    angle = sqrt(ahead @ ahead)
    u = ahead * (1.0 / (angle + 1e-30))
    c, s = cos_sin(angle)
    before = [c * x - s * np.cross(u, x) + (1.0 - c) * (u @ x) * u for x in X_BG[:, :2].T]
    x, y = X_BE[:, :2].T
    cosine, sine = before[0] @ x + before[1] @ y, before[1] @ x - before[0] @ y
    size = 1.0 / sqrt(cosine * cosine + sine * sine + 1e-30)
    c, s = where(begins, 1.0, cosine * size), where(begins, 0.0, sine * size)
    x, y = X_BG[:, :2].T
    return np.column_stack([c * x + s * y, c * y - s * x, X_BG[:, 2:]])


def judge(lower: Array, upper: Array, settings: Settings) -> Program:
    """Is the step good, and does the lane need a decision?"""
    n, d = len(lower), settings.directions
    b, rows = Block(), r.Rows(n, d)
    step, hand2 = b[r.STEP], b[r.HAND]
    slopes = b[rows.slope(0) : rows.slope(7)].reshape(7, n)
    q0, q3 = b[rows.q : rows.q_stage], b[rows.q_stage : rows.rate]
    q1, q2 = q0 + 1 / 3 * step * slopes[0], q3 - 1 / 3 * step * slopes[6]
    least, most = (f(f(q1, q2), q3) for f in (minimum, maximum))
    limited = ~is_endless(lower.astype(float), upper.astype(float))
    margins = minimum(least - lower, upper - most)[limited]
    margin = reduce(minimum, margins) if limited.any() else 1.0 + abs(step)

    error = step * reduce(maximum, abs(np.array(ERROR) @ slopes)) / settings.tolerance + 1e-12
    root8 = sqrt(sqrt(sqrt(error)))
    change = minimum(5.0, maximum(0.2, 0.9 / (root8 * sqrt(root8))))
    rate2_start, *between, rate2_end = np.sum(slopes * slopes, axis=1)
    ahead = step * rate2_start / maximum(rate2_end - rate2_start, 1e-30)
    if n <= d:
        shrunk = sqrt(b[r.VOLUME_END] / maximum(b[r.VOLUME_START], 1e-60))
        ahead = minimum(ahead, step * shrunk / maximum(1.0 - shrunk, 1e-30))

    bound = settings.rate_max**2 * hand2
    stray = (reduce(maximum, between) > bound) & (rate2_end <= bound)
    stray |= ~(sum(between, rate2_end) >= 0.0)
    if n <= d:
        stray |= b[r.ORIENTATION] < -ORIENTATION_MIN
    good = (error <= 1.0) & ~stray
    longer = minimum(step * change, settings.approach * ahead)
    next_step = where(good, longer, step * where(stray, 0.2, change))
    ends = (b[r.PROGRESS] + step > 1.0 - 1e-9) | (margin <= 0.0) | (rate2_end > bound)
    stuck = (rate2_start > bound) | (b[r.RESIDUAL] > settings.residual_max**2 * hand2)
    event = (good & ends) | (next_step < settings.step_min) | stuck

    b[r.ACCEPTED] = where(good, 1.0, 0.0)
    b[r.EVENT] = where(event, 1.0, 0.0)
    b[r.NEXT_STEP] = next_step
    b[r.MARGIN] = margin
    b[r.RATE_START] = rate2_start
    b[r.RATE_END] = rate2_end
    b[r.AIM] = 0.0
    return b.program("judge")
