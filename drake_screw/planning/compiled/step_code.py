"""Writes one Runge-Kutta step of a block of lanes as straight-line code.

The pair is Dormand and Prince's 5(4), "A family of embedded Runge-Kutta formulae" (1980). A step is

    blend_1, rate, ..., blend_5, rate   stages 1..5; stage 0 is known from the step before
    blend_6, arrive                     the end of the step: dq/ds, the hand's pose, what aim needs
    judge                               error, limits, rates: is the step good, and what comes next
    aim                                 take good steps, and aim anew at the guiding pose

Between judge and aim the lanes that need a decision get it one by one (lanes.py).
"""

from __future__ import annotations

from dataclasses import dataclass

from drake_screw.planning.compiled import rows as r
from drake_screw.planning.compiled.arm_code import ArmCode, Pose, joint_rates, orientation, residual
from drake_screw.planning.compiled.emitter import Emitter, Value, Vector, text
from drake_screw.planning.compiled.functions import log_between
from drake_screw.planning.compiled.link_frames import LinkFrames
from drake_screw.planning.compiled.matrices import Factor
from drake_screw.planning.contract import (
    CHARACTERISTIC_LENGTH,
    ORIENTATION_MIN,
    RATE_LIMIT,
    RESIDUAL_LIMIT,
)

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
        step_min: of s; where smaller steps are needed the hand cannot follow.
        rate_max: bound on |dq/ds| per hand motion (see `contract.hand_motion`), rad.
        residual_max: bound on the part of the hand motion that the joints cannot give.
    """

    tolerance: float = 1e-4
    motion: float = 0.7
    first_motion: float = 0.6
    approach: float = 0.6
    step_min: float = 1e-6
    rate_max: float = RATE_LIMIT
    residual_max: float = RESIDUAL_LIMIT


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
    if n <= 6:
        e.store(r.ORIENTATION, orientation(e, _columns_at_start(e, arm), arm.columns))
        e.store(r.VOLUME_END, factor.determinant)
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
    arm_later.about = keep(arm.about)
    blocks = (factor.first, factor.last, factor.bridge, factor.coupling)
    first, last, bridge, coupling = ([keep(row) for row in block] for block in blocks)
    determinant = keep([factor.determinant])[0] if n <= 6 else 1.0
    factor_later = Factor(first, last, bridge, coupling, determinant)
    _aim(arm_later, factor_later, settings)
    arrive = e.function("arrive", "dq/ds and the pose of the hand at the end of the step.")
    aim = later.function("aim", "Takes good steps, and aims anew at the guiding pose.")
    return arrive, aim, kept.row


def _columns_at_start(e: Emitter, arm: ArmCode) -> list[list[Value]]:
    first = r.Rows(len(arm.columns)).columns
    return [
        [e.load(first + 6 * j + k) if isinstance(v, str) else v for k, v in enumerate(column)]
        for j, column in enumerate(arm.columns)
    ]


def _aim(arm: ArmCode, factor: Factor, settings: Settings) -> None:
    e, n = arm.e, len(arm.columns)
    rows = r.Rows(n)
    taken = f"{e.load(r.ACCEPTED)} > 0.5"
    aim = e.load(r.AIM)
    done = e.let(f"{e.load(r.PROGRESS)} + {e.load(r.STEP)}")
    done = e.where(taken, done, e.load(r.PROGRESS))
    done = e.where(f"{aim} > 0.5", 0.0, done)
    left = e.let(f"1.0 - {done}")
    e.store(r.PROGRESS, done)

    def update(row: int, new: Value, condition: str = taken) -> str:
        value = e.where(condition, new, e.load(row))
        e.store(row, value)
        return value

    to_target = log_between(
        e, [e.load(r.POSE + k) for k in range(12)], [e.load(r.TARGET + k) for k in range(12)]
    )
    pace = e.let(f"1.0 / {left}")
    new_twist = [e.sum((pace, v)) for v in to_target]
    twist = [update(r.TWIST + k, new) for k, new in enumerate(new_twist)]
    p_WE = [e.load(r.POSE + k) for k in (3, 7, 11)]
    travel = [
        e.sum((1.0 / CHARACTERISTIC_LENGTH, v), (1.0 / CHARACTERISTIC_LENGTH, k))
        for v, k in zip(twist[3:], e.cross(twist[:3], p_WE), strict=True)
    ]
    hand = [*twist[:3], *travel]
    update(r.HAND, e.dot(hand, hand), f"({aim} > 0.5) & ({aim} < 1.5)")

    in_middle = arm.to_middle(new_twist)
    rates = joint_rates(e, arm.columns, factor, in_middle)
    missing = residual(e, arm.columns, rates, in_middle)
    update(r.RESIDUAL, e.sum((missing, left, left)))
    fastest: Value = 0.0
    for j, rate in enumerate(rates):
        slope = update(rows.slope(0) + j, rate)
        update(rows.q + j, e.load(rows.q_stage + j))
        fastest = e.let(f"max({text(fastest)}, abs({slope}))")
    if n <= 6:
        update(r.VOLUME_START, factor.determinant)
        for j, column in enumerate(arm.columns):
            for k, value in enumerate(column):
                if isinstance(value, str):
                    update(rows.columns + 6 * j + k, value)
    step = e.where(f"{aim} > 0.5", settings.first_motion / settings.motion, e.load(r.NEXT_STEP))
    limit = e.let(f"{settings.motion!r} / ({fastest} + 1e-9)")
    step = e.let(f"{step} * {limit} if {aim} > 0.5 else min({step}, {limit})")
    e.store(r.STEP, e.let(f"{left} / ceil({left} / {step})"))


def judge(lower: Vector, upper: Vector, settings: Settings) -> str:
    """Is the step good, and does the lane need a decision?"""
    n = len(lower)
    e, rows = Emitter(r.LANES), r.Rows(n)
    step = e.load(r.STEP)
    error: Value = 0.0
    room: Value = 1.0
    speed: list[list[Vector]] = [[] for _ in range(7)]
    for j in range(n):
        slopes = [e.load(rows.slope(s) + j) for s in range(7)]
        error = e.let(f"max({text(error)}, abs({e.dot(ERROR, slopes)}))")
        q0, q3 = e.load(rows.q + j), e.load(rows.q_stage + j)
        q1, q2 = (e.sum((q0,), (1 / 3, step, slopes[0])), e.sum((q3,), (-1 / 3, step, slopes[6])))
        room = e.let(
            f"min({text(room)}, min(min(min({q1}, {q2}), {q3}) - {text(lower[j])},"
            f" {text(upper[j])} - max(max({q1}, {q2}), {q3})))"
        )
        for squares, slope in zip(speed, slopes, strict=True):
            squares.append((slope, slope))
    error = e.let(f"{step} * {error} * {1.0 / settings.tolerance!r} + 1e-12")
    root8 = e.let(f"sqrt(sqrt(sqrt({error})))")
    change = e.let(f"min(5.0, max(0.2, 0.9 / ({root8} * sqrt({root8}))))")
    rate_start, *between, rate_end = (e.sum(*squares) for squares in speed)
    largest: Value = 0.0
    for rate in between:
        largest = e.let(f"max({text(largest)}, {rate})")
    ahead = e.let(f"{step} * {rate_start} / max({rate_end} - {rate_start}, 1e-30)")
    if n <= 6:
        shrunk = e.let(f"sqrt({e.load(r.VOLUME_END)} / max({e.load(r.VOLUME_START)}, 1e-60))")
        ahead = e.let(f"min({ahead}, {step} * {shrunk} / max(1.0 - {shrunk}, 1e-30))")
    next_step = e.let(f"min({step} * {change}, {settings.approach!r} * {ahead})")
    bound = e.let(f"{settings.rate_max**2!r} * {e.load(r.HAND)}")
    stages = e.sum((rate_end,), *((rate,) for rate in between))
    stray = e.let(f"({largest} > {bound}) & ({rate_end} <= {bound})")
    stray = e.let(f"{stray} | (not ({stages} >= 0.0))")
    if n <= 6:
        stray = e.let(f"{stray} | ({e.load(r.ORIENTATION)} < {-ORIENTATION_MIN!r})")
    good = e.let(f"({error} <= 1.0) & (not {stray})")
    next_step = e.where(good, next_step, e.let(f"{step} * (0.2 if {stray} else {change})"))
    finished = f"({e.load(r.PROGRESS)} + {step} > {1.0 - 1e-9!r})"
    good_event = f"({finished} | ({room} <= 0.0) | ({rate_end} > {bound}))"
    slow = f"({next_step} < {settings.step_min!r})"
    residual_bound = e.let(f"{settings.residual_max**2!r} * {e.load(r.HAND)}")
    stuck = f"({rate_start} > {bound}) | ({e.load(r.RESIDUAL)} > {residual_bound})"
    event = e.let(f"({good} & {good_event}) | {slow} | {stuck}")
    e.store(r.ACCEPTED, e.where(str(good), 1.0, 0.0))
    e.store(r.EVENT, e.where(event, 1.0, 0.0))
    e.store(r.NEXT_STEP, next_step)
    e.store(r.ROOM, room)
    e.store(r.RATE_START, rate_start)
    e.store(r.RATE_END, rate_end)
    e.store(r.AIM, 0.0)
    return e.function("judge", judge.__doc__ or "")
