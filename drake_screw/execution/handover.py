"""From one motion to another without coming to rest: two motions that overlap.

The arm brakes on the path that it is on, and the new motion sets out from where that would end.
It need not wait until then: both displacements are added up from as early on as joint velocities
and accelerations allow. At the latest, one motion follows the other, so there always is a way.
Robots round corners between two point-to-point motions like this (Biagiotti and Melchiorri,
Trajectory Planning for Automatic Machines and Robots, 2008, on the composition of trajectories).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from drake_screw.execution.timing import TimedPlan, TimedSegment, TimeLimits
from drake_screw.robot import Arm
from drake_screw.typing import Array

PERIOD = 4e-3
"""s, between samples."""

LONGER = 1.15
"""How many times as long a braking that is too hard is made."""

OVERLAPS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Parts of the braking time that may have to pass before the new motion sets out."""

ROUNDING = 1.02
"""Times the limits: what differences of samples are off."""


@dataclass(frozen=True, eq=False)
class Braking:
    """How an arm comes to rest on its path.

    Attributes:
        q, v: (m, n) joint positions in rad (or m) and velocities, PERIOD apart, from those at the
            handover to rest; a single one where the arm is at rest.
    """

    q: Array
    v: Array

    @property
    def duration(self) -> float:
        """Length in s."""
        return PERIOD * (len(self.q) - 1)

    def at(self, t: Array) -> tuple[Array, Array]:
        """q and v (m, n) at times t (m,) that are multiples of PERIOD; at rest after the end."""
        k = np.minimum(np.round(t / PERIOD).astype(np.int64), len(self.q) - 1)
        return self.q[k], self.v[k]


def braking(plan: TimedPlan, t: float, acceleration: Array) -> Braking:
    """Slow down along a plan's own joint path, from its own velocity to rest.

    The rate at which the plan's time passes falls from 1 to 0 as 1 - 3u^2 + 2u^3, over the
    shortest time (to LONGER) in which no joint accelerates more than it may, or than it does on the
    plan at that moment. Where the segment ends no later than that, it is followed to its end, at
    which the arm rests.

    Args:
        plan: that the arm follows.
        t: s from its start, where the braking begins.
        acceleration: (n,) limits in rad/s^2 (or m/s^2).
    """
    last = plan.end_of_segment(t)
    q, v = plan.path(np.array([t, min(t + PERIOD, last)]))
    if t >= last or not np.abs(v[0]).max() > 0.0:
        return Braking(q[:1], 0.0 * q[:1])
    allowed = np.maximum(acceleration, np.abs(v[1] - v[0]) / PERIOD)
    time = max(1.5 * float(np.max(np.abs(v[0]) / acceleration)), 4 * PERIOD)
    while time < last - t:
        m = int(np.ceil(time / PERIOD))
        u = np.arange(m + 1) / m
        q, v = plan.path(np.minimum(t + m * PERIOD * (u - u**3 + 0.5 * u**4), last))
        v = v * (1.0 - 3.0 * u**2 + 2.0 * u**3)[:, None]
        if (np.abs(np.diff(v, axis=0)) <= ROUNDING * PERIOD * allowed).all():
            return Braking(q, v)
        time *= LONGER
    m = int(np.ceil((last - t) / PERIOD))
    q, v = plan.path(np.minimum(t + PERIOD * np.arange(m + 1), last))
    v[-1] = 0.0
    return Braking(q, v)


def overlapped(
    before: Braking, after: TimedSegment, arm: Arm, limits: TimeLimits
) -> Iterator[TimedSegment]:
    """Motions that lead on from a braking to a segment which starts where it ends.

    The earlier the new motion sets out in one, the earlier it comes. Each keeps position and
    velocity at the handover, keeps joint limits, moves no joint faster than `limits` say or than it
    is at the handover, and accelerates none more than `limits` say or than the braking does. They
    follow joint positions, as their end effector follows no screw.

    Args:
        before: the end of the old motion.
        after: the beginning of the new one, from rest to rest.
        arm: that moves.
        limits: how fast.
    """
    fastest = np.maximum(limits.speed * arm.velocity_limits, np.abs(before.v[0]))
    harder = np.abs(np.diff(before.v, axis=0)).max(axis=0, initial=0.0) / PERIOD
    hardest = np.maximum(limits.accelerations(arm), harder)
    for part in OVERLAPS if len(before.q) > 1 else OVERLAPS[:1]:
        delay = PERIOD * np.ceil(part * before.duration / PERIOD)
        length = max(before.duration, delay + after.duration)
        t = PERIOD * np.arange(int(np.ceil(length / PERIOD - 1e-9)) + 1)
        s, rate, q, v = after.at(np.clip(t - delay, 0.0, after.duration))
        q_before, v_before = before.at(t)
        q, v = q + q_before - before.q[-1], v + v_before
        within = (np.abs(v) <= ROUNDING * fastest).all() and (arm.margin(q) >= -1e-9).all()
        smooth = (np.abs(np.diff(v, axis=0)) <= ROUNDING * PERIOD * hardest).all()
        if (within and smooth) or part == OVERLAPS[-1]:
            q = np.clip(q, arm.lower, arm.upper)
            X_WA = arm.pose(q[:1])[0]
            yield TimedSegment(X_WA, after.X_WB, PERIOD, s, rate, q, v, screw=False)
