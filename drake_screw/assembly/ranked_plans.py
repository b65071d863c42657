"""The best plan for a task instance, and the next best ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.assembly.ways import Way, why_none
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import ScenarioError, counted
from drake_screw.execution import TimedPlan, TimeLimits, time_plan
from drake_screw.planning import Outcomes, Plan, Turned
from drake_screw.planning.plan_checker import FAR, PlanChecker
from drake_screw.robot import Arm
from drake_screw.typing import Array

PERIOD = 0.01
"""s, between the samples of a plan in time."""

CHECKED = 8
"""Plans that are looked at for collisions together, the best ones first."""


@dataclass(frozen=True, eq=False)
class RankedPlan:
    """A plan that can be executed, with what it was chosen by.

    Attributes:
        demonstration: that was carried over.
        plan: its joint path.
        turned: how symmetric bodies are turned.
        arm: that it is for.
        speed: how fast it is to be executed.
        checker: of the workcell.
        X_WO: (k, 4, 4) the objects.
        alternatives: the next best plans, the best one first.
        arm_name: the arm's, where the robot has several that are planned for; the others rest.
    """

    demonstration: Demonstration
    plan: Plan
    turned: tuple[Turned, ...]
    arm: Arm
    speed: TimeLimits
    checker: PlanChecker
    X_WO: Array
    alternatives: tuple[RankedPlan, ...] = ()
    arm_name: str | None = None

    @cached_property
    def margins(self) -> dict[str, float]:
        """How near each joint comes to a limit, in parts of its range: 0 at it, 0.5 at most.

        It is 0.5 of a joint without limits.
        """
        part = self.arm.margin_parts(self.plan.q)
        return dict(zip(self.arm.joint_names, part.tolist(), strict=True))

    @property
    def margin(self) -> float:
        """The least of `margins`: the larger, the better the plan."""
        return min(self.margins.values())

    @property
    def tightest(self) -> str:
        """The joint that has the least margin."""
        return min(self.margins, key=self.margins.__getitem__)

    @cached_property
    def clearance(self) -> float:
        """m, that the robot keeps from all else and itself, as far as `plan_checker.FAR`."""
        return self.checker.clearance(self.plan, self.X_WO)

    @cached_property
    def length(self) -> float:
        """rad (or m), length of the joint path."""
        return float(np.linalg.norm(np.diff(self.plan.q, axis=0), axis=1).sum())

    @cached_property
    def timed(self) -> TimedPlan:
        """The plan with its time law, as `ScrewPlanExecutor` takes it."""
        starts = self.arm.pose(self.plan.q[:1])
        poses = np.concatenate([starts, self.plan.guides])
        return time_plan(self.plan, poses, self.arm, self.speed)

    @property
    def times(self) -> Array:
        """(m,) s from the start, PERIOD apart."""
        return self._sampled[0]

    @property
    def q(self) -> Array:
        """(m, n) rad or m, joint positions at `times`."""
        return self._sampled[1]

    @property
    def v(self) -> Array:
        """(m, n) joint velocities at `times`."""
        return self._sampled[2]

    @cached_property
    def _sampled(self) -> tuple[Array, Array, Array]:
        return self.timed.sampled(PERIOD)

    def _kept(self) -> str:
        if self.clearance >= FAR:
            return f"nothing comes nearer than {FAR:g} m"
        return f"something comes as near as {self.clearance:.3f} m"

    def __str__(self) -> str:
        turned = "".join(f", with {turn}" for turn in self.turned)
        of = "" if self.arm_name is None else f" with arm {self.arm_name}"
        return (
            f"{self.demonstration.name}{of}{turned}: {counted(len(self.plan.guides), 'segment')}; "
            f"{self.tightest} comes nearest to a limit, {self.margin:.1%} of its range away; "
            f"{self._kept()}"
        )


def best_plan(
    ways: Sequence[Way],
    demonstrations: Sequence[Demonstration],
    X_WO: ArrayLike,
    names: Sequence[str],
    most: int = 5,
    speed: TimeLimits | None = None,
) -> RankedPlan:
    """The best of `ranked_plans`, with the others as its alternatives; arguments as there.

    Raises:
        ScenarioError: there is no plan; it says why.
    """
    X_WO = np.asarray(X_WO, dtype=float)
    found = ranked_plans(ways, demonstrations, X_WO, names, most, speed)
    if not found:
        raise ScenarioError(
            f"no demonstration gives a plan there: {why_none(ways, demonstrations, X_WO)}",
            remedy="Choose another instance, or carry the run on with more demonstrations.",
        )
    return replace(found[0], alternatives=found[1:])


def ranked_plans(
    ways: Sequence[Way],
    demonstrations: Sequence[Demonstration],
    X_WO: Array,
    names: Sequence[str],
    most: int = 5,
    speed: TimeLimits | None = None,
) -> tuple[RankedPlan, ...]:
    """The plans that touch nothing, that with the largest margin first.

    Of several with the same margin the one with the largest clearance, then the shortest.

    Every turn of every demonstration is tried with every arm; where the approach is free and no
    screw leads to the first guiding pose, the other ways to it are, too, and at last those around
    what is in the way.

    Args:
        ways: the arms to plan for, from where they start.
        demonstrations: D of them.
        X_WO: (k, 4, 4) the objects.
        names: of the k objects.
        most: plans to return.
        speed: how fast they are to be executed.

    Returns:
        As many as there are, `most` of them at most.
    """

    def ranked(way: Way, plans: list[tuple[Demonstration, Plan]]) -> list[RankedPlan]:
        found = []
        for demonstration, plan in plans:
            symmetries = way.planner.planner.symmetries
            turned = symmetries.named(demonstration, X_WO, plan.angles, names)
            how = way.arm, speed or TimeLimits(), way.planner.checker, X_WO, (), way.name
            found.append(RankedPlan(demonstration, plan, turned, *how))
        return found

    found = [
        one
        for way in ways
        for one in _free(ranked(way, _plans(way, demonstrations, X_WO)), X_WO, most)
    ]
    if not found:
        found = [one for way in ways for one in ranked(way, _led_around(way, demonstrations, X_WO))]
    found.sort(key=_best_first)
    if len({one.margin for one in found}) < len(found):
        found.sort(key=lambda one: (-one.margin, -one.clearance, one.length))
    return tuple(found[:most])


def _best_first(one: RankedPlan) -> tuple[float, float]:
    return -one.margin, one.length


def _free(plans: Sequence[RankedPlan], X_WO: Array, most: int) -> list[RankedPlan]:
    """So many plans at least, and all of the same margin, that touch nothing, the best first."""
    candidates = sorted(plans, key=_best_first)
    found: list[RankedPlan] = []
    for first in range(0, len(candidates), CHECKED):
        some = candidates[first : first + CHECKED]
        poses = np.broadcast_to(X_WO, (len(some), *X_WO.shape))
        touching = some[0].checker.first_collisions([c.plan for c in some], poses).collides
        found += [c for c, touches in zip(some, touching, strict=True) if not touches]
        following = candidates[first + CHECKED :]
        if len(found) >= most and following and following[0].margin < found[-1].margin:
            break
    return found


def _led_around(
    way: Way, demonstrations: Sequence[Demonstration], X_WO: Array
) -> list[tuple[Demonstration, Plan]]:
    """Plans of the planner's own search, which leads the arm around what is in the way."""
    outcomes = way.planner.all_outcomes(demonstrations, X_WO[None], way.q_start)[0]
    solved = np.flatnonzero(outcomes.success)
    poses = np.broadcast_to(X_WO, (len(solved), *X_WO.shape))
    variant = outcomes.variant[solved]
    plans = way.planner.plans(demonstrations, poses, way.q_start, solved, variant)
    return [(demonstrations[d], plan) for d, plan in zip(solved.tolist(), plans, strict=True)]


def _plans(
    way: Way, demonstrations: Sequence[Demonstration], X_WO: Array
) -> list[tuple[Demonstration, Plan]]:
    """All plans that keep the limits: of the arm's own start, or if there is none of all."""
    planner, q_start = way.planner.planner, way.q_start
    for others in (False, True) if planner.others else (False,):
        outcomes = [
            planner.variant_outcomes(d, X_WO[None], q_start, others=others) for d in demonstrations
        ]
        pairs = [(d, v) for d, found in enumerate(outcomes) for v in _successes(found)]
        if pairs:
            which, variant = np.array(pairs).T
            poses = np.broadcast_to(X_WO, (len(pairs), *X_WO.shape))
            plans = planner.plans(demonstrations, poses, q_start, which, variant)
            return [(demonstrations[d], plan) for (d, _), plan in zip(pairs, plans, strict=True)]
    return []


def _successes(outcomes: Outcomes) -> list[int]:
    found: list[int] = np.flatnonzero(outcomes.success[0]).tolist()
    return found
