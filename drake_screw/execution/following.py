"""When a planner plans, plans again, and gives up, and what it remembers between its steps."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from drake_screw.execution.choosing import Choice, Chooser, PlanningOutcome
from drake_screw.execution.handover import PERIOD, Braking, braking, overlapped
from drake_screw.execution.monitoring import Tolerances, failed, worst_lag
from drake_screw.execution.status import ExecutionStatus
from drake_screw.execution.timing import TimedPlan, TimedSegment, TimeLimits, time_plan
from drake_screw.planning import Cause
from drake_screw.planning.connected import ahead
from drake_screw.typing import Array

CHECKED = (
    2  # of that many samples of a way to the first guiding pose, one is checked for collisions
)
HARD = 2.0  # times the acceleration of plans, with which an execution that has failed is braked
STILL = 0.01  # part of its velocity limit at which a joint counts as still


class Mode(StrEnum):
    """What a planner is doing.

    WAITING for objects to come to rest; FOLLOWING them, while the arm approaches; COMMITTED, from
    the first guiding pose on; STOPPING the arm; ENDED by a failure, until it is asked to plan.
    """

    WAITING = "waiting"
    FOLLOWING = "following"
    COMMITTED = "committed"
    STOPPING = "stopping"
    ENDED = "ended"


@dataclass(frozen=True)
class Following:
    """How objects are followed.

    Attributes:
        period: s between looks at the objects. A plan that replaces another one begins a period
            after it was asked for, so that is how long planning may take on a robot.
        settling: s, for which an object has to stay within `still` before anything is planned.
        still_position, still_rotation: m and rad; an object that has moved farther is planned for
            anew.
        moved_position, moved_rotation: m and rad, by which an object may move after the first
            guiding pose is reached; and beyond which it is in a new place.
    """

    period: float = 0.05
    settling: float = 0.2
    still_position: float = 1e-3
    still_rotation: float = 5e-3
    moved_position: float = 5e-3
    moved_rotation: float = 20e-3


@dataclass(frozen=True, eq=False)
class Seen:
    """What a planner is told at a step.

    Attributes:
        t: s.
        X_WO: (k, 4, 4) the objects.
        q, v: (n,) the arm's measured joint positions and velocities.
        asked: the trigger; None where there is none.
        status: of the execution; None where it is not known.
    """

    t: float
    X_WO: Array
    q: Array
    v: Array
    asked: bool | None = None
    status: ExecutionStatus | None = None


@dataclass(frozen=True, eq=False)
class PlannerMemory:
    """A planner's state. It never changes, so copies are the state itself.

    Attributes:
        mode: what it is doing.
        outcome: of the last planning.
        choice: what the plan was chosen from; None without a plan.
        plan: that is to be executed.
        replans: how often the plan has been replaced while the arm moved.
        X_WO: (k, 4, 4) what was planned for last; None if nothing was.
        X_WO_rest: (k, 4, 4) poses that the objects have not left since `resting`, s.
        asked: the trigger, a step ago.
        wanted: whether the trigger has asked for a plan that has not been sought yet.
    """

    mode: Mode = Mode.WAITING
    outcome: PlanningOutcome = field(default_factory=PlanningOutcome)
    choice: Choice | None = None
    plan: TimedPlan | None = None
    replans: int = 0
    X_WO: Array | None = None
    X_WO_rest: Array | None = None
    resting: float = 0.0
    asked: bool = False
    wanted: bool = False

    def __deepcopy__(self, _: object) -> PlannerMemory:
        return self


class Follower:
    """Steps from one memory to the next.

    Args:
        chooser: plans.
        following: how objects are followed.
        limits: how fast plans are executed.
        tolerances: of the executor.
    """

    def __init__(
        self, chooser: Chooser, following: Following, limits: TimeLimits, tolerances: Tolerances
    ) -> None:
        self.chooser, self.arm = chooser, chooser.arm
        self.following, self.limits, self.tolerances = following, limits, tolerances

    def step(self, memory: PlannerMemory, seen: Seen) -> PlannerMemory:
        """What is remembered after a look at the world."""
        memory = self._noticed(memory, seen)
        match memory.mode:
            case Mode.WAITING | Mode.ENDED if self._is_time(memory, seen):
                return self._plan(memory, seen)
            case Mode.FOLLOWING | Mode.COMMITTED if _has_failed(memory, seen):
                return replace(memory, mode=Mode.ENDED)
            case Mode.FOLLOWING:
                return self._follow(memory, seen)
            case Mode.COMMITTED:
                return self._watch(memory, seen)
            case Mode.STOPPING:
                return self._await_rest(memory, seen)
        return memory

    def _noticed(self, memory: PlannerMemory, seen: Seen) -> PlannerMemory:
        """With what has come to rest, and what is asked."""
        rest = memory.X_WO_rest
        if rest is None or self._beyond_still(rest, seen.X_WO):
            memory = replace(memory, X_WO_rest=seen.X_WO, resting=seen.t)
        asked = bool(seen.asked)
        return replace(memory, asked=asked, wanted=memory.wanted or (asked and not memory.asked))

    def _is_time(self, memory: PlannerMemory, seen: Seen) -> bool:
        """Whether to plan: it is wanted, and arm and objects are at rest."""
        wanted = memory.wanted
        if seen.asked is None and memory.mode is Mode.WAITING:
            last = memory.X_WO
            wanted = last is None or bool(self._moved(last, seen.X_WO)[2].any())
        still = (np.abs(seen.v) <= STILL * self.arm.velocity_limits).all()
        rests = seen.t - memory.resting >= self.following.settling - 1e-9
        return bool(wanted and still and rests)

    def _plan(self, memory: PlannerMemory, seen: Seen) -> PlannerMemory:
        """With the best of all plans from where the arm is."""
        found = self.chooser.choose(seen.X_WO, seen.q)
        memory = replace(memory, X_WO=seen.X_WO, wanted=False, replans=0)
        if isinstance(found, PlanningOutcome):
            return replace(memory, mode=Mode.WAITING, outcome=found, choice=None, plan=None)
        plan = replace(self._timed(found), begins=seen.t + self.following.period)
        return _planned(memory, found, plan)

    def _follow(self, memory: PlannerMemory, seen: Seen) -> PlannerMemory:
        """With a plan for where the objects are now."""
        plan, begins, choice, last = _at_hand(memory)
        handover = seen.t + self.following.period - begins
        if handover >= plan.segments[0].duration:
            return replace(memory, mode=Mode.COMMITTED)
        if not self._beyond_still(last, seen.X_WO) or self._is_elsewhere(memory, seen):
            return memory
        brakes = braking(plan, handover, self.limits.accelerations(self.arm))
        found = self.chooser.keep(choice, seen.X_WO, brakes.q[-1])
        if isinstance(found, PlanningOutcome):
            return self._stop(memory, seen, brakes, found)
        first, *others = self._timed(found).segments
        rest = ahead(found.plan).q
        for way in overlapped(brakes, first, self.arm, self.limits):
            path = np.concatenate([way.q[:-1:CHECKED], rest])
            if self.chooser.free(path, seen.X_WO):
                found = replace(found, margins=self.arm.margin_parts(path))
                begins = seen.t + self.following.period
                plan = TimedPlan((way, *others), plan.free_axis, begins)
                memory = replace(memory, X_WO=seen.X_WO, replans=memory.replans + 1)
                return _planned(memory, found, plan)
        touched = PlanningOutcome(Cause.COLLISION, 0, demonstration=choice.demonstration.name)
        return self._stop(memory, seen, brakes, touched)

    def _watch(self, memory: PlannerMemory, seen: Seen) -> PlannerMemory:
        """Stopped if an object that the rest of the plan is about has been moved."""
        plan, begins, choice, last = _at_hand(memory)
        ended = seen.status is not None and seen.status.ended and _past(plan, seen) > 0.0
        if ended or _past(plan, seen) > self.tolerances.settling:
            return replace(memory, mode=Mode.WAITING)
        segment = plan.at(seen.t - begins).segment
        far, turned, moved = self._moved(last, seen.X_WO)
        concerned = [i for i in set(choice.demonstration.objects[segment:].tolist()) if moved[i]]
        if not concerned or _past(plan, seen) >= 0.0:
            return memory
        i = max(concerned, key=far.__getitem__)
        how_far = f"{1e3 * far[i]:.0f} mm and {1e3 * turned[i]:.0f} mrad"
        reason = f"the {self.chooser.names[i]} was moved by {how_far} while it was worked on"
        handover = seen.t + self.following.period - begins
        brakes = braking(plan, handover, HARD * self.limits.accelerations(self.arm))
        stop = self._standstill(brakes, seen, failed(segment, reason))
        return replace(memory, mode=Mode.STOPPING, plan=stop)

    def _await_rest(self, memory: PlannerMemory, seen: Seen) -> PlannerMemory:
        """Ended, or waiting to plan again, once the arm has come to rest."""
        plan = memory.plan
        assert plan is not None
        assert plan.ending is not None
        if _past(plan, seen) <= self.following.period:
            return memory
        return replace(memory, mode=Mode.ENDED if plan.ending.ended else Mode.WAITING)

    def _stop(
        self, memory: PlannerMemory, seen: Seen, brakes: Braking, outcome: PlanningOutcome
    ) -> PlannerMemory:
        """The arm brought to rest on its path, and everything tried again from there."""
        stop = self._standstill(brakes, seen, ExecutionStatus())
        return replace(
            memory, mode=Mode.STOPPING, plan=stop, outcome=outcome, X_WO=None, wanted=True
        )

    def _standstill(self, brakes: Braking, seen: Seen, ending: ExecutionStatus) -> TimedPlan:
        X_WA, X_WB = self.arm.pose(brakes.q[[0, -1]])
        q, v = (np.concatenate([a, a[-1:]]) for a in (brakes.q, brakes.v))
        s = np.linspace(0.0, 1.0, len(q))
        way = TimedSegment(X_WA, X_WB, PERIOD, s, np.zeros(len(q)), q, v, screw=False)
        return TimedPlan((way,), None, seen.t + self.following.period, ending)

    def _timed(self, choice: Choice) -> TimedPlan:
        poses = np.concatenate([self.arm.pose(choice.plan.q[:1]), choice.plan.guides])
        return time_plan(choice.plan, poses, self.arm, self.limits)

    def _is_elsewhere(self, memory: PlannerMemory, seen: Seen) -> bool:
        """Whether the arm is not where its plan says; then the executor ends the execution."""
        plan, begins, *_ = _at_hand(memory)
        q = plan.at(seen.t - begins).q
        return worst_lag(self.tolerances.lags(self.arm), q, seen.q)[0]

    def _moved(self, X_WA: Array, X_WB: Array) -> tuple[Array, Array, Array]:
        """(k,) m and rad that objects moved, and whether that is more than they may."""
        far, turned = self.chooser.apart(X_WA, X_WB)
        allowed = self.following
        return far, turned, (far > allowed.moved_position) | (turned > allowed.moved_rotation)

    def _beyond_still(self, X_WA: Array, X_WB: Array) -> bool:
        far, turned = self.chooser.apart(X_WA, X_WB)
        still = self.following
        return bool(((far > still.still_position) | (turned > still.still_rotation)).any())


def _planned(memory: PlannerMemory, choice: Choice, plan: TimedPlan) -> PlannerMemory:
    outcome = PlanningOutcome(Cause.SUCCESS, demonstration=choice.demonstration.name)
    return replace(memory, mode=Mode.FOLLOWING, outcome=outcome, choice=choice, plan=plan)


def _at_hand(memory: PlannerMemory) -> tuple[TimedPlan, float, Choice, Array]:
    """The plan, when it begins, what it was chosen from, and the poses it is for."""
    plan, choice, X_WO = memory.plan, memory.choice, memory.X_WO
    assert plan is not None
    assert plan.begins is not None
    assert choice is not None
    assert X_WO is not None
    return plan, plan.begins, choice, X_WO


def _past(plan: TimedPlan, seen: Seen) -> float:
    """s since the end of a plan's time; negative before."""
    assert plan.begins is not None
    return seen.t - plan.begins - plan.duration


def _has_failed(memory: PlannerMemory, seen: Seen) -> bool:
    """Whether the execution of the plan at hand has failed."""
    _, begins, *_ = _at_hand(memory)
    status, from_before = seen.status, seen.t <= begins + 1e-9
    return status is not None and status.ended and not from_before and bool(status.reason)
