"""One demonstration tried at one task instance: its plan, its screws, and what to say of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Cause, Outcomes, Plan, Turned
from drake_screw.planning.touching import Pair, cut_short, touch_words, touching_bodies
from drake_screw.robot import Arm, Workcell
from drake_screw.screws import Screw, screw_between
from drake_screw.typing import Array
from drake_screw.visualization.screw_drawing import (
    STRAIGHT,
    axis_distance,
    looks_straight,
    screw_track,
)
from drake_screw.visualization.unreachable import Unreachable, explain

DONE, FAILED, AHEAD = "done", "failed", "never reached"


@dataclass(frozen=True, eq=False)
class Attempt:
    """A demonstration carried over to an instance, planned, and looked at.

    Attributes:
        arm: that was planned for.
        number: of the demonstration, from 0.
        demonstration: what was carried over.
        X_WO: (k, 4, 4) the instance's objects.
        starts: (g, 4, 4) X_WE where each screw segment starts.
        plan: up to where it failed if it did.
        turned: how symmetric bodies are turned.
        bodies: names of the pairs of bodies that touch where the plan ended, after a collision.
        clearance: m, that they had to keep.
        arm_name: the arm's, where the robot has several that are planned for.
        flaws: what went wrong when the plan was executed, in words.
    """

    arm: Arm
    number: int
    demonstration: Demonstration
    X_WO: Array
    starts: Array
    plan: Plan
    turned: tuple[Turned, ...] = ()
    bodies: tuple[Pair, ...] = ()
    clearance: float = 0.0
    arm_name: str | None = None
    flaws: str = ""

    @property
    def guides(self) -> Array:
        """(g, 4, 4) X_WE where each screw segment ends, the guiding poses."""
        return self.plan.guides

    @property
    def cause(self) -> Cause:
        """How the plan ended."""
        return Cause(int(self.plan.outcome.cause))

    @property
    def failed_segment(self) -> int | None:
        """The segment that failed, from 0."""
        return None if self.plan.success else int(self.plan.outcome.segment)

    @property
    def failed_joint(self) -> int | None:
        """The joint at its limit, from 0."""
        return int(self.plan.outcome.joint) if self.cause == Cause.JOINT_LIMIT else None

    @property
    def status(self) -> tuple[str, ...]:
        """DONE, FAILED or AHEAD for each segment."""
        failed = len(self.guides) if self.failed_segment is None else self.failed_segment
        return tuple(
            DONE if i < failed else FAILED if i == failed else AHEAD
            for i in range(len(self.guides))
        )

    def path(self, segment: int, first: float, last: float) -> Array:
        """(m, 3) the end effector's way along a segment, from one fraction of it to another."""
        if segment > 0 or not self.plan.approach:
            return screw_track(self.starts[segment], self.guides[segment], first, last)
        if last <= first or not len(self._approach):
            return np.empty((0, 3))
        s = np.linspace(0.0, 1.0, len(self._approach))
        return self._approach[(s >= first) & (s <= last)]

    @cached_property
    def _approach(self) -> Array:
        """(m, 3) the end effector's way along a free approach."""
        q = self.plan.q[self.plan.segment == 0]
        return self.arm.pose(q)[:, :3, 3] if len(q) > 1 else np.empty((0, 3))

    @cached_property
    def screws(self) -> Screw:
        """The constant screw of each segment, arrays (g,); a free approach does not follow it."""
        return screw_between(self.starts, self.guides)

    @cached_property
    def unreachable(self) -> Unreachable | None:
        """Why the end effector got no farther; None where that is not how the plan ended."""
        if self.cause != Cause.UNREACHABLE:
            return None
        return explain(self.arm, self.plan, self.starts)

    @cached_property
    def margin(self) -> Array:
        """(m, n) rad or m, distance of each joint to its nearer limit along the plan."""
        return self.arm.margin(self.plan.q)

    @cached_property
    def progress(self) -> Array:
        """(m,) how far along all segments, 0 to g."""
        return self.plan.segment + self.plan.s

    @property
    def tightest(self) -> tuple[int, float]:
        """The joint that comes nearest to a limit anywhere along the plan, and how near."""
        joint = self.arm.tightest(self.plan.q)
        return joint, float(self.margin[:, joint].min())

    def axis_distance(self, segment: int) -> float:
        """Distance in m of the end effector's path in a segment from its screw's axis."""
        return axis_distance(self.starts[segment], self.guides[segment])

    def straight(self, segment: int) -> bool:
        """Whether a segment looks like a translation: it hardly turns, or about a far axis."""
        return looks_straight(self.starts[segment], self.guides[segment])

    def samples(self, most: int) -> NDArray[np.int64]:
        """Indices (p,) of about `most` points of the plan, the ends of all segments among them."""
        m = len(self.plan.q)
        even = np.linspace(0, m - 1, min(most, m)).round().astype(np.int64)
        ends = np.flatnonzero(np.diff(self.plan.segment) != 0)
        return np.unique(np.concatenate([even, ends, [0, m - 1]]))


