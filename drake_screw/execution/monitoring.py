"""When an execution must not begin, and when it must not go on."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drake_screw.execution.status import ExecutionStatus, Phase
from drake_screw.execution.timing import TimedPlan
from drake_screw.planning.roll import turned_apart
from drake_screw.robot import Arm
from drake_screw.typing import Array


@dataclass(frozen=True)
class Tolerances:
    """What an execution may deviate.

    Attributes:
        start: rad, of every revolute joint from the plan's first configuration.
        position, rotation: m and rad, of the commanded end effector from its set point.
        lag: rad, of a measured revolute joint from its desired position.
        patience: s, that such a lag may last.
        final_position, final_rotation: m and rad, of the measured end effector at the end.
        settling: s, that it may take to get there after the plan's time.
        slide_start, slide_lag: m, of prismatic joints, as `start` and `lag`.
    """

    start: float = 0.02
    position: float = 5e-3
    rotation: float = 20e-3
    lag: float = 0.05
    patience: float = 0.1
    final_position: float = 1e-3
    final_rotation: float = 5e-3
    settling: float = 1.0
    slide_start: float = 5e-3
    slide_lag: float = 10e-3

    def starts(self, arm: Arm) -> Array:
        """(n,) rad or m, of an arm's joints from a plan's first configuration."""
        return np.where(arm.slides, self.slide_start, self.start)

    def lags(self, arm: Arm) -> Array:
        """(n,) rad or m, of an arm's joints from their desired positions."""
        return np.where(arm.slides, self.slide_lag, self.lag)


def failed(segment: int | None, reason: str) -> ExecutionStatus:
    """The status of a failure."""
    return ExecutionStatus(Phase.FAILED, segment, reason)


def beginning(
    plan: TimedPlan | None, arm: Arm, q: Array, tolerances: Tolerances
) -> ExecutionStatus:
    """What to do with a new plan when the arm is at q (n,): run it, or why not."""
    if plan is None:
        return ExecutionStatus()
    if not plan.segments:
        return failed(None, "the plan is empty: it has no screw segments")
    for i, piece in enumerate(plan.segments):
        margin = arm.margin(piece.q)
        if not (margin >= 0.0).all():
            joint = arm.tightest(piece.q)
            return failed(
                i,
                f"the plan leaves the limits of {arm.joint_names[joint]} by "
                f"{-margin[:, joint].min():.4f} {arm.units[joint]}",
            )
        ratio = np.abs(piece.v) / arm.velocity_limits
        if (ratio > 1.0).any():
            joint = int(np.argmax(ratio.max(axis=0)))
            return failed(
                i,
                f"the plan drives {arm.joint_names[joint]} at {ratio[:, joint].max():.2f} times "
                "its velocity limit",
            )
    away = np.abs(q - plan.segments[0].q[0])
    allowed = tolerances.starts(arm)
    joint = int(np.argmax(away / allowed))
    if away[joint] > allowed[joint]:
        return failed(
            0,
            f"the arm is not where the plan starts: {arm.joint_names[joint]} is "
            f"{away[joint]:.3f} {arm.units[joint]} away",
        )
    return ExecutionStatus(Phase.RUNNING, 0)


def worst_lag(lags: Array, q: Array, measured: Array) -> tuple[bool, int, float]:
    """The joint that is farthest from its desired position q (n,), by what is allowed it.

    Args:
        lags: (n,) rad or m, what is allowed each.
        q, measured: (n,) rad or m.

    Returns:
        Whether that is more than allowed, which joint it is, and how far it is.
    """
    lag = np.abs(measured - q)
    joint = int(np.argmax(lag / lags))
    return bool(lag[joint] > lags[joint]), joint, float(lag[joint])


def apart(X_WA: Array, X_WB: Array, free_axis: Array | None = None) -> tuple[float, float]:
    """Distance in m and angle in rad between two poses (4, 4); quick, for angles below pi.

    Where the roll about an axis (3,) of theirs is free, it is the angle between these axes.
    """
    if free_axis is not None:
        return math.dist(X_WA[:3, 3], X_WB[:3, 3]), float(turned_apart(X_WA, X_WB, free_axis))
    R = X_WA[:3, :3].T @ X_WB[:3, :3]
    sine = math.hypot(R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1])
    return math.dist(X_WA[:3, 3], X_WB[:3, 3]), math.atan2(sine, np.trace(R) - 1.0)


def arrival(
    plan: TimedPlan, t: float, X_WE: Array, tolerances: Tolerances
) -> ExecutionStatus | None:
    """How a plan ended, at time t with the end effector measured at X_WE; None if it has not."""
    if t < plan.duration:
        return None
    if plan.ending is not None:
        return plan.ending
    last = len(plan.segments) - 1
    far, turned = apart(X_WE, plan.segments[last].X_WB, plan.free_axis)
    if far <= tolerances.final_position and turned <= tolerances.final_rotation:
        return ExecutionStatus(Phase.DONE, last)
    if t > plan.duration + tolerances.settling:
        return failed(last, f"the end effector stays {_words(far, turned)} off the end")
    return None


def out_of_reach(
    segment: int,
    X_WE: Array,
    X_WS: Array,
    tolerances: Tolerances,
    free_axis: Array | None = None,
) -> ExecutionStatus | None:
    """A failure if the commanded pose X_WE (4, 4) cannot keep up with its set point X_WS."""
    far, turned = apart(X_WE, X_WS, free_axis)
    if far <= tolerances.position and turned <= tolerances.rotation:
        return None
    behind = _words(far, turned)
    reason = f"the set point is out of reach: the end effector falls {behind} behind it"
    return failed(segment, reason)


def _words(far: float, turned: float) -> str:
    return f"{1e3 * far:.1f} mm and {1e3 * turned:.0f} mrad"
