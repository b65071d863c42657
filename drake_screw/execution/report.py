"""What an execution did, measured against the plan it was given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from drake_screw.execution.allowed import Allowed, Flaw, Flawed
from drake_screw.execution.free_objects import Displacement
from drake_screw.execution.status import ExecutionStatus, Phase
from drake_screw.execution.timing import TimedPlan
from drake_screw.planning.contract import CHARACTERISTIC_LENGTH
from drake_screw.planning.roll import turned_along, turned_apart
from drake_screw.robot import Arm
from drake_screw.robot.arm import comparable
from drake_screw.screws import (
    exp,
    inverse,
    log,
    shift,
    translation_distance,
)
from drake_screw.typing import Array

EVERY = 4e-3  # s, between samples at which the end effector is looked at
YIELDS = 1e-4  # rad or m, by which a joint that rests against its stop is beyond it: stops give way


@dataclass(frozen=True)
class Contact:
    """Two bodies that touched: since when, in which segment, and the greatest force in N."""

    bodies: tuple[str, str]
    time: float
    segment: int
    force: float

    def __str__(self) -> str:
        a, b = self.bodies
        return f"{a} touches {b} at {self.time:.2f} s in segment {self.segment + 1}"


@dataclass(frozen=True)
class Deviation:
    """Greatest and root mean square distance of two poses over time, in m and rad."""

    position: float = 0.0
    rotation: float = 0.0
    position_rms: float = 0.0
    rotation_rms: float = 0.0


@dataclass(frozen=True)
class ExecutionReport:
    """One execution of a plan.

    Attributes:
        status: at the end.
        planned, time: s, length of the plan and of its execution.
        worst_margin: the least distance to a joint limit, in worst_unit; negative outside.
        worst_joint: the joint that had it.
        worst_unit: "rad" or "m".
        worst_compared: rad, the same for comparing joints, as `Arm.tightest` does.
        outside: names of the joints that were outside their limits, by more than stops give way.
        velocity: greatest joint velocity, over its limit.
        tracking: of the measured end effector from the set point of the same time.
        screws: of the measured end effector from the commanded screw whatever the time, for each
            segment that was begun; of a free approach from the planned path.
        contacts: of the robot with anything, itself included.
        final: of the measured end effector from the last guiding pose, when it ended.
            All three without the roll about an axis where the plan leaves it free.
        moved: how far objects were moved that can be pushed.
        allowed: what it may do and be flawless.
        since: s, when it first left limits, was too fast or too far off, as far as it was.
    """

    status: ExecutionStatus
    planned: float
    time: float
    worst_margin: float
    worst_joint: str
    worst_unit: str
    worst_compared: float
    outside: tuple[str, ...]
    velocity: float
    tracking: Deviation
    screws: tuple[Deviation, ...]
    contacts: tuple[Contact, ...]
    final: Deviation
    moved: tuple[Displacement, ...] = ()
    allowed: Allowed = field(default_factory=Allowed)
    since: Mapping[Flaw, float] = field(default_factory=dict)

    @property
    def flawless(self) -> bool:
        """Done, within all joint limits and velocities, and what else is `Allowed`."""
        return not self.flaws

    @property
    def force(self) -> float:
        """N, greatest with which the robot touched something; 0 where it touched nothing."""
        return max((contact.force for contact in self.contacts), default=0.0)

    @property
    def pushed(self) -> tuple[Displacement, ...]:
        """Objects that were moved farther than is allowed."""
        most, turn = self.allowed.displacement, self.allowed.turn
        return tuple(o for o in self.moved if o.position > most or o.rotation > turn)

    @property
    def off(self) -> bool:
        """Whether the end effector was farther from where it ought to be than is allowed."""
        most, turn = self.allowed.position, self.allowed.rotation
        return self.tracking.position > most or self.tracking.rotation > turn

    @property
    def flaws(self) -> tuple[Flawed, ...]:
        """What was not as it should be, what explains most first; none where all was."""
        most = self.allowed.contact_force
        touched = [c for c in self.contacts if c.force > most or most == 0.0]
        found = [Flawed(Flaw.PUSHED, f"the {o}", o.time) for o in self.pushed]
        found += [Flawed(Flaw.CONTACT, str(c), c.time) for c in touched]
        if self.outside:
            words = "; ".join(f"{name} leaves its limits" for name in self.outside)
            found.append(Flawed(Flaw.OUTSIDE_LIMITS, words, self.since.get(Flaw.OUTSIDE_LIMITS)))
        if self.velocity > 1.0:
            words = f"a joint moves at {self.velocity:.2f} times its velocity limit"
            found.append(Flawed(Flaw.TOO_FAST, words, self.since.get(Flaw.TOO_FAST)))
        if self.status.phase is not Phase.DONE:
            found.append(Flawed(Flaw.NOT_DONE, str(self.status), self.time))
        if self.off:
            far, turned = 1e3 * self.tracking.position, 1e3 * self.tracking.rotation
            words = f"the end effector gets {far:.1f} mm and {turned:.0f} mrad off its way"
            found.append(Flawed(Flaw.OFF, words, self.since.get(Flaw.OFF)))
        return tuple(found)


def make_report(
    plan: TimedPlan,
    arm: Arm,
    t: Array,
    q: Array,
    v: Array,
    status: ExecutionStatus,
    contacts: Sequence[Contact],
    moved: Sequence[Displacement] = (),
    allowed: Allowed | None = None,
) -> ExecutionReport:
    """Measure a plan's execution.

    Args:
        plan: what ought to be done, from time 0.
        arm: that did it.
        t: (m,) s, times of the samples.
        q, v: (m, n) where it was.
        status: at the end.
        contacts: that were seen.
        moved: how far objects were moved.
        allowed: what it may do and be flawless.
    """
    allowed = allowed or Allowed()
    margin = arm.margin(q)
    least = margin.min(axis=0)
    compared = comparable(least, arm.upper - arm.lower, arm.slides)
    joint = int(np.argmin(compared))
    outside = tuple(n for n, kept in zip(arm.joint_names, least, strict=True) if kept < -YIELDS)
    fast = np.abs(v) / arm.velocity_limits
    since = _since(Flaw.OUTSIDE_LIMITS, t, -margin / YIELDS)
    since |= _since(Flaw.TOO_FAST, t, fast)
    tracking, screws, final = Deviation(), [], Deviation()
    if plan.segments:
        times = np.unique(np.round(t / EVERY).astype(int), return_index=True)[1]
        points = [plan.at(float(time)) for time in t[times]]
        segment, s = np.array([p.segment for p in points]), np.array([p.s for p in points])
        X_WE = arm.pose(q[times])
        errors = []
        for i in range(segment.max() + 1):
            piece, here = plan.segments[i], segment == i
            if not piece.screw:
                planned = np.stack([p.q for p, chosen in zip(points, here, strict=True) if chosen])
                errors.append(_distances(X_WE[here], arm.pose(planned), plan.free_axis))
                screws.append(_deviation(errors[-1]))
                continue
            X_WS = exp(s[here, None] * piece.twist) @ piece.X_WA
            errors.append(_distances(X_WE[here], X_WS, plan.free_axis))
            nearest = s[here] + _ahead(X_WE[here], X_WS, piece.twist, plan.free_axis)
            nearest = np.clip(nearest, 0.0, 1.0)
            X_WN = exp(nearest[:, None] * piece.twist) @ piece.X_WA
            screws.append(_deviation(_distances(X_WE[here], X_WN, plan.free_axis)))
        distances = np.concatenate(errors)
        tracking = _deviation(distances)
        most = np.array([allowed.position, allowed.rotation])
        since |= _since(Flaw.OFF, t[times], distances / most)
        ended, X_WB = arm.pose(q[-1:]), plan.segments[-1].X_WB[None]
        final = _deviation(_distances(ended, X_WB, plan.free_axis))
    return ExecutionReport(
        status=status,
        planned=plan.duration,
        time=float(t[-1]),
        worst_margin=float(least[joint]),
        worst_joint=arm.joint_names[joint],
        worst_unit=arm.units[joint],
        worst_compared=float(compared[joint]),
        outside=outside,
        velocity=float(fast.max()),
        tracking=tracking,
        screws=tuple(screws),
        contacts=tuple(contacts),
        final=final,
        moved=tuple(moved),
        allowed=allowed,
        since=since,
    )


def _since(flaw: Flaw, t: Array, ratios: Array) -> dict[Flaw, float]:
    """The first of the times (m,) at which a ratio (m, n) to what is allowed is above 1, if any."""
    seen = np.flatnonzero(ratios.max(axis=1) > 1.0)
    return {flaw: float(t[seen[0]])} if len(seen) else {}


def _ahead(X_WE: Array, X_WS: Array, twist: Array, free_axis: Array | None) -> Array:
    """How much farther along the screw than S the frame E is (m,), by a step of Gauss-Newton.

    Rotations and translations are weighed by CHARACTERISTIC_LENGTH, at the end effector.
    """
    X_WS = turned_along(X_WE, X_WS, free_axis)
    V = _at_hand(log(X_WE @ inverse(X_WS)), X_WS)
    along = _at_hand(np.broadcast_to(twist, V.shape), X_WS)
    if free_axis is not None:
        a = X_WS[..., :3, :3] @ (free_axis / np.linalg.norm(free_axis))
        along[..., :3] -= np.vecdot(along[..., :3], a)[..., None] * a
    size = np.maximum(np.sum(along * along, axis=-1), 1e-12)
    return np.sum(V * along, axis=-1) / size


def _at_hand(V: Array, X_WS: Array) -> Array:
    V = shift(V, X_WS[..., :3, 3])
    return np.concatenate([V[..., :3], V[..., 3:] / CHARACTERISTIC_LENGTH], axis=-1)


def _distances(X_WA: Array, X_WB: Array, free_axis: Array | None) -> Array:
    """(m, 2) distances in m and angles in rad of poses (m, 4, 4), as far as their roll counts."""
    turned = turned_apart(X_WA, X_WB, free_axis)
    return np.stack([translation_distance(X_WA, X_WB), turned], axis=-1)


def _deviation(distances: Array) -> Deviation:
    greatest, rms = distances.max(axis=0), np.sqrt((distances**2).mean(axis=0))
    return Deviation(float(greatest[0]), float(greatest[1]), float(rms[0]), float(rms[1]))
