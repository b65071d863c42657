"""Writes one Runge-Kutta step of a block of lanes as straight-line code.

The pair is Dormand and Prince's 5(4), "A family of embedded Runge-Kutta formulae" (1980). A step is

    blend_1, rate, ..., blend_5, rate   stages 1..5; stage 0 is known from the step before
    blend_6, arrive                     the end of the step: dq/ds, the hand's pose, what aim needs
    judge                               error, limits, rates: is the step good, and what comes next
    aim                                 take the step; lanes that start a segment get its twist

Between judge and aim the lanes that need a decision get it one by one (lanes.py).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drake_screw.planning.compiled import rows as r
from drake_screw.planning.compiled.arm_code import ArmCode, Factor, Pose, fit, joint_rates
from drake_screw.planning.compiled.emitter import Emitter, Value, Vector, text
from drake_screw.planning.compiled.link_frames import LinkFrames
from drake_screw.planning.contract import LENGTH, RATE_LIMIT

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
    """Constants of the integrator; the defaults are measured.

    Attributes:
        tolerance: bound on the estimated error of a step, rad (m for prismatic joints).
        motion: bound on the motion of a joint in a step, rad.
        first_motion: the same for the first step of a segment.
        approach: part of the way to the next singularity that a step may take. At the end of the
            arm's reach, at s*, |dq/ds|^2 grows as 1 / (s* - s), so that two values of it tell s*.
        step_min: a segment that needs smaller steps of s than this is unreachable.
        rate_max: bound on |dq/ds| per hand motion sqrt(turn^2 + (travel / LENGTH)^2), rad.
    """

    tolerance: float = 1e-4
    motion: float = 0.5
    first_motion: float = 0.4
    approach: float = 0.5
    step_min: float = 1e-4
    rate_max: float = RATE_LIMIT


def blend(n: int, stage: int) -> str:
    """Joint positions of a stage from the rates of those before it."""
    e, rows = Emitter(r.LANES), r.Rows(n)
    step = e.load(r.STEP)
    for j in range(n):
        slopes: list[Value] = [e.load(rows.slope(s) + j) for s in range(stage - 1)]
        latest = e.load((rows.rate if stage > 1 else rows.slope(0)) + j)
        if stage > 1:
            e.store(rows.slope(stage - 1) + j, latest)
        motion = e.dot(TABLEAU[stage - 1], [*slopes, latest])
        e.store(rows.q_stage + j, e.sum((e.load(rows.q + j),), (step, motion)))
    return e.function(f"blend_{stage}", blend.__doc__ or "")


def rate(frames: LinkFrames) -> str:
    """dq/ds at q_stage."""
    n = len(frames.revolute)
    e, rows = Emitter(r.LANES), r.Rows(n)
    arm = ArmCode(frames, e)
    arm.walk(rows.q_stage)
    twist = arm.to_middle([e.load(r.TWIST + k) for k in range(6)])
    factor = Factor.of(e, arm.gram())
    for j, value in enumerate(joint_rates(e, arm.columns, factor, twist)):
        e.store(rows.rate + j, value)
    return e.function("rate", rate.__doc__ or "")


class Kept:
    """Values that `arrive` stores and `aim` loads again; constants stay constants."""

    def __init__(self, first_row: int, store: Emitter, load: Emitter) -> None:
        self.row = first_row
        self._store, self._load = store, load
        self._loaded: dict[str, str] = {}

    def keep(self, values: Vector) -> list[Value]:
        return [self._keep(v) if isinstance(v, str) else v for v in values]

    def _keep(self, name: str) -> str:
        if name not in self._loaded:
            self._store.store(self.row, name)
            self._loaded[name] = self._load.load(self.row)
            self.row += 1
        return self._loaded[name]


def arrive_and_aim(frames: LinkFrames, settings: Settings) -> tuple[str, str, int]:
    """The two functions, and the number of rows in a block."""
    n = len(frames.revolute)
    e, later, rows = Emitter(r.LANES), Emitter(r.LANES), r.Rows(n)
    arm = ArmCode(frames, e)
    arm.walk(rows.q_stage)
    factor = Factor.of(e, arm.gram())
    twist = arm.to_middle([e.load(r.TWIST + k) for k in range(6)])
    for j, value in enumerate(joint_rates(e, arm.columns, factor, twist)):
        e.store(rows.slope(6) + j, value)
    off_turn: list[list[Value]] = []
    off_place: list[list[Value]] = []
    for k, value in enumerate(arm.pose_of_hand()):
        e.store(r.POSE + k, value)
        off = e.sum((value,), (-1.0, e.load(r.TARGET + k)))
        (off_place if k % 4 == 3 else off_turn).append([off, off])
    e.store(r.OFF_TURN, e.sum(*off_turn))
    e.store(r.OFF_PLACE, e.sum(*off_place))

    kept = Kept(rows.kept, e, later)
    keep = kept.keep
    arm_later = ArmCode(frames, later, base=Pose(*(keep(v) for v in vars(arm.base).values())))
    arm_later.columns = [keep(column) for column in arm.columns]
    factor_later = Factor(*([keep(row) for row in block] for block in vars(factor).values()))
    _aim(arm_later, factor_later, settings)
    arrive = e.function("arrive", "dq/ds and the pose of the hand at the end of the step.")
    aim = later.function("aim", "Takes accepted steps; gives lanes that start a segment its twist.")
    return arrive, aim, kept.row


def _aim(arm: ArmCode, factor: Factor, settings: Settings) -> None:
    e, n = arm.e, len(arm.columns)
    rows = r.Rows(n)
    taken = f"{e.load(r.ACCEPTED)} > 0.5"
    aims = f"{e.load(r.AIM)} > 0.5"
    new_twist = log_between(
        e, [e.load(r.POSE + k) for k in range(12)], [e.load(r.TARGET + k) for k in range(12)]
    )
    twist = [e.where(aims, new, e.load(r.TWIST + k)) for k, new in enumerate(new_twist)]
    fastest: Value = 0.0
    new_rates = joint_rates(e, arm.columns, factor, arm.to_middle(twist))
    for j, new in enumerate(new_rates):
        slope = e.where(taken, e.load(rows.slope(6) + j), e.load(rows.slope(0) + j))
        slope = e.where(aims, new, slope)
        e.store(rows.slope(0) + j, slope)
        e.store(rows.q + j, e.where(taken, e.load(rows.q_stage + j), e.load(rows.q + j)))
        fastest = e.let(f"max({text(fastest)}, abs({slope}))")
    w = twist[:3]
    p_WE = [e.load(r.POSE + k) for k in (3, 7, 11)]
    travel = [
        e.sum((1.0 / LENGTH, v), (1.0 / LENGTH, k))
        for v, k in zip(twist[3:], e.cross(w, p_WE), strict=True)
    ]
    for k, value in enumerate(twist):
        e.store(r.TWIST + k, value)
    e.store(r.HAND, e.dot([*w, *travel], [*w, *travel]))
    done = e.let(f"{e.load(r.PROGRESS)} + {e.load(r.STEP)}")
    done = e.where(taken, done, e.load(r.PROGRESS))
    done = e.where(aims, 0.0, done)
    e.store(r.PROGRESS, done)
    step = e.where(aims, settings.first_motion / settings.motion, e.load(r.NEXT_STEP))
    limit = e.let(f"{settings.motion!r} / ({fastest} + 1e-9)")
    step = e.let(f"{step} * {limit} if {aims} else min({step}, {limit})")
    left = e.let(f"1.0 - {done}")
    e.store(r.STEP, e.let(f"{left} / ceil({left} / {step})"))


def judge(lower: Vector, upper: Vector, settings: Settings) -> str:
    """Is the step good, and does the lane need a decision?"""
    n = len(lower)
    e, rows = Emitter(r.LANES), r.Rows(n)
    step = e.load(r.STEP)
    error: Value = 0.0
    room: Value = 1.0
    start: list[Vector] = []
    end: list[Vector] = []
    for j in range(n):
        slopes = [e.load(rows.slope(s) + j) for s in range(7)]
        error = e.let(f"max({text(error)}, abs({e.dot(ERROR, slopes)}))")
        q0, q3 = e.load(rows.q + j), e.load(rows.q_stage + j)
        q1, q2 = e.sum((q0,), (1 / 3, step, slopes[0])), e.sum((q3,), (-1 / 3, step, slopes[6]))
        room = e.let(
            f"min({text(room)}, min(min(min({q1}, {q2}), {q3}) - {text(lower[j])},"
            f" {text(upper[j])} - max(max({q1}, {q2}), {q3})))"
        )
        start.append((slopes[0], slopes[0]))
        end.append((slopes[6], slopes[6]))
    error = e.let(f"{step} * {error} * {1.0 / settings.tolerance!r} + 1e-12")
    root8 = e.let(f"sqrt(sqrt(sqrt({error})))")
    change = e.let(f"min(5.0, max(0.2, 0.9 / ({root8} * sqrt({root8}))))")
    rate_start, rate_end = e.sum(*start), e.sum(*end)
    ahead = e.let(f"{step} * {rate_start} / max({rate_end} - {rate_start}, 1e-30)")
    next_step = e.let(f"min({step} * {change}, {settings.approach!r} * {ahead})")
    next_step = e.let(f"{next_step} if {error} <= 1.0 else {step} * {change}")
    bound = e.let(f"{settings.rate_max**2!r} * {e.load(r.HAND)}")
    good = e.let(f"{error} <= 1.0")
    finished = f"({e.load(r.PROGRESS)} + {step} > {1.0 - 1e-9!r})"
    good_event = f"({finished} | ({room} <= 0.0) | ({rate_end} > {bound}))"
    bad_event = f"({next_step} < {settings.step_min!r})"
    event = e.let(
        f"({good} & {good_event}) | ((not {good}) & {bad_event}) | ({rate_start} > {bound})"
    )
    e.store(r.ACCEPTED, e.where(str(good), 1.0, 0.0))
    e.store(r.EVENT, e.where(event, 1.0, 0.0))
    e.store(r.NEXT_STEP, next_step)
    e.store(r.ROOM, room)
    e.store(r.RATE_START, rate_start)
    e.store(r.RATE_END, rate_end)
    e.store(r.AIM, 0.0)
    return e.function("judge", judge.__doc__ or "")


def log_between(e: Emitter, X_BE: Vector, X_BG: Vector) -> list[Value]:
    """The twist log(X_BG X_BE^-1), of an angle of at most pi, by way of the quaternion."""

    def R(X: Vector, i: int, j: int) -> Value:
        return X[4 * i + j]

    M = [
        [e.sum(*((R(X_BG, i, k), R(X_BE, j, k)) for k in range(3))) for j in range(3)]
        for i in range(3)
    ]
    p = [
        e.sum((X_BG[4 * i + 3],), *((-1.0, M[i][j], X_BE[4 * j + 3]) for j in range(3)))
        for i in range(3)
    ]
    diagonal = [
        e.sum((1.0,), *((1.0 if k in (0, i) else -1.0, M[k - 1][k - 1]) for k in (1, 2, 3)))
        if i
        else e.sum((1.0,), *((M[k][k],) for k in range(3)))
        for i in range(4)
    ]
    x, y, z = (e.sum((M[k][j],), (-1.0, M[j][k])) for j, k in ((1, 2), (2, 0), (0, 1)))
    xy, yz, zx = (e.sum((M[j][k],), (M[k][j],)) for j, k in ((0, 1), (1, 2), (2, 0)))
    candidates = [
        [diagonal[0], x, y, z],
        [x, diagonal[1], xy, zx],
        [y, xy, diagonal[2], yz],
        [z, zx, yz, diagonal[3]],
    ]
    best, size = candidates[0], diagonal[0]
    for i in (1, 2, 3):
        better = e.let(f"{diagonal[i]} > {size}")
        best = [e.where(better, new, old) for new, old in zip(candidates[i], best, strict=True)]
        size = e.let(f"max({diagonal[i]}, {size})")
    sign = e.where(f"{best[0]} < 0.0", -1.0, 1.0)
    scale = e.let(f"{sign} / sqrt({e.dot(best, best)})")
    w, *u = (e.sum((scale, component)) for component in best)
    sine2 = e.dot(u, u)
    cosine = e.let(f"1.0 + {w}")
    tangent2 = e.let(f"{sine2} / ({cosine} * {cosine})")
    slope = e.let(f"1.0 / ({cosine} * (1.0 + sqrt(1.0 + {tangent2})))")
    quarter2 = e.let(f"{sine2} * {slope} * {slope}")
    angle_per_sine = e.let(f"8.0 * {slope} * {e.polynomial(quarter2, _ATAN)}")
    turn = [e.sum((angle_per_sine, component)) for component in u]
    bend = e.let(f"(1.0 - 0.5 * {angle_per_sine} * {w}) / ({sine2} + 1e-30)")
    swing, twice = e.cross(turn, p), e.cross(u, e.cross(u, p))
    v = [e.sum((p[k],), (-0.5, swing[k]), (bend, twice[k])) for k in range(3)]
    return [*turn, *v]


_ATAN = fit(
    lambda x: np.arctan(np.sqrt(x + 1e-300)) / np.sqrt(x + 1e-300), 9, np.tan(np.pi / 8) ** 2
)