def attempt(
    arm: Arm,
    number: int,
    demonstration: Demonstration,
    X_WO: ArrayLike,
    plan: Plan,
    arm_name: str | None = None,
) -> Attempt:
    """A plan of an instance with a demonstration, to look at.

    Args:
        arm: that was planned for.
        number: of the demonstration, from 0.
        demonstration: that was carried over.
        X_WO: (k, 4, 4) the instance's objects.
        plan: what came of it.
        arm_name: the arm's, where the robot has several that are planned for.
    """
    X_WO = np.asarray(X_WO, dtype=float)
    starts = np.concatenate([arm.pose(plan.q[:1]), plan.guides])[:-1]
    return Attempt(arm, number, demonstration, X_WO, starts, plan, arm_name=arm_name)


def collided(
    attempt: Attempt, outcome: Outcomes, workcell: Workcell, clearance: float = 0.0
) -> Attempt:
    """An attempt cut short where an outcome of shape (), a collision, says that it ended.

    Args:
        attempt: whose plan may be whole.
        outcome: where it ended; the bodies that touch are found there if it does not name them.
        workcell: that it was found in.
        clearance: m, that had to be kept.
    """
    plan = cut_short(attempt.plan, outcome)
    bodies = touching_bodies(outcome, workcell, plan.q[-1], attempt.X_WO, clearance)
    return replace(attempt, plan=plan, bodies=bodies, clearance=clearance)


def executed(attempt: Attempt, outcome: Outcomes, flaws: str) -> Attempt:
    """An attempt cut short where its execution, by an outcome of shape (), first went wrong."""
    return replace(attempt, plan=cut_short(attempt.plan, outcome), flaws=flaws)


def headline(attempt: Attempt) -> str:
    """How an attempt ended, in one sentence."""
    arm, plan, total = attempt.arm, attempt.plan, len(attempt.guides)
    of = "" if attempt.arm_name is None else f" with arm {attempt.arm_name}"
    if plan.success:
        joint, margin = attempt.tightest
        done = f"succeeds{of} in all {total} screw segments{_turns(attempt)}"
        if arm.endless[joint]:
            return f"{done}; no joint has limits"
        return (
            f"{done}; {arm.joint_names[joint]} comes nearest to a limit, {margin:.3f} "
            f"{arm.units[joint]} away"
        )
    segment, fraction = int(plan.outcome.segment), float(plan.outcome.fraction)
    where = f"in screw segment {segment + 1} of {total}, {fraction:.1%} along it{_turns(attempt)}"
    if attempt.cause == Cause.JOINT_LIMIT:
        joint = int(plan.outcome.joint)
        which, limit = "lower", arm.lower[joint]
        if abs(plan.q[-1, joint] - arm.upper[joint]) < abs(plan.q[-1, joint] - arm.lower[joint]):
            which, limit = "upper", arm.upper[joint]
        return (
            f"fails{of} {where}: {arm.joint_names[joint]} reaches its {which} limit, "
            f"{limit:.3f} {arm.units[joint]}".replace("-", "−")
        )
    if attempt.cause == Cause.EXECUTION:
        return f"fails when executed, {where}: {attempt.flaws}"
    if attempt.cause == Cause.COLLISION:
        touching = "; ".join(touch_words(pair, attempt.clearance) for pair in attempt.bodies[:2])
        return f"fails{of} {where}: {touching or 'the arm touches something'}"
    if attempt.unreachable is None:
        return f"fails{of} {where}: {attempt.cause.name.lower()}"
    return f"fails{of} {where}: unreachable, {attempt.unreachable.words}"


def _turns(attempt: Attempt) -> str:
    if not attempt.turned:
        return ""
    turned = " and ".join(map(str, attempt.turned))
    return f", with {turned}" if attempt.plan.success else f", at best, with {turned}"


def describe_segment(attempt: Attempt, segment: int) -> str:
    """A segment's screw in words and numbers."""
    if segment == 0 and attempt.plan.approach:
        return "free approach: a joint motion to the first guiding pose"
    screw = attempt.screws
    angle, along = float(screw.angle[segment]), float(screw.translation[segment])
    turn = f"{np.degrees(angle):.1f}°"
    if attempt.straight(segment):
        way = attempt.guides[segment, :3, 3] - attempt.starts[segment, :3, 3]
        text = f"{np.linalg.norm(way) * 100:.1f} cm"
        if angle < STRAIGHT:
            return f"{text}, straight"
        return f"{text}, turning {turn} about an axis {attempt.axis_distance(segment):.1f} m off"
    pitch = float(screw.pitch[segment]) * 2.0 * np.pi
    text = f"{turn}, {along * 100:+.1f} cm along the axis, pitch {pitch * 100:+.0f} cm/turn"
    return text.replace("-", "−")
